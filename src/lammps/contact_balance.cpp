#include "contact_balance.h"

#include "atom.h"
#include "comm.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;

bool ContactBalance::settle(const ContactTable &table, bool new_list, const Sweep &sweep,
                            const Rings &rings)
{
  if (new_list) {
    face(table);
    for (SideValues *values : {&forces, &answers, &room})
      values->reset(atom->nlocal + atom->nghost, stride);
    gradient.assign(mirror.size(), 0.0);
    pair_of.assign(mirror.size(), 0);
    abroad.clear();
    for (int i = 0; i < atom->nlocal; ++i)
      for (int k = side(i, 0); k < side(i, count[i]); ++k)
        if (mirror[k] >= static_cast<int>(mirror.size())) abroad.push_back(k);
  }
  start();

  sweeps = 0;
  Point at = look(sweep);
  if (!std::isfinite(at.energy)) {    // a shape that there is not, perhaps on radical axes
    std::fill(shifts.value.begin(), shifts.value.end(), 0.0);
    at = look(sweep);
  }
  // A minimiser comes back to the lines at its next step: there a tenth of what its last step has left of the
  // balance is near enough, and vanishes with its steps.
  constexpr double TENTH = 0.1;
  const bool minimising = update->whichflag == 2;
  const double enough = minimising ? std::max(tolerance, TENTH * at.worst / at.largest) : tolerance;
  bool free_to_part = true;
  while (!at.settled(enough) && sweeps < limit && std::isfinite(at.energy)) {
    constexpr double MARGIN = 0.3;
    const double unsettled = MARGIN * enough * at.largest;
    choose(unsettled);
    stiffen(rings);
    if (free_to_part && at.one_sided && part(rings, unsettled))
      at.energy = std::numeric_limits<double>::infinity();
    free_to_part = false;
    pair_up();
    find_step(unsettled, at);
    at = descend(at, sweep);
  }
  rest();
  residual = at.worst > 0.0 ? at.worst / at.largest : 0.0;
  return at.settled(enough);
}

/* ----------------------------------------------------------------------
   along a trajectory shifts go on as they did
------------------------------------------------------------------------- */

void ContactBalance::start()
{
  run_up = update->ntimestep == last_step + 1 ? std::min(run_up + 1, 3) : 0;
  last_step = update->ntimestep;

  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = side(i, 0); k < side(i, count[i]); ++k) {
      const double now = shifts[k], change = now - before[k],
                   change_before = before[k] - earlier[k];
      earlier[k] = before[k];
      before[k] = now;
      if (run_up >= 2) shifts[k] += change;
      if (run_up >= 3) shifts[k] += change - change_before;
    }
  moving.assign(1, Pair{0, 0});
  within = 1;
  acts.assign(atom->nlocal, 1);
  carrying.clear();
  inverses.clear();
  blocks.assign(atom->nlocal, Block{0, -1, 0, 0});
}

// Lines that bear no force were put where they are, which is no motion to go on with.
void ContactBalance::rest()
{
  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = side(i, 0); k < side(i, count[i]); ++k)
      if (forces[k] == 0.0 && forces[mirror[k]] == 0.0) before[k] = earlier[k] = shifts[k];
}

/* ----------------------------------------------------------------------
   Particles with a pair that is not settled, and those around them: a step
   is felt the less, the further away
------------------------------------------------------------------------- */

void ContactBalance::choose(double unsettled)
{
  constexpr int AROUND = 2;
  constexpr double MOST = 0.5;
  const int nlocal = atom->nlocal, owned = static_cast<int>(mirror.size());
  newly.clear();
  for (int i = 0; i < nlocal; ++i) {
    int k = side(i, 0);
    const int end = side(i, count[i]);
    while (k < end && std::fabs(gradient[k]) <= unsettled) ++k;
    acts[i] = k < end;
    if (acts[i]) newly.push_back(i);
  }
  if (total(newly.size()) > MOST * atom->natoms) {
    std::fill(acts.begin(), acts.end(), 1);
    return;
  }
  const auto carries = [this](int k) { return forces[k] > 0.0 || forces[mirror[k]] > 0.0; };
  const auto join = [this](int i) {
    if (acts[i]) return;
    acts[i] = 1;
    newly.push_back(i);
  };
  for (int ring = 0, begin = 0; ring < AROUND; ++ring) {
    for (int k : abroad) answers[k] = acts[k / stride];
    exchange(answers);
    const int end = static_cast<int>(newly.size());
    for (int k : abroad)
      if (answers[mirror[k]] > 0.0 && carries(k)) join(k / stride);
    for (int n = begin; n < end; ++n)
      for (int k = side(newly[n], 0); k < side(newly[n], count[newly[n]]); ++k)
        if (mirror[k] < owned && carries(k)) join(mirror[k] / stride);
    begin = end;
  }
}

/* ----------------------------------------------------------------------
   A line that presses on one of two outlines with a gap between them goes to
   the middle of the gap, where it is not in their way for a while. Newton's
   method would leave it at the very edge, after many steps where the force
   has no finite slope there. Returns whether there was such a line.
------------------------------------------------------------------------- */

bool ContactBalance::part(const Rings &rings, double unsettled)
{
  for (int i = 0; i < atom->nlocal; ++i)
    for (int c = 0; c < count[i]; ++c) {
      const int k = side(i, c);
      if (std::fabs(gradient[k]) <= unsettled) continue;
      if ((forces[k] > 0.0) == (forces[mirror[k]] > 0.0)) continue;
      parted.push_back(k);
      const deformable::PressedRing ring = rings(i);
      if (forces[k] > 0.0) {
        const Block &block = blocks[i];
        const int *const carry = &carrying[block.begin];
        const int m = std::find(carry, carry + block.size, c) - carry;
        room[k] = -ring.response[c].length / inverses[block.matrix + m * (block.size + 1)];
      } else {
        room[k] = deformable::room_before(ring, c);
      }
    }
  exchange(room);
  parted.erase(std::remove_if(parted.begin(), parted.end(),
                              [this](int k) { return room[k] + room[mirror[k]] <= 0.0; }),
               parted.end());
  for (int k : parted) shifts[k] += 0.5 * (room[k] - room[mirror[k]]);
  return total(parted.size()) > 0.0;
}

/* ---------------------------------------------------------------------- */

double ContactBalance::total(double part) const
{
  if (comm->nprocs == 1) return part;
  double all;
  MPI_Allreduce(&part, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

// of the energy along the step
double ContactBalance::slope()
{
  return sum_over_pairs([this](std::size_t p) { return gradient[moving[p].side] * steps[p]; });
}

/* ---------------------------------------------------------------------- */

ContactBalance::Point ContactBalance::look(const Sweep &sweep)
{
  ++sweeps;
  const Load load = sweep(acts.data());
  exchange(forces);
  double most[3] = {load.largest, 0.0, 0.0};
  bool one_sided = false;
  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = side(i, 0); k < side(i, count[i]); ++k) {
      gradient[k] = forces[k] - forces[mirror[k]];
      most[1] = std::max(most[1], std::fabs(gradient[k]));
      one_sided |= (forces[k] > 0.0) != (forces[mirror[k]] > 0.0);
    }
  most[2] = one_sided;
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, most, 3, MPI_DOUBLE, MPI_MAX, world);
  return {total(load.energy), slope(), most[0], most[1], most[2] > 0.0};
}

/* ----------------------------------------------------------------------
   The energy is convex along the step too, but its slope has kinks where
   contacts begin or cease to carry. A step that goes too far ends where the
   slope is level enough, on the far side of the kink in its way: of two
   points there the slope tells where it has left the ground.
------------------------------------------------------------------------- */

ContactBalance::Point ContactBalance::descend(const Point &from, const Sweep &sweep)
{
  constexpr double ROUNDING = 1e-12, LEVEL = 0.5;
  struct {
    double at, slope;
  } low = {0.0, slope()}, high = {1.0, 0.0}, beyond = high;
  const double level = -LEVEL * low.slope;
  for (double taken = 0.0, wanted = 1.0;;) {
    for (std::size_t p = 1; p < moving.size(); ++p) {
      const double moved = (wanted - taken) * steps[p];
      shifts[moving[p].side] += moved;
      if (p < within) shifts[moving[p].mirror] -= moved;
    }
    taken = wanted;
    const Point at = look(sweep);
    const bool falls = at.energy <= from.energy * (1.0 + ROUNDING);
    const bool further = taken == 1.0 && at.slope <= 0.0;
    if (further || (falls && std::fabs(at.slope) <= level) || sweeps >= limit) return at;
    if (std::isinf(from.energy) && std::isfinite(at.energy)) return at;    // lines have jumped

    if (at.slope <= 0.0) {
      low = {taken, at.slope};
    } else {
      beyond = high;
      high = {taken, at.slope};
    }
    const double width = high.at - low.at;
    const double zero =
        beyond.slope > high.slope
            ? high.at - high.slope * (beyond.at - high.at) / (beyond.slope - high.slope)
            : low.at + low.slope / (low.slope - high.slope) * width;
    wanted = std::isfinite(zero) ? std::clamp(zero, low.at + 0.1 * width, low.at + 0.9 * width)
                                 : low.at + 0.25 * width;
  }
}

/* ---------------------------------------------------------------------- */

double ContactBalance::memory_usage() const
{
  return ContactSides::memory_usage() + forces.bytes() + answers.bytes() + room.bytes() +
         bytes_of(moving, acts, newly, abroad, pair_of, gradient, steps, left, search, turned,
                  weight, blocks, carrying, inverses, matrices, parted, rate);
}
