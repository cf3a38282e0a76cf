// The linear complementarity problem (LCP) of the ring law: L >= 0, g = a - G L <= 0, L.g = 0.

#ifndef DEFORMABLE_RING_LCP_H
#define DEFORMABLE_RING_LCP_H

#include "laws/green.h"
#include "laws/shape.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace deformable {

// These functions are written for any number of contacts n. The compiler makes a separate copy for each small
// n (ring_shape) and unrolls all loops: a particle has 3 to 7 contacts, and loops of unknown short length
// would cost more than the arithmetic: DEFORMABLE_INLINE.

// The contacts that may be active. Of the matrices G and G' only the lower triangle is stored.
struct RingCandidates {
  int stride;
  int *contact;    // indices in Contacts
  double *angle, *nx, *ny, *indentation;
  double *green, *d_green;
};

// The angle t from candidate k to a contact: its sign, |t|, sin |t| and cos |t|.
struct AngleBetween {
  bool negative;
  double magnitude, sine, cosine;
};

DEFORMABLE_INLINE AngleBetween angle_between(const RingCandidates &r, int k, const Contact &to)
{
  const double difference = to.angle - r.angle[k];
  const double cross = r.nx[k] * to.ny - r.ny[k] * to.nx;
  const bool negative = difference < 0.0;
  return {negative, std::fabs(difference), negative ? -cross : cross,
          r.nx[k] * to.nx + r.ny[k] * to.ny};
}

DEFORMABLE_INLINE void add_candidate(const RingCandidates &r, int m, const Contacts &contacts,
                                     int c)
{
  const Contact contact = contacts[c];
  r.contact[m] = c;
  r.angle[m] = contact.angle;
  r.nx[m] = contact.nx;
  r.ny[m] = contact.ny;
  r.indentation[m] = contact.indentation;
#pragma GCC unroll 8
  for (int k = 0; k < m; ++k) {
    const AngleBetween t = angle_between(r, k, contact);
    const double slope = d_green(t.magnitude, t.sine, t.cosine);
    r.green[m * r.stride + k] = green(t.magnitude, t.sine, t.cosine);
    r.d_green[m * r.stride + k] = t.negative ? -slope : slope;
  }
  r.green[m * r.stride + m] = GREEN_AT_ZERO;
}

// x = (D L^T)^-1 x
DEFORMABLE_INLINE void back_substitute(int n, const double *g, int stride, const double *per_pivot,
                                       double *x)
{
#pragma GCC unroll 8
  for (int c = n - 1; c >= 0; --c) {
#pragma GCC unroll 8
    for (int r = c + 1; r < n; ++r) x[c] -= g[r * stride + c] * x[r];
    x[c] *= per_pivot[c];
  }
}

// x = G^-1 x by L D L^T in place. Returns -1, or the row whose pivot vanishes: the direction of that contact
// is, up to rounding, the direction of a contact before it.
DEFORMABLE_INLINE int solve_dense(int n, double *g, int stride, double *x, double *per_pivot)
{
  constexpr double SMALLEST_PIVOT = 1e-13;
#pragma GCC unroll 8
  for (int c = 0; c < n; ++c) {
    const double pivot = g[c * stride + c];
    if (pivot < SMALLEST_PIVOT) return c;
    per_pivot[c] = 1.0 / pivot;
#pragma GCC unroll 8
    for (int r = c + 1; r < n; ++r) {
      const double scaled = g[r * stride + c] * per_pivot[c];
      x[r] -= scaled * x[c];
#pragma GCC unroll 8
      for (int k = c + 1; k <= r; ++k) g[r * stride + k] -= scaled * g[k * stride + c];
    }
  }
  back_substitute(n, g, stride, per_pivot, x);
  return -1;
}

// x = G^-1 x with the factors that solve_dense has left in g and per_pivot.
DEFORMABLE_INLINE void solve_factored(int n, const double *g, int stride, const double *per_pivot,
                                      double *x)
{
#pragma GCC unroll 8
  for (int c = 0; c < n; ++c) {
    const double scaled = x[c] * per_pivot[c];
#pragma GCC unroll 8
    for (int r = c + 1; r < n; ++r) x[r] -= g[r * stride + c] * scaled;
  }
  back_substitute(n, g, stride, per_pivot, x);
}

// Whether the outline, moved out by `expansion`, may reach a contact line outside of the circle. May return true
// by mistake, never false.
DEFORMABLE_INLINE bool may_reach(const Contacts &contacts, int c, int n, const RingCandidates &r,
                                 const double *length, double expansion)
{
  double gap = contacts[c].indentation;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m)
    gap -= length[m] * green_bound(r.nx[m] * contacts[c].nx + r.ny[m] * contacts[c].ny);
  return gap > -expansion;
}

// g = a - G L of a contact that is not active; negative where the outline does not reach its line.
DEFORMABLE_INLINE double slack(const Contacts &contacts, int c, int n, const RingCandidates &r,
                               const double *length)
{
  double gap = contacts[c].indentation;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const AngleBetween t = angle_between(r, m, contacts[c]);
    gap -= length[m] * green(t.magnitude, t.sine, t.cosine);
  }
  return gap;
}

// The problem for any number of contacts, and its memory.
struct RingLCP {
  // a DUPLICATE has the direction of a deeper contact
  enum State : char { FREE, ACTIVE, DUPLICATE };

  int size = 0;
  int stride = 0;
  int active_count = 0;
  std::vector<int> contact, active;
  std::vector<double> angle, nx, ny, indentation, green, d_green;
  std::vector<State> state;
  std::vector<double> length;    // the solution
  std::vector<double> block, block_length, scratch;
  std::vector<char> violates;
  std::vector<char> candidate;    // by index in Contacts

  void clear(int capacity)
  {
    size = 0;
    if (capacity <= stride) return;
    stride = capacity;
    for (std::vector<int> *v : {&contact, &active}) v->resize(stride);
    for (std::vector<double> *v :
         {&angle, &nx, &ny, &indentation, &length, &block_length, &scratch})
      v->resize(stride);
    state.resize(stride);
    violates.resize(stride);
    candidate.resize(stride);
    for (std::vector<double> *v : {&green, &d_green, &block})
      v->resize(static_cast<std::size_t>(stride) * stride);
  }

  RingCandidates candidates()
  {
    return {stride,    contact.data(),     angle.data(), nx.data(),
            ny.data(), indentation.data(), green.data(), d_green.data()};
  }

  void add(const Contacts &contacts, int c, double expansion, State as)
  {
    add_candidate(candidates(), size, contacts, c);
    indentation[size] += expansion;
    candidate[c] = 1;
    state[size++] = as;
  }

  double between(int m, int k) const { return green[m > k ? m * stride + k : k * stride + m]; }
};

// L = G^-1 a of the active contacts. Of two contacts in the same direction only the deeper one is active.
inline void solve_active(RingLCP &p)
{
  for (bool again = true; again;) {
    int n = 0;
    for (int m = 0; m < p.size; ++m) {
      p.length[m] = 0.0;
      if (p.state[m] == RingLCP::ACTIVE) p.active[n++] = m;
    }
    p.active_count = n;
    for (int r = 0; r < n; ++r) {
      for (int c = 0; c <= r; ++c) p.block[r * p.stride + c] = p.between(p.active[r], p.active[c]);
      p.block_length[r] = p.indentation[p.active[r]];
    }
    const int row =
        solve_dense(n, p.block.data(), p.stride, p.block_length.data(), p.scratch.data());
    again = row >= 0;
    if (again) {
      const int m = p.active[row];
      int twin = p.active[0];
      for (int c = 1; c < row; ++c)
        if (p.between(m, p.active[c]) > p.between(m, twin)) twin = p.active[c];
      p.state[p.indentation[twin] < p.indentation[m] ? twin : m] = RingLCP::DUPLICATE;
    } else {
      for (int r = 0; r < n; ++r) p.length[p.active[r]] = p.block_length[r];
    }
  }
}

// Solves L >= 0, g = a - G L <= 0, L.g = 0 by block principal pivoting: every contact that violates its
// condition changes sides while the number of violations falls. Otherwise only the last one does (Murty's
// rule, which always ends).
// J. J. Judice and F. M. Pires, Comput. Oper. Res. 21, 587 (1994).
inline void solve(RingLCP &p)
{
  constexpr double ROUNDING = 8.0 * std::numeric_limits<double>::epsilon();
  int fewest = p.size + 1, patience = 3;
  for (int iteration = 0; iteration < 100 + 10 * p.size; ++iteration) {
    solve_active(p);

    int violations = 0, last = 0;
    double sum = 0.0;
    for (int m = 0; m < p.size; ++m) sum += std::fabs(p.length[m]);
    for (int m = 0; m < p.size; ++m) {
      p.violates[m] = 0;
      if (p.state[m] == RingLCP::ACTIVE) {
        p.violates[m] = p.length[m] < 0.0;
      } else if (p.state[m] == RingLCP::FREE) {
        double gap = p.indentation[m];
        for (int k = 0; k < p.size; ++k) gap -= p.between(m, k) * p.length[k];
        p.violates[m] = gap > ROUNDING * (std::fabs(p.indentation[m]) + sum);
      }
      if (p.violates[m]) {
        ++violations;
        last = m;
      }
    }
    if (violations == 0) return;

    const bool falls = violations < fewest;
    if (falls) {
      fewest = violations;
      patience = 3;
    }
    for (int m = falls || patience-- > 0 ? 0 : last; m < p.size; ++m)
      if (p.violates[m])
        p.state[m] = p.state[m] == RingLCP::ACTIVE ? RingLCP::FREE : RingLCP::ACTIVE;
  }
  for (int m = 0; m < p.size; ++m) p.length[m] = std::max(p.length[m], 0.0);
}

}    // namespace deformable

#endif
