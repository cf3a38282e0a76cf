#include "solver/linear_solver.h"

#include <algorithm>
#include <cmath>

namespace deformable {

int LinearSolver::begin(ContactBatches &batches, RemoteSides &remote, const PairArrays &arrays,
                        double norm2, double accuracy)
{
  if (knows_bounds()) return plan(accuracy);
  conjugate_gradients(batches, remote, arrays, norm2, accuracy);
  return 0;
}

void LinearSolver::conjugate_gradients(ContactBatches &batches, RemoteSides &remote,
                                       const PairArrays &arrays, double norm2, double accuracy)
{
  constexpr int MAX_ITERATIONS = 500;
  const RingBatches rings = batches.arrays();
  const double enough = accuracy * accuracy * norm2;
  std::vector<double> alpha, beta;
  double conjugation = 0.0;
  for (int iteration = 0; iteration < MAX_ITERATIONS && norm2 > enough; ++iteration) {
    const double part =
        iteration == 0 ? kernels.begin(rings, arrays) : kernels.multiply(rings, conjugation);
    remote.exchange(batches.product.data());
    const double curvature = remote.sum(part);
    if (!(curvature > 0.0)) break;
    alpha.push_back(norm2 / curvature);
    const double next = remote.sum(kernels.advance(rings, alpha.back()));
    conjugation = next / norm2;
    beta.push_back(conjugation);
    norm2 = next;
  }
  are_invalid = !find_bounds(alpha, beta);
  if (are_invalid) return;
  // of the logarithm of the error in one iteration; that of Chebyshev's method is for all spectra between the bounds
  const double of_conjugate = std::log(1.0 / accuracy) / alpha.size();
  if (decay() < tuning.chebyshev * of_conjugate) highest = 0.0;
}

/* ----------------------------------------------------------------------
   Conjugate gradients are Lanczos' method: the extreme eigenvalues are those
   of a tridiagonal matrix of their coefficients. Few iterations know them
   too little: then it returns false.
------------------------------------------------------------------------- */

bool LinearSolver::find_bounds(const std::vector<double> &alpha, const std::vector<double> &beta)
{
  constexpr int LEAST = 5, PARTS = 1024;
  const int n = static_cast<int>(alpha.size());
  if (n < LEAST) return false;
  std::vector<double> diagonal(n), square(n, 0.0);    // square: of the element before the diagonal
  double most = 0.0;
  for (int k = 0; k < n; ++k) {
    diagonal[k] = 1.0 / alpha[k];
    if (k > 0) {
      diagonal[k] += beta[k - 1] / alpha[k - 1];
      square[k] = beta[k - 1] / (alpha[k - 1] * alpha[k - 1]);
    }
    most = std::max(most, diagonal[k] + 2.0 * std::sqrt(square[k]));
  }
  // Not better than this: then rounding, which other numbers of ranks change, does not change the bounds.
  most = std::exp2(std::ceil(std::log2(2.0 * most)));
  const double unit = most / PARTS;
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
  int low = 0, high = PARTS;
  while (low < PARTS && below((low + 1) * unit) == 0) ++low;
  while (high > low + 1 && below((high - 1) * unit) == n) --high;
  lowest = low * unit;
  highest = (1.0 + tuning.spectrum) * high * unit;
  return true;
}

double LinearSolver::decay() const
{
  return std::acosh((highest + lowest) / (highest - lowest));
}

// The coefficients of Chebyshev's iteration, as conjugate gradients have them.
int LinearSolver::plan(double accuracy)
{
  const double center = 0.5 * (highest + lowest), radius = 0.5 * (highest - lowest);
  const double ratio = center / radius;
  const int last = std::max(2, static_cast<int>(std::ceil(std::acosh(1.0 / accuracy) / decay())));
  const std::size_t all = std::max(alpha.size(), last + std::size_t{1});
  alpha.assign(all, 1.0 / center);    // of a longer plan, too, which has the same ones
  beta.assign(all, 0.0);
  double rho = 1.0 / ratio;
  for (std::size_t k = 2; k < all; ++k) {
    const double next = 1.0 / (2.0 * ratio - rho);
    alpha[k] = 2.0 * next / radius;
    beta[k] = next * rho * alpha[k - 1] / alpha[k];
    rho = next;
  }
  return last;
}

// Two iterations that follow each other have products of their own: blocks may be one apart.
float *LinearSolver::products(const RingBatches &rings, int k)
{
  return rings.corrections.product + (k % 2) * rings.corrections.products;
}

void LinearSolver::iterate(RingBatches b, const PairArrays &arrays, int k, int last,
                           const float *left, double gain) const
{
  float *const product = products(b, k);
  b.corrections.last_product = products(b, k - 1);
  b.corrections.product = product;
  if (k == 1 && left) {
    kernels.go_on(b, arrays, left);
  } else if (k == 1) {
    kernels.begin(b, arrays);
  } else if (k < last) {
    kernels.advance_and_multiply(b, alpha[k - 1], beta[k], gain);
  } else {
    kernels.advance_twice(b, alpha[last - 1], beta[last], alpha[last], gain);
  }
}

}    // namespace deformable
