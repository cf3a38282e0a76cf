// A step of Newton's method towards balanced contacts: the linear system and its solution.

#include "contact_balance.h"

#include "atom.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void ContactBalance::stiffen(const Rings &rings)
{
  for (int i = 0; i < atom->nlocal; ++i) {
    if (count[i] == 0 || !acts[i]) continue;
    std::fill_n(answers.row[i], count[i], 0.0);
    std::fill_n(pair_of.data() + side(i, 0), count[i], NO_PAIR);
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
      deformable::green_inverse(ring.contacts, size, now, programme,
                                inverses.data() + block.matrix);
      matrices.resize(inverses.size());
    }
    const int *const carry = carrying.data() + block.begin;
    double *const matrix = matrices.data() + block.matrix;
    deformable::contact_stiffness(ring, size, carry, inverses.data() + block.matrix, rate, matrix);
    for (int m = 0; m < sides; ++m) answers[side(i, carry[m])] = matrix[m * size + m];
    for (int m = 1; m < sides && sides < size; ++m)    // walls do not move
      std::copy_n(matrix + m * size, sides, matrix + m * sides);
  }
}

/* ----------------------------------------------------------------------
   the pairs that the next step moves, and how stiff each is
------------------------------------------------------------------------- */

void ContactBalance::pair_up()
{
  constexpr double FIXED = -std::numeric_limits<double>::infinity();
  const int nlocal = atom->nlocal, owned = static_cast<int>(mirror.size());
  for (int k : abroad)
    if (!acts[k / stride]) answers[k] = FIXED;
  for (int k : parted) answers[k] = FIXED;
  parted.clear();
  exchange(answers);

  moving.assign(1, Pair{0, 0});
  weight.assign(1, 0.0);
  const auto join = [this](int k) {
    const double diagonal = answers[k] + answers[mirror[k]];
    if (!(diagonal > 0.0)) return false;
    pair_of[k] = 2 * static_cast<int>(moving.size());
    moving.push_back({k, mirror[k]});
    weight.push_back(1.0 / diagonal);
    return true;
  };
  for (int i = 0; i < nlocal; ++i)
    for (int k = side(i, 0); acts[i] && k < side(i, count[i]); ++k) {
      const int m = mirror[k];
      if (k >= m || m >= owned || !acts[m / stride]) continue;
      if (join(k)) pair_of[m] = pair_of[k] + 1;
    }
  within = moving.size();
  for (int k : abroad)
    if (acts[k / stride]) join(k);
  steps.resize(moving.size());
  left.resize(moving.size());
}

/* ----------------------------------------------------------------------
   K x of one particle, at the contacts that carry: x is taken from pairs and
   what comes of it added to pairs, with the sign of the particle's side
------------------------------------------------------------------------- */

static constexpr double SIGN[] = {1.0, -1.0};

template <int N>
static void multiply(const double *matrix, const int *carry, const int *pair_of, const double *x,
                     double *product)
{
  int place[N];
  double along[N];
  for (int m = 0; m < N; ++m) {
    place[m] = pair_of[carry[m]];
    along[m] = SIGN[place[m] & 1] * x[place[m] >> 1];
  }
  double sum[N] = {};
  for (int n = 0; n < N; ++n)    // K is symmetric: by columns, several at a time
    for (int m = 0; m < N; ++m) sum[m] += matrix[n * N + m] * along[n];
  for (int m = 0; m < N; ++m) product[place[m] >> 1] += SIGN[place[m] & 1] * sum[m];
}

static void multiply(int n, const double *matrix, const int *carry, const int *pair_of,
                     const double *x, double *product)
{
  switch (n) {
    case 1: return multiply<1>(matrix, carry, pair_of, x, product);
    case 2: return multiply<2>(matrix, carry, pair_of, x, product);
    case 3: return multiply<3>(matrix, carry, pair_of, x, product);
    case 4: return multiply<4>(matrix, carry, pair_of, x, product);
    case 5: return multiply<5>(matrix, carry, pair_of, x, product);
    case 6: return multiply<6>(matrix, carry, pair_of, x, product);
    case 7: return multiply<7>(matrix, carry, pair_of, x, product);
  }
  for (int m = 0; m < n; ++m, matrix += n) {
    double sum = 0.0;
    for (int k = 0; k < n; ++k) {
      const int place = pair_of[carry[k]];
      sum += matrix[k] * SIGN[place & 1] * x[place >> 1];
    }
    const int place = pair_of[carry[m]];
    product[place >> 1] += SIGN[place & 1] * sum;
  }
}

/* ----------------------------------------------------------------------
   H x = -g by conjugate gradients, H the sum of all K seen by pairs; `steps`
   becomes x. A step of Newton's method takes what is left over to its square,
   so that it need not be any better, nor better than what counts as settled.
------------------------------------------------------------------------- */

void ContactBalance::find_step(double unsettled, const Point &from)
{
  constexpr int LONGEST = 500;
  constexpr double LOOSE = 0.03, SQUARE = 10.0;
  search.assign(moving.size(), 0.0);
  for (std::size_t p = 1; p < moving.size(); ++p) {
    steps[p] = 0.0;
    left[p] = -gradient[moving[p].side];
    search[p] = weight[p] * left[p];
  }
  double product = sum_over_pairs([this](std::size_t p) { return left[p] * search[p]; });
  const double weights = sum_over_pairs([this](std::size_t p) { return weight[p]; });
  const double typical = std::sqrt(product / weights);    // of what is left over
  const double accuracy =
      std::min(LOOSE, std::max(unsettled / from.worst, SQUARE * typical / from.largest));
  const double enough = accuracy * accuracy * product;
  for (int iteration = 0; iteration < LONGEST && product > enough; ++iteration) {
    turn();
    const double curvature =
        sum_over_pairs([this](std::size_t p) { return search[p] * turned[p]; });
    const bool flat = !(curvature > 0.0);
    const double along = flat ? 1.0 : product / curvature;
    const double next = sum_over_pairs([this, along](std::size_t p) {
      steps[p] += along * search[p];
      left[p] -= along * turned[p];
      return left[p] * left[p] * weight[p];
    });
    if (flat) break;
    const double straight = next / product;
    for (std::size_t p = 1; p < moving.size(); ++p)
      search[p] = weight[p] * left[p] + straight * search[p];
    product = next;
  }
}

// What the forces of pairs change by along the direction of search.
void ContactBalance::turn()
{
  turned.assign(moving.size(), 0.0);
  for (int i = 0; i < static_cast<int>(blocks.size()); ++i) {
    if (!acts[i]) continue;
    const Block &block = blocks[i];
    multiply(block.sides, matrices.data() + block.matrix, carrying.data() + block.begin,
             pair_of.data() + side(i, 0), search.data(), turned.data());
  }
  for (std::size_t p = within; p < moving.size(); ++p) answers[moving[p].side] = turned[p];
  exchange(answers);
  for (std::size_t p = within; p < moving.size(); ++p) turned[p] -= answers[moving[p].mirror];
}
