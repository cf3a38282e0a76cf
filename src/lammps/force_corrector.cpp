#include "force_corrector.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using deformable::PairArrays;

void ForceCorrector::arrange(const ForceBatches &b)
{
  levels.arrange(b);
  forget_bounds();
}

void ForceCorrector::solve(const NearPairs &pairs, ForceBatches &batches, RemoteSides &remote,
                           const PairArrays &arrays, double norm2, double accuracy)
{
  if (highest > 0.0)
    chebyshev(pairs, batches, remote, arrays, accuracy);
  else
    conjugate_gradients(pairs, batches, remote, arrays, norm2, accuracy);
}

void ForceCorrector::conjugate_gradients(const NearPairs &pairs, ForceBatches &batches,
                                         RemoteSides &remote, const PairArrays &arrays,
                                         double norm2, double accuracy)
{
  constexpr int MAX_ITERATIONS = 500;
  const deformable::RingBatches rings = batches.arrays();
  kernels.begin(rings, arrays);
  const double enough = accuracy * accuracy * norm2;
  std::vector<double> lengths, conjugations;
  double conjugation = 0.0;
  for (int iteration = 0; iteration < MAX_ITERATIONS && norm2 > enough; ++iteration) {
    const double part = kernels.multiply(rings, conjugation);
    remote.exchange(pairs.side[0].data() + pairs.remote, batches.contacts, batches.product.data());
    const double curvature = remote.sum(part);
    if (!(curvature > 0.0)) break;
    lengths.push_back(norm2 / curvature);
    const double next = remote.sum(kernels.advance(rings, lengths.back()));
    conjugation = next / norm2;
    conjugations.push_back(conjugation);
    norm2 = next;
  }
  find_bounds(lengths, conjugations);
  // of the logarithm of the error in one iteration; that of Chebyshev's method is for all spectra between the bounds
  constexpr double WORTH = 0.6;
  if (highest > 0.0 && decay() < WORTH * std::log(1.0 / accuracy) / lengths.size()) forget_bounds();
}

/* ----------------------------------------------------------------------
   Conjugate gradients are Lanczos' method: the extreme eigenvalues are those
   of a tridiagonal matrix of their coefficients. Few iterations know them
   too little.
------------------------------------------------------------------------- */

void ForceCorrector::find_bounds(const std::vector<double> &lengths,
                                 const std::vector<double> &conjugations)
{
  constexpr int LEAST = 5, HALVINGS = 30;
  constexpr double MARGIN = 0.1;
  const int n = static_cast<int>(lengths.size());
  if (n < LEAST) return;
  std::vector<double> diagonal(n), square(n, 0.0);    // square: of the element before the diagonal
  double most = 0.0;
  for (int k = 0; k < n; ++k) {
    diagonal[k] = 1.0 / lengths[k];
    if (k > 0) {
      diagonal[k] += conjugations[k - 1] / lengths[k - 1];
      square[k] = conjugations[k - 1] / (lengths[k - 1] * lengths[k - 1]);
    }
    most = std::max(most, diagonal[k] + 2.0 * std::sqrt(square[k]));
  }
  most *= 2.0;
  // eigenvalues below x: negative pivots of Gauss' elimination
  const auto below = [&](double x) {
    int found = 0;
    double pivot = 1.0;
    for (int k = 0; k < n; ++k) {
      pivot = diagonal[k] - x - square[k] / pivot;
      found += pivot < 0.0;
    }
    return found;
  };
  const auto eigenvalue = [&](int index) {
    double low = 0.0, high = most;
    for (int i = 0; i < HALVINGS; ++i) {
      const double middle = 0.5 * (low + high);
      (below(middle) > index ? high : low) = middle;
    }
    return 0.5 * (low + high);
  };
  lowest = (1.0 - MARGIN) * eigenvalue(0);
  highest = (1.0 + MARGIN) * eigenvalue(n - 1);
}

double ForceCorrector::decay() const
{
  return std::acosh((highest + lowest) / (highest - lowest));
}

void ForceCorrector::chebyshev(const NearPairs &pairs, ForceBatches &batches, RemoteSides &remote,
                               const PairArrays &arrays, double accuracy)
{
  const double center = 0.5 * (highest + lowest), radius = 0.5 * (highest - lowest);
  const double ratio = center / radius;
  const int last = std::max(2, static_cast<int>(std::ceil(std::acosh(1.0 / accuracy) / decay())));
  std::vector<double> lengths(last + 1), conjugations(last + 1, 0.0);
  lengths[1] = 1.0 / center;
  double rho = 1.0 / ratio;
  for (int k = 2; k <= last; ++k) {
    const double next = 1.0 / (2.0 * ratio - rho);
    lengths[k] = 2.0 * next / radius;
    conjugations[k] = next * rho * lengths[k - 1] / lengths[k];
    rho = next;
  }

  const deformable::RingBatches all = batches.arrays();
  const std::ptrdiff_t products = batches.product.size() / 2;
  const auto product = [&](int iteration) {
    return all.corrections.product + (iteration % 2) * products;
  };
  levels.run(
      last,
      [&](int block, int iteration) {
        deformable::RingBatches b = all;
        b.begin = block * BlockLevels::BATCHES;
        b.end = std::min(b.begin + BlockLevels::BATCHES, all.end);
        b.corrections.product = product(iteration);
        b.corrections.last_product = product(iteration - 1);
        if (iteration == 1) {
          kernels.begin(b, arrays);
          kernels.multiply(b, 0.0);
        } else if (iteration < last) {
          kernels.advance_and_multiply(b, lengths[iteration - 1], conjugations[iteration]);
        } else {
          kernels.advance_twice(b, lengths[last - 1], conjugations[last], lengths[last]);
        }
      },
      [&](int iteration) {
        remote.exchange(pairs.side[0].data() + pairs.remote, batches.contacts, product(iteration));
      });
}
