// The stiffness of a ring's contacts, dF/da. Newton's method needs it to balance contacts.

#ifndef DEFORMABLE_CONTACT_STIFFNESS_H
#define DEFORMABLE_CONTACT_STIFFNESS_H

#include "laws/ring_lcp.h"
#include "laws/stiffness.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace deformable {

// A ring in equilibrium between its contacts.
struct RingState {
  double radius, expansion;    // R - c, delta
  Stiffness stiffness;
  double pressure;
  Contacts contacts;
  const Response *response;
};

// Distance between the outline and the line of a contact that is not active.
inline double gap_to_line(const RingState &ring, int c)
{
  const Contact to = ring.contacts[c];
  double gap = -to.indentation - ring.expansion;
  for (int m = 0; m < ring.contacts.size; ++m) {
    const Contact from = ring.contacts[m];
    const double length = ring.response[m].length, difference = to.angle - from.angle;
    if (length == 0.0) continue;
    const double cross = from.nx * to.ny - from.ny * to.nx;
    gap += length * green(std::fabs(difference), std::copysign(1.0, difference) * cross,
                          from.nx * to.nx + from.ny * to.ny);
  }
  return gap;
}

// G^-1 of the active contacts. It depends on their directions only. Returns false where directions coincide up
// to rounding.
template <int N>
bool small_green_inverse(const Contacts &contacts, const int *active, double *inverse)
{
  int contact[N];
  double angle[N], nx[N], ny[N], indentation[N], green[N * N], d_green[N * N], per_pivot[N];
  const RingCandidates r = {N, contact, angle, nx, ny, indentation, green, d_green};
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) add_candidate(r, m, contacts, active[m]);
  if (solve_dense(N, green, N, indentation, per_pivot) >= 0) return false;
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) {
    double row[N] = {};
    row[m] = 1.0;
    solve_factored(N, green, N, per_pivot, row);
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) inverse[m * N + k] = row[k];
  }
  return true;
}

inline bool any_green_inverse(const Contacts &contacts, int n, const int *active, RingLCP &p,
                              double *inverse)
{
  p.clear(n);
  const RingCandidates r = p.candidates();
  for (int m = 0; m < n; ++m) add_candidate(r, m, contacts, active[m]);
  if (solve_dense(n, r.green, p.stride, r.indentation, p.scratch.data()) >= 0) return false;
  for (int m = 0; m < n; ++m) {
    double *const row = inverse + m * n;
    row[m] = 1.0;
    solve_factored(n, r.green, p.stride, p.scratch.data(), row);
  }
  return true;
}

// `inverse` has n^2 entries. Where directions coincide a diagonal matrix takes its place: Newton's method needs
// a positive one only.
inline void green_inverse(const Contacts &contacts, int n, const int *active, RingLCP &p,
                          double *inverse)
{
  bool regular = true;
  std::fill_n(inverse, n * n, 0.0);
  switch (n) {
    case 0: break;
    case 1: regular = small_green_inverse<1>(contacts, active, inverse); break;
    case 2: regular = small_green_inverse<2>(contacts, active, inverse); break;
    case 3: regular = small_green_inverse<3>(contacts, active, inverse); break;
    case 4: regular = small_green_inverse<4>(contacts, active, inverse); break;
    case 5: regular = small_green_inverse<5>(contacts, active, inverse); break;
    case 6: regular = small_green_inverse<6>(contacts, active, inverse); break;
    case 7: regular = small_green_inverse<7>(contacts, active, inverse); break;
    default: regular = any_green_inverse(contacts, n, active, p, inverse);
  }
  if (!regular)
    for (int m = 0; m < n; ++m) inverse[m * n + m] = 1.0 / GREEN_AT_ZERO;
}

// Second derivatives of the energy by any variables y of the area deficit D, with s = dD/dy and r = d^2D/dy ddelta:
//   d^2U/dy dy = p d^2D/dy dy + kA s s^T - f f^T/u,   f = d^2U/dy ddelta = p r - 2 pi q kA s,
//   u = d^2U/ddelta^2 = 4 pi^2 q^2 kA + w,   w = p (1.G^-1.1 - 2 pi) + 4 pi^2 kP,
// where the last term is that of the radial expansion. These are the factors of s s^T, s r^T + r s^T and -r r^T, which
// are finite for kA = inf too; `lengths` is the sum of L, `rates` 1.G^-1.1.
struct ExpansionTerms {
  double square, mixed, rates;
};

inline ExpansionTerms expansion_terms(const RingState &ring, double lengths, double rates)
{
  const double p = ring.pressure, kA = ring.stiffness.kA;
  if (ring.stiffness.conserves_perimeter()) return {kA, 0.0, 0.0};
  const double two_pi_q = 2.0 * PI * (ring.radius + ring.expansion) - lengths;
  const double w =
      p * (rates - 2.0 * PI) + 4.0 * PI * PI * ring.stiffness.perimeter_stiffness(ring.expansion);
  const double per = 1.0 / (two_pi_q * two_pi_q + w / kA);
  return {w * per, two_pi_q * p * per, p / kA * p * per};
}

// K = dF/da, F_c = p L_c, of the n active contacts: dD/da = L, d^2D/da da = G^-1, r = G^-1 1. `rate` is memory for r.
inline void contact_stiffness(const RingState &ring, int n, const int *active,
                              const double *inverse, std::vector<double> &rate, double *stiffness)
{
  const double p = ring.pressure;
  double lengths = 0.0, rates = 0.0;
  rate.assign(n, 0.0);
  for (int m = 0; m < n; ++m) {
    for (int k = 0; k < n; ++k) rate[m] += inverse[m * n + k];
    rates += rate[m];
    lengths += ring.response[active[m]].length;
  }
  const ExpansionTerms terms = expansion_terms(ring, lengths, rates);
  for (int m = 0; m < n; ++m) {
    const double length = ring.response[active[m]].length;
    const double by_length = terms.square * length + terms.mixed * rate[m];
    const double by_rate = terms.mixed * length - terms.rates * rate[m];
    for (int k = 0; k < n; ++k)
      stiffness[m * n + k] =
          p * inverse[m * n + k] + by_length * ring.response[active[k]].length + by_rate * rate[k];
  }
}

}    // namespace deformable

#endif
