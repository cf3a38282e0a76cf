// How stiffly a ring answers its contacts. Newton's method asks for that when rings look for the lines on which
// their forces agree.

#ifndef DEFORMABLE_BALANCE_H
#define DEFORMABLE_BALANCE_H

#include "ring_programme.h"
#include "stiffness.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace deformable {

// A ring that has come to rest between its contacts.
struct PressedRing {
  double radius, breath;    // R - c, delta
  Stiffness stiffness;
  double pressure;
  Contacts contacts;
  const Response *response;
};

// How far its outline stays off the line of a contact that does not carry.
inline double room_before(const PressedRing &ring, int c)
{
  const Contact to = ring.contacts[c];
  double room = -to.indentation - ring.breath;
  for (int m = 0; m < ring.contacts.size; ++m) {
    const Contact from = ring.contacts[m];
    const double length = ring.response[m].length, difference = to.angle - from.angle;
    if (length == 0.0) continue;
    const double cross = from.nx * to.ny - from.ny * to.nx;
    room += length * green(std::fabs(difference), std::copysign(1.0, difference) * cross,
                           from.nx * to.nx + from.ny * to.ny);
  }
  return room;
}

// G^-1 of the contacts that carry, which stays the same as long as these and their directions do. False where
// directions coincide up to rounding.
template <int N>
bool inverse_of(const Contacts &contacts, const int *carrying, double *inverse)
{
  int contact[N];
  double angle[N], nx[N], ny[N], indentation[N], green[N * N], d_green[N * N], per_pivot[N];
  const RingCandidates r = {N, contact, angle, nx, ny, indentation, green, d_green};
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) add_candidate(r, m, contacts, carrying[m]);
  if (solve_dense(N, green, N, indentation, per_pivot) >= 0) return false;
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) {
    double row[N] = {};
    row[m] = 1.0;
    solve_again(N, green, N, per_pivot, row);
#pragma GCC unroll 8
    for (int k = 0; k < N; ++k) inverse[m * N + k] = row[k];
  }
  return true;
}

inline bool inverse_of_any(const Contacts &contacts, int n, const int *carrying, RingProgramme &p,
                           double *inverse)
{
  p.clear(n);
  const RingCandidates r = p.candidates();
  for (int m = 0; m < n; ++m) add_candidate(r, m, contacts, carrying[m]);
  if (solve_dense(n, r.green, p.stride, r.indentation, p.scratch.data()) >= 0) return false;
  for (int m = 0; m < n; ++m) {
    double *const row = inverse + m * n;
    row[m] = 1.0;
    solve_again(n, r.green, p.stride, p.scratch.data(), row);
  }
  return true;
}

// `inverse` has n^2 places. Where directions coincide any matrix that is positive will do.
inline void green_inverse(const Contacts &contacts, int n, const int *carrying, RingProgramme &p,
                          double *inverse)
{
  bool regular = true;
  std::fill_n(inverse, n * n, 0.0);
  switch (n) {
    case 0: break;
    case 1: regular = inverse_of<1>(contacts, carrying, inverse); break;
    case 2: regular = inverse_of<2>(contacts, carrying, inverse); break;
    case 3: regular = inverse_of<3>(contacts, carrying, inverse); break;
    case 4: regular = inverse_of<4>(contacts, carrying, inverse); break;
    case 5: regular = inverse_of<5>(contacts, carrying, inverse); break;
    case 6: regular = inverse_of<6>(contacts, carrying, inverse); break;
    case 7: regular = inverse_of<7>(contacts, carrying, inverse); break;
    default: regular = inverse_of_any(contacts, n, carrying, p, inverse);
  }
  if (!regular)
    for (int m = 0; m < n; ++m) inverse[m * n + m] = 1.0 / GREEN_AT_ZERO;
}

// K = dF/da, F_c = p L_c, of the n contacts that carry. With the area deficit D, dD/da = L, and r = G^-1 1 =
// d^2D/da ddelta it is kA L L^T + p G^-1 at fixed delta; the breath takes
//   f f^T/u,  f = dF/ddelta = p r - 2 pi q kA L,  u = d^2U/ddelta^2 = 4 pi^2 q^2 kA + w,
//   w = p (1.G^-1.1 - 2 pi) + 4 pi^2 kP
// off it. Ordered by L and r, all terms are finite for kA = inf. `rate` is memory for r.
inline void contact_stiffness(const PressedRing &ring, int n, const int *carrying,
                              const double *inverse, std::vector<double> &rate, double *stiffness)
{
  const double p = ring.pressure, kA = ring.stiffness.kA;
  double square = kA, mixed = 0.0, rates = 0.0;    // of L L^T, L r^T + r L^T, -r r^T
  rate.assign(n, 0.0);
  if (!ring.stiffness.conserves_perimeter()) {
    double turn = 2.0 * PI * (ring.radius + ring.breath), sum = 0.0;    // 2 pi q
    for (int m = 0; m < n; ++m) {
      for (int k = 0; k < n; ++k) rate[m] += inverse[m * n + k];
      sum += rate[m];
      turn -= ring.response[carrying[m]].length;
    }
    const double w = p * (sum - 2.0 * PI) + 4.0 * PI * PI * ring.stiffness.kP;
    const double per = 1.0 / (turn * turn + w / kA);
    square = w * per;
    mixed = turn * p * per;
    rates = p / kA * p * per;
  }
  for (int m = 0; m < n; ++m) {
    const double length = ring.response[carrying[m]].length;
    const double by_length = square * length + mixed * rate[m];
    const double by_rate = mixed * length - rates * rate[m];
    for (int k = 0; k < n; ++k)
      stiffness[m * n + k] = p * inverse[m * n + k] +
                             by_length * ring.response[carrying[k]].length + by_rate * rate[k];
  }
}

}    // namespace deformable

#endif
