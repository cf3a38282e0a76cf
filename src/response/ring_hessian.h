// Second derivatives of the energy of a ring by the indentations and the directions of its contacts.

#ifndef DEFORMABLE_RING_HESSIAN_H
#define DEFORMABLE_RING_HESSIAN_H

#include "laws/contact_stiffness.h"

#include <cmath>
#include <vector>

namespace deformable {

struct RingHessian {
  std::vector<double> block;    // of a of the n active contacts, then of theta: (2n)^2 entries

  // memory
  std::vector<double> inverse, d_green, turn, turned, gradient, rate;
  RingLCP lcp;
};

// With D_ck = G'(theta_c - theta_k) and M = diag(D L) - D diag(L), because G L = a:
//   dL/da = G^-1,   dL/dtheta = -G^-1 M,
//   S_aa = G^-1,   S_atheta = -G^-1 M,   S_thetatheta = E + M^T G^-1 M,
//   E_ck = L_c L_k G''(theta_c - theta_k) for c != k,   E_cc = - sum of the others in its row,
// and with s = (L, S_theta), S_theta = -L (D L), and r = (G^-1 1, -M^T G^-1 1), the derivatives of U are those of
// expansion_terms.
inline void ring_hessian(const RingState &ring, int n, const int *active, RingHessian &h)
{
  const int size = 2 * n;
  h.block.assign(size * size, 0.0);
  for (auto *values : {&h.inverse, &h.d_green, &h.turn, &h.turned}) values->assign(n * n, 0.0);
  for (auto *values : {&h.gradient, &h.rate}) values->assign(size, 0.0);
  green_inverse(ring.contacts, n, active, h.lcp, h.inverse.data());
  const double p = ring.pressure;
  const auto length = [&](int m) { return ring.response[active[m]].length; };
  const auto add = [&](int row, int column, double value) {
    h.block[row * size + column] += 0.5 * p * value;
    h.block[column * size + row] += 0.5 * p * value;
  };

  for (int c = 0; c < n; ++c) {
    const Contact to = ring.contacts[active[c]];
    double slope = 0.0;    // (D L)_c
    for (int k = 0; k < n; ++k) {
      if (k == c) continue;
      const Contact from = ring.contacts[active[k]];
      const double difference = to.angle - from.angle, sign = std::copysign(1.0, difference);
      const double sine = sign * (from.nx * to.ny - from.ny * to.nx);
      const double cosine = from.nx * to.nx + from.ny * to.ny;
      const double D = sign * d_green(std::fabs(difference), sine, cosine);
      const double E = length(c) * length(k) * dd_green(std::fabs(difference), sine, cosine);
      slope += D * length(k);
      h.turn[c * n + k] = -D * length(k);
      add(n + c, n + k, E);
      add(n + c, n + c, -E);
    }
    h.turn[c * n + c] = slope;
    h.gradient[c] = length(c);
    h.gradient[n + c] = -length(c) * slope;
  }
  double lengths = 0.0, rates = 0.0;
  for (int c = 0; c < n; ++c) {
    lengths += length(c);
    for (int k = 0; k < n; ++k) {
      h.rate[c] += h.inverse[c * n + k];
      for (int m = 0; m < n; ++m) h.turned[c * n + k] += h.inverse[c * n + m] * h.turn[m * n + k];
    }
    rates += h.rate[c];
  }
  for (int c = 0; c < n; ++c)
    for (int k = 0; k < n; ++k) {
      h.rate[n + c] -= h.turn[k * n + c] * h.rate[k];
      add(c, k, h.inverse[c * n + k]);
      add(c, n + k, -2.0 * h.turned[c * n + k]);
      for (int m = 0; m < n; ++m) add(n + c, n + k, h.turn[m * n + c] * h.turned[m * n + k]);
    }

  const ExpansionTerms terms = expansion_terms(ring, lengths, rates);
  for (int c = 0; c < size; ++c)
    for (int k = 0; k < size; ++k)
      h.block[c * size + k] +=
          terms.square * h.gradient[c] * h.gradient[k] +
          terms.mixed * (h.gradient[c] * h.rate[k] + h.rate[c] * h.gradient[k]) -
          terms.rates * h.rate[c] * h.rate[k];
}

}    // namespace deformable

#endif
