#include "contact_balance.h"

#include "atom.h"
#include "comm.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

bool ContactBalance::solve(const ContactTable &table, bool new_list, const ShapeRings &shape_rings,
                           const RingOf &ring_of)
{
  if (new_list) reset(table);
  extrapolate_shifts();

  evaluations = 0;
  Evaluation now = evaluate(shape_rings);
  if (!std::isfinite(now.energy)) {    // some ring has no shape; it may have one on radical axes
    std::fill(shifts.value.begin(), shifts.value.end(), 0.0);
    now = evaluate(shape_rings);
  }
  // A minimizer needs only a tenth of the imbalance that its last step caused: the rest vanishes as its steps do.
  constexpr double TENTH = 0.1;
  const bool minimizing = update->whichflag == 2;
  const double target = minimizing
                            ? std::max(tolerance, TENTH * now.largest_imbalance / now.largest_force)
                            : tolerance;
  bool may_separate = true;
  while (!now.is_balanced(target) && evaluations < max_evaluations && std::isfinite(now.energy)) {
    constexpr double MARGIN = 0.3;
    const double balanced_below = MARGIN * target * now.largest_force;
    select_particles(balanced_below);
    assemble_hessian(ring_of);
    if (may_separate && now.one_sided && separate(ring_of, balanced_below))
      now.energy = std::numeric_limits<double>::infinity();
    may_separate = false;
    number_pairs();
    newton_step(balanced_below, now);
    now = line_search(now, shape_rings);
  }
  freeze_unloaded();
  imbalance = now.largest_imbalance > 0.0 ? now.largest_imbalance / now.largest_force : 0.0;
  return now.is_balanced(target);
}

/* ---------------------------------------------------------------------- */

void ContactBalance::reset(const ContactTable &table)
{
  match_sides(table);
  for (SideValues *values : {&forces, &scratch, &gaps})
    values->reset(atom->nlocal + atom->nghost, stride);
  gradient.assign(mirror.size(), 0.0);
  pair_of.assign(mirror.size(), NO_PAIR);
  ghost_sides.clear();
  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = side(i, 0); k < side(i, count[i]); ++k)
      if (mirror[k] >= static_cast<int>(mirror.size())) ghost_sides.push_back(k);
}

/* ----------------------------------------------------------------------
   At successive steps shifts start from a quadratic extrapolation in time.
------------------------------------------------------------------------- */

void ContactBalance::extrapolate_shifts()
{
  consecutive_calls = update->ntimestep == last_step + 1 ? std::min(consecutive_calls + 1, 3) : 0;
  last_step = update->ntimestep;

  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = side(i, 0); k < side(i, count[i]); ++k) {
      const double now = shifts[k], change = now - last_shifts[k],
                   last_change = last_shifts[k] - second_last_shifts[k];
      second_last_shifts[k] = last_shifts[k];
      last_shifts[k] = now;
      if (consecutive_calls >= 2) shifts[k] += change;
      if (consecutive_calls >= 3) shifts[k] += change - last_change;
    }
  clear_pairs();
  selected.assign(atom->nlocal, 1);
  active_contacts.clear();
  inverses.clear();
  blocks.assign(atom->nlocal, Block{0, -1, 0, 0});
}

// Lines without force jump (see separate): their motion must not be extrapolated.
void ContactBalance::freeze_unloaded()
{
  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = side(i, 0); k < side(i, count[i]); ++k)
      if (forces[k] == 0.0 && forces[mirror[k]] == 0.0)
        last_shifts[k] = second_last_shifts[k] = shifts[k];
}

/* ----------------------------------------------------------------------
   Selects the particles with an unbalanced contact, their neighbors and
   second neighbors: the effect of a step decays with the distance.
------------------------------------------------------------------------- */

void ContactBalance::select_particles(double balanced_below)
{
  constexpr int NEIGHBOR_SHELLS = 2;
  constexpr double MOST = 0.5;
  const int nlocal = atom->nlocal, owned = static_cast<int>(mirror.size());
  selection.clear();
  for (int i = 0; i < nlocal; ++i) {
    int k = side(i, 0);
    const int end = side(i, count[i]);
    while (k < end && std::fabs(gradient[k]) <= balanced_below) ++k;
    selected[i] = k < end;
    if (selected[i]) selection.push_back(i);
  }
  if (sum_over_ranks(selection.size()) > MOST * atom->natoms) {
    std::fill(selected.begin(), selected.end(), 1);
    return;
  }
  const auto is_active = [this](int k) { return forces[k] > 0.0 || forces[mirror[k]] > 0.0; };
  const auto select = [this](int i) {
    if (selected[i]) return;
    selected[i] = 1;
    selection.push_back(i);
  };
  for (int shell = 0, begin = 0; shell < NEIGHBOR_SHELLS; ++shell) {
    for (int k : ghost_sides) scratch[k] = selected[k / stride];
    exchange(scratch);
    const int end = static_cast<int>(selection.size());
    for (int k : ghost_sides)
      if (scratch[mirror[k]] > 0.0 && is_active(k)) select(k / stride);
    for (int n = begin; n < end; ++n)
      for (int k = side(selection[n], 0); k < side(selection[n], count[selection[n]]); ++k)
        if (mirror[k] < owned && is_active(k)) select(mirror[k] / stride);
    begin = end;
  }
}

/* ----------------------------------------------------------------------
   A line that indents one outline only, with a gap between the outlines,
   jumps to the middle of the gap. Newton's method would leave it at the edge
   of the gap, after many steps, because the slope of the force is not finite
   there. Returns whether a line has jumped.
------------------------------------------------------------------------- */

bool ContactBalance::separate(const RingOf &ring_of, double balanced_below)
{
  for (int i = 0; i < atom->nlocal; ++i)
    for (int c = 0; c < count[i]; ++c) {
      const int k = side(i, c);
      if (std::fabs(gradient[k]) <= balanced_below) continue;
      if ((forces[k] > 0.0) == (forces[mirror[k]] > 0.0)) continue;
      separated.push_back(k);
      const deformable::RingState ring = ring_of(i);
      if (forces[k] > 0.0) {
        const Block &block = blocks[i];
        const int *const active = &active_contacts[block.begin];
        const int m = std::find(active, active + block.size, c) - active;
        gaps[k] = -ring.response[c].length / inverses[block.matrix + m * (block.size + 1)];
      } else {
        gaps[k] = deformable::gap_to_line(ring, c);
      }
    }
  exchange(gaps);
  separated.erase(std::remove_if(separated.begin(), separated.end(),
                                 [this](int k) { return gaps[k] + gaps[mirror[k]] <= 0.0; }),
                  separated.end());
  for (int k : separated) shifts[k] += 0.5 * (gaps[k] - gaps[mirror[k]]);
  return sum_over_ranks(separated.size()) > 0.0;
}

/* ---------------------------------------------------------------------- */

double ContactBalance::sum_over_ranks(double part) const
{
  if (comm->nprocs == 1) return part;
  double all;
  MPI_Allreduce(&part, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

// of the energy along the step
double ContactBalance::slope()
{
  return sum_over_pairs([this](std::size_t p) { return gradient[pairs[p].side] * steps[p]; });
}

/* ---------------------------------------------------------------------- */

ContactBalance::Evaluation ContactBalance::evaluate(const ShapeRings &shape_rings)
{
  ++evaluations;
  const Totals totals = shape_rings(selected.data());
  exchange(forces);
  double largest[3] = {totals.largest_force, 0.0, 0.0};
  bool one_sided = false;
  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = side(i, 0); k < side(i, count[i]); ++k) {
      gradient[k] = forces[k] - forces[mirror[k]];
      largest[1] = std::max(largest[1], std::fabs(gradient[k]));
      one_sided |= (forces[k] > 0.0) != (forces[mirror[k]] > 0.0);
    }
  largest[2] = one_sided;
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, largest, 3, MPI_DOUBLE, MPI_MAX, world);
  return {sum_over_ranks(totals.energy), slope(), largest[0], largest[1], largest[2] > 0.0};
}

/* ----------------------------------------------------------------------
   The energy is convex along the step, but its slope has kinks where
   contacts become active or inactive. If the full step is too long, the
   search ends where the slope is small enough. Beyond a kink, the secant
   through the last two points there gives the next point.
------------------------------------------------------------------------- */

ContactBalance::Evaluation ContactBalance::line_search(const Evaluation &from,
                                                       const ShapeRings &shape_rings)
{
  constexpr double ROUNDING = 1e-12, SMALL_SLOPE = 0.5;
  struct {
    double at, slope;
  } low = {0.0, slope()}, high = {1.0, 0.0}, last_high = high;
  const double small_slope = -SMALL_SLOPE * low.slope;
  for (double taken = 0.0, next = 1.0;;) {
    for (std::size_t p = 1; p < pairs.size(); ++p) {
      const double change = (next - taken) * steps[p];
      shifts[pairs[p].side] += change;
      if (p < first_ghost_pair) shifts[pairs[p].mirror] -= change;
    }
    taken = next;
    const Evaluation now = evaluate(shape_rings);
    const bool falls = now.energy <= from.energy * (1.0 + ROUNDING);
    const bool still_downhill = taken == 1.0 && now.slope <= 0.0;
    if (still_downhill || (falls && std::fabs(now.slope) <= small_slope) ||
        evaluations >= max_evaluations)
      return now;
    if (std::isinf(from.energy) && std::isfinite(now.energy)) return now;    // after separate

    if (now.slope <= 0.0) {
      low = {taken, now.slope};
    } else {
      last_high = high;
      high = {taken, now.slope};
    }
    const double width = high.at - low.at;
    const double zero =
        last_high.slope > high.slope
            ? high.at - high.slope * (last_high.at - high.at) / (last_high.slope - high.slope)
            : low.at + low.slope / (low.slope - high.slope) * width;
    next = std::isfinite(zero) ? std::clamp(zero, low.at + 0.1 * width, low.at + 0.9 * width)
                               : low.at + 0.25 * width;
  }
}

/* ---------------------------------------------------------------------- */

double ContactBalance::memory_usage() const
{
  return ContactSides::memory_usage() + forces.bytes() + scratch.bytes() + gaps.bytes() +
         bytes_of(pairs, selected, selection, ghost_sides, pair_of, gradient, steps, residual,
                  direction, product, preconditioner, blocks, active_contacts, inverses, matrices,
                  separated, rate);
}
