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
    for (SideValues *values : {&forces, &steps, &answers})
      values->reset(atom->nlocal + atom->nghost, stride);
    for (std::vector<double> *v : {&gradient, &left, &search, &turned, &per_diagonal})
      v->assign(mirror.size(), 0.0);
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
    stiffen(rings);
    if (free_to_part && part(rings)) at.energy = std::numeric_limits<double>::infinity();
    free_to_part = false;
    // A step takes what is left to its square, but no further than the tolerance asks for. The first one most often
    // meets contacts that open or close, and gets less far.
    constexpr double LOOSE = 0.03, MARGIN = 0.3;
    const double left_over = at.worst / at.largest;
    const double square = sweeps == 1 ? 10.0 * left_over : left_over;
    find_step(std::max(MARGIN * enough / left_over, std::min(square, LOOSE)));
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
  moving.clear();
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
   A line that presses on one of two outlines with a gap between them goes to
   the middle of the gap, where it is not in their way for a while. Newton's
   method would leave it at the very edge, after many steps where the force
   has no finite slope there. Returns whether there was such a line.
------------------------------------------------------------------------- */

bool ContactBalance::part(const Rings &rings)
{
  const auto for_pairs_of_one = [this](auto &&act) {
    for (int i = 0; i < atom->nlocal; ++i)
      for (int c = 0; c < count[i]; ++c) {
        const int k = side(i, c);
        if ((forces[k] > 0.0) != (forces[mirror[k]] > 0.0)) act(i, c, k);
      }
  };
  SideValues &room = answers;    // before the outline; negative where it is pressed
  for_pairs_of_one([&](int i, int c, int k) {
    const deformable::PressedRing ring = rings(i);
    if (forces[k] > 0.0) {
      const Block &block = blocks[i];
      const int *const carry = &carrying[block.begin];
      const int m = std::find(carry, carry + block.size, c) - carry;
      room[k] = -ring.response[c].length / inverses[block.matrix + m * (block.size + 1)];
    } else {
      room[k] = deformable::room_before(ring, c);
    }
  });
  exchange(room);
  int here = 0, anywhere;
  for_pairs_of_one([&](int, int, int k) {
    if (room[k] + room[mirror[k]] <= 0.0) return;
    shifts[k] += 0.5 * (room[k] - room[mirror[k]]);
    gradient[k] = per_diagonal[k] = 0.0;
    here = 1;
  });
  std::fill(room.value.begin(), room.value.end(), 0.0);
  MPI_Allreduce(&here, &anywhere, 1, MPI_INT, MPI_MAX, world);
  return anywhere == 1;
}

/* ---------------------------------------------------------------------- */

double ContactBalance::total(double part) const
{
  double all;
  MPI_Allreduce(&part, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

// of the energy along the step
double ContactBalance::slope()
{
  double sum = 0.0;
  for (const Pair &pair : moving) sum += pair.share * gradient[pair.side] * steps[pair.side];
  return total(sum);
}

/* ---------------------------------------------------------------------- */

ContactBalance::Point ContactBalance::look(const Sweep &sweep)
{
  ++sweeps;
  const Load load = sweep();
  exchange(forces);
  double local[2] = {load.largest, 0.0}, largest[2];
  for (int i = 0; i < atom->nlocal; ++i)
    for (int k = side(i, 0); k < side(i, count[i]); ++k) {
      gradient[k] = forces[k] - forces[mirror[k]];
      local[1] = std::max(local[1], std::fabs(gradient[k]));
    }
  MPI_Allreduce(local, largest, 2, MPI_DOUBLE, MPI_MAX, world);
  return {total(load.energy), slope(), largest[0], largest[1]};
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
    for (const Pair &pair : moving) {
      const double moved = (wanted - taken) * steps[pair.side];
      shifts[pair.side] += moved;
      if (pair.share == 1.0) shifts[pair.mirror] -= moved;
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

void ContactBalance::stiffen(const Rings &rings)
{
  const int nlocal = atom->nlocal;
  std::fill_n(answers.value.begin(), mirror.size(), 0.0);
  for (int i = 0; i < nlocal; ++i) {
    if (count[i] == 0) continue;
    const deformable::PressedRing ring = rings(i);
    Block &block = blocks[i];
    const int begin = static_cast<int>(carrying.size());
    carrying.resize(begin + ring.contacts.size);
    int *const now = carrying.data() + begin;
    int size = 0, sides = 0;
    for (int c = 0; c < ring.contacts.size; ++c)
      if (ring.response[c].length > 0.0) {
        now[size++] = c;
        sides += c < count[i];
      }
    carrying.resize(begin + size);
    if (size == block.size && std::equal(now, now + size, carrying.data() + block.begin)) {
      carrying.resize(begin);
    } else {
      block = {begin, size, sides, inverses.size()};
      inverses.resize(block.matrix + static_cast<std::size_t>(size) * size);
      deformable::green_inverse(ring.contacts, size, now, programme, &inverses[block.matrix]);
      matrices.resize(inverses.size());
    }
    const int *const carry = &carrying[block.begin];
    double *const matrix = &matrices[block.matrix];
    deformable::contact_stiffness(ring, size, carry, &inverses[block.matrix], rate, matrix);
    for (int m = 0; m < sides; ++m) answers[side(i, carry[m])] = matrix[m * size + m];
    for (int m = 1; m < sides && sides < size; ++m)    // walls do not move
      std::copy_n(matrix + m * size, sides, matrix + m * sides);
  }
  exchange(answers);
  moving.clear();
  for (int i = 0; i < nlocal; ++i)
    for (int k = side(i, 0); k < side(i, count[i]); ++k) {
      const int m = mirror[k], owned = static_cast<int>(mirror.size());
      const double diagonal = answers[k] + answers[m];
      if (!(diagonal > 0.0) || m == k) continue;
      per_diagonal[k] = 1.0 / diagonal;
      if (k < m) moving.push_back({k, m, m < owned ? 1.0 : 0.5});
    }
}

/* ----------------------------------------------------------------------
   K x of one particle, at the contacts that carry
------------------------------------------------------------------------- */

template <int N>
static void multiply(const double *matrix, const int *carry, const double *x, double *product)
{
  double along[N];
  for (int n = 0; n < N; ++n) along[n] = x[carry[n]];
  for (int m = 0; m < N; ++m) {
    double sum = 0.0;
    for (int n = 0; n < N; ++n) sum += matrix[m * N + n] * along[n];
    product[carry[m]] = sum;
  }
}

static void multiply(int n, const double *matrix, const int *carry, const double *x,
                     double *product)
{
  switch (n) {
    case 1: return multiply<1>(matrix, carry, x, product);
    case 2: return multiply<2>(matrix, carry, x, product);
    case 3: return multiply<3>(matrix, carry, x, product);
    case 4: return multiply<4>(matrix, carry, x, product);
    case 5: return multiply<5>(matrix, carry, x, product);
    case 6: return multiply<6>(matrix, carry, x, product);
    case 7: return multiply<7>(matrix, carry, x, product);
  }
  for (int m = 0; m < n; ++m, matrix += n) {
    double sum = 0.0;
    for (int k = 0; k < n; ++k) sum += matrix[k] * x[carry[k]];
    product[carry[m]] = sum;
  }
}

/* ----------------------------------------------------------------------
   H x = -g by conjugate gradients, H the sum of all K seen by pairs; `steps`
   becomes x, `answers` brings K of either side
------------------------------------------------------------------------- */

void ContactBalance::find_step(double accuracy)
{
  constexpr int LONGEST = 500;
  std::fill(search.begin(), search.end(), 0.0);    // rows of K meet sides that do not move
  const auto turn_to = [this](const Pair &pair, double direction) {
    search[pair.side] = direction;
    if (pair.share == 1.0) search[pair.mirror] = -direction;
  };
  double sum = 0.0;
  for (const Pair &pair : moving) {
    const int k = pair.side;
    steps[k] = 0.0;
    left[k] = -gradient[k];
    turn_to(pair, per_diagonal[k] * left[k]);
    sum += pair.share * left[k] * search[k];
  }
  double product = total(sum);
  const double enough = accuracy * accuracy * product;
  for (int iteration = 0; iteration < LONGEST && product > enough; ++iteration) {
    for (int i = 0; i < static_cast<int>(blocks.size()); ++i) {
      const Block &block = blocks[i];
      multiply(block.sides, &matrices[block.matrix], carrying.data() + block.begin,
               &search[side(i, 0)], &answers[side(i, 0)]);
    }
    exchange(answers);
    sum = 0.0;
    for (const Pair &pair : moving) {
      const int k = pair.side;
      turned[k] = answers[k] - answers[pair.mirror];
      sum += pair.share * search[k] * turned[k];
    }
    const double curvature = total(sum);
    const bool flat = !(curvature > 0.0);
    const double along = flat ? 1.0 : product / curvature;
    sum = 0.0;
    for (const Pair &pair : moving) {
      const int k = pair.side;
      steps[k] += along * search[k];
      left[k] -= along * turned[k];
      sum += pair.share * left[k] * left[k] * per_diagonal[k];
    }
    if (flat) break;
    const double next = total(sum), turn = next / product;
    for (const Pair &pair : moving)
      turn_to(pair, per_diagonal[pair.side] * left[pair.side] + turn * search[pair.side]);
    product = next;
  }
}

/* ---------------------------------------------------------------------- */

double ContactBalance::memory_usage() const
{
  return ContactSides::memory_usage() + forces.bytes() + steps.bytes() + answers.bytes() +
         bytes_of(moving, gradient, left, search, turned, per_diagonal, blocks, carrying, inverses,
                  matrices);
}
