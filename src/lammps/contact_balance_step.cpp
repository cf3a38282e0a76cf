// A step of Newton's method for balanced contacts: the linear system and its solution.

#include "contact_balance.h"

#include "atom.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void ContactBalance::assemble_hessian(const RingOf &ring_of)
{
  for (int i = 0; i < atom->nlocal; ++i) {
    if (count[i] == 0 || !selected[i]) continue;
    std::fill_n(scratch.row[i], count[i], 0.0);
    std::fill_n(pair_of.data() + side(i, 0), count[i], NO_PAIR);
    const deformable::RingState ring = ring_of(i);
    Block &block = blocks[i];
    const int begin = static_cast<int>(active_contacts.size());
    active_contacts.resize(begin + ring.contacts.size);
    int *const found = active_contacts.data() + begin;
    int size = 0, sides = 0;
    for (int c = 0; c < ring.contacts.size; ++c)
      if (ring.response[c].length > 0.0) {
        found[size++] = c;
        sides += c < count[i];
      }
    active_contacts.resize(begin + size);
    if (size == block.size &&
        std::equal(found, found + size, active_contacts.data() + block.begin)) {
      active_contacts.resize(begin);
    } else {
      block = {begin, size, sides, inverses.size()};
      inverses.resize(block.matrix + static_cast<std::size_t>(size) * size);
      deformable::green_inverse(ring.contacts, size, found, lcp, inverses.data() + block.matrix);
      matrices.resize(inverses.size());
    }
    const int *const active = active_contacts.data() + block.begin;
    double *const matrix = matrices.data() + block.matrix;
    deformable::contact_stiffness(ring, size, active, inverses.data() + block.matrix, rate, matrix);
    for (int m = 0; m < sides; ++m) scratch[side(i, active[m])] = matrix[m * size + m];
    for (int m = 1; m < sides && sides < size; ++m)    // walls do not move
      std::copy_n(matrix + m * size, sides, matrix + m * sides);
  }
}

/* ----------------------------------------------------------------------
   Numbers the pairs that the next step moves; `scratch` holds the diagonals
   of all blocks.
------------------------------------------------------------------------- */

void ContactBalance::number_pairs()
{
  constexpr double FIXED = -std::numeric_limits<double>::infinity();
  const int nlocal = atom->nlocal, owned = static_cast<int>(mirror.size());
  for (int k : ghost_sides)
    if (!selected[k / stride]) scratch[k] = FIXED;
  for (int k : separated) scratch[k] = FIXED;
  separated.clear();
  exchange(scratch);

  clear_pairs();
  const auto add_pair = [this](int k) {
    const double diagonal = scratch[k] + scratch[mirror[k]];
    if (!(diagonal > 0.0)) return false;
    pair_of[k] = 2 * static_cast<int>(pairs.size());
    pairs.push_back({k, mirror[k]});
    preconditioner.push_back(1.0 / diagonal);
    return true;
  };
  for (int i = 0; i < nlocal; ++i)
    for (int k = side(i, 0); selected[i] && k < side(i, count[i]); ++k) {
      const int m = mirror[k];
      if (k >= m || m >= owned || !selected[m / stride]) continue;
      if (add_pair(k)) pair_of[m] = pair_of[k] + 1;
    }
  first_ghost_pair = pairs.size();
  for (int k : ghost_sides)
    if (selected[k / stride]) add_pair(k);
  steps.resize(pairs.size());
  residual.resize(pairs.size());
}

void ContactBalance::clear_pairs()
{
  pairs.assign(1, Pair{0, 0});
  preconditioner.assign(1, 0.0);
  first_ghost_pair = 1;
}

/* ----------------------------------------------------------------------
   Adds K x of one particle to `product`, at its active contacts. The sign of
   x and of the product is that of the particle's side of the pair.
------------------------------------------------------------------------- */

static constexpr double SIGN[] = {1.0, -1.0};

template <int N>
static void multiply(const double *matrix, const int *active, const int *pair_of, const double *x,
                     double *product)
{
  int place[N];
  double own_x[N];
  for (int m = 0; m < N; ++m) {
    place[m] = pair_of[active[m]];
    own_x[m] = SIGN[place[m] & 1] * x[place[m] >> 1];
  }
  double sum[N] = {};
  for (int n = 0; n < N; ++n)    // K is symmetric: columns vectorize
    for (int m = 0; m < N; ++m) sum[m] += matrix[n * N + m] * own_x[n];
  for (int m = 0; m < N; ++m) product[place[m] >> 1] += SIGN[place[m] & 1] * sum[m];
}

static void multiply(int n, const double *matrix, const int *active, const int *pair_of,
                     const double *x, double *product)
{
  switch (n) {
    case 1: return multiply<1>(matrix, active, pair_of, x, product);
    case 2: return multiply<2>(matrix, active, pair_of, x, product);
    case 3: return multiply<3>(matrix, active, pair_of, x, product);
    case 4: return multiply<4>(matrix, active, pair_of, x, product);
    case 5: return multiply<5>(matrix, active, pair_of, x, product);
    case 6: return multiply<6>(matrix, active, pair_of, x, product);
    case 7: return multiply<7>(matrix, active, pair_of, x, product);
  }
  for (int m = 0; m < n; ++m, matrix += n) {
    double sum = 0.0;
    for (int k = 0; k < n; ++k) {
      const int place = pair_of[active[k]];
      sum += matrix[k] * SIGN[place & 1] * x[place >> 1];
    }
    const int place = pair_of[active[m]];
    product[place >> 1] += SIGN[place & 1] * sum;
  }
}

/* ----------------------------------------------------------------------
   Solves H x = -g by conjugate gradients; `steps` becomes x. H is the sum of
   K over particles. Newton's method squares its relative error in each step:
   the solution need not be better than that, nor than the tolerance.
------------------------------------------------------------------------- */

void ContactBalance::newton_step(double balanced_below, const Evaluation &from)
{
  constexpr int MAX_ITERATIONS = 500;
  constexpr double LEAST_ACCURACY = 0.03, SQUARE = 10.0;
  direction.assign(pairs.size(), 0.0);
  for (std::size_t p = 1; p < pairs.size(); ++p) {
    steps[p] = 0.0;
    residual[p] = -gradient[pairs[p].side];
    direction[p] = preconditioner[p] * residual[p];
  }
  double norm2 = sum_over_pairs([this](std::size_t p) { return residual[p] * direction[p]; });
  const double weights = sum_over_pairs([this](std::size_t p) { return preconditioner[p]; });
  const double typical_imbalance = std::sqrt(norm2 / weights);
  const double accuracy =
      std::min(LEAST_ACCURACY, std::max(balanced_below / from.largest_imbalance,
                                        SQUARE * typical_imbalance / from.largest_force));
  const double target = accuracy * accuracy * norm2;
  for (int iteration = 0; iteration < MAX_ITERATIONS && norm2 > target; ++iteration) {
    apply_hessian();
    const double curvature =
        sum_over_pairs([this](std::size_t p) { return direction[p] * product[p]; });
    const bool flat = !(curvature > 0.0);
    const double length = flat ? 1.0 : norm2 / curvature;
    const double next_norm2 = sum_over_pairs([this, length](std::size_t p) {
      steps[p] += length * direction[p];
      residual[p] -= length * product[p];
      return residual[p] * residual[p] * preconditioner[p];
    });
    if (flat) break;
    const double conjugation = next_norm2 / norm2;
    for (std::size_t p = 1; p < pairs.size(); ++p)
      direction[p] = preconditioner[p] * residual[p] + conjugation * direction[p];
    norm2 = next_norm2;
  }
}

/* ---------------------------------------------------------------------- */

void ContactBalance::apply_hessian()
{
  product.assign(pairs.size(), 0.0);
  for (int i = 0; i < static_cast<int>(blocks.size()); ++i) {
    if (!selected[i]) continue;
    const Block &block = blocks[i];
    multiply(block.sides, matrices.data() + block.matrix, active_contacts.data() + block.begin,
             pair_of.data() + side(i, 0), direction.data(), product.data());
  }
  for (std::size_t p = first_ghost_pair; p < pairs.size(); ++p) scratch[pairs[p].side] = product[p];
  exchange(scratch);
  for (std::size_t p = first_ghost_pair; p < pairs.size(); ++p)
    product[p] -= scratch[pairs[p].mirror];
}
