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

// A matrix in memory, one row after the other: g[r][c].
struct MatrixRows {
  double *memory;
  int stride;
  double *operator[](int r) const { return memory + r * stride; }
};

// x = (D L^T)^-1 x. T is double, or a vector of doubles of several particles; loops unroll where n is a constant.
template <class Matrix, class T>
DEFORMABLE_INLINE void back_substitute(int n, const Matrix &g, const T *per_pivot, T *x)
{
#pragma GCC unroll 8
  for (int c = n - 1; c >= 0; --c) {
#pragma GCC unroll 8
    for (int r = c + 1; r < n; ++r) x[c] -= g[r][c] * x[r];
    x[c] *= per_pivot[c];
  }
}

// x = G^-1 x by L D L^T in place. Ends, and returns false, where stops(row, whether its pivot vanishes) is true: the direction of
// that contact is, up to rounding, the direction of a contact before it.
template <class Matrix, class T, class Stops>
DEFORMABLE_INLINE bool solve_dense(int n, Matrix &&g, T *x, T *per_pivot, Stops &&stops)
{
  constexpr double SMALLEST_PIVOT = 1e-13;
#pragma GCC unroll 8
  for (int c = 0; c < n; ++c) {
    const T pivot = g[c][c];
    if (stops(c, pivot < SMALLEST_PIVOT)) return false;
    per_pivot[c] = 1.0 / pivot;
#pragma GCC unroll 8
    for (int r = c + 1; r < n; ++r) {
      const T scaled = g[r][c] * per_pivot[c];
      x[r] -= scaled * x[c];
#pragma GCC unroll 8
      for (int k = c + 1; k <= r; ++k) g[r][k] -= scaled * g[k][c];
    }
  }
  back_substitute(n, g, per_pivot, x);
  return true;
}

// x = G^-1 x with the factors that solve_dense has left in g and per_pivot.
template <class Matrix, class T>
DEFORMABLE_INLINE void solve_factored(int n, const Matrix &g, const T *per_pivot, T *x)
{
#pragma GCC unroll 8
  for (int c = 0; c < n; ++c) {
    const T scaled = x[c] * per_pivot[c];
#pragma GCC unroll 8
    for (int r = c + 1; r < n; ++r) x[r] -= g[r][c] * scaled;
  }
  back_substitute(n, g, per_pivot, x);
}

// The angle t between two contacts: its sign, |t|, sin |t| and cos |t|.
struct AngleBetween {
  bool negative;
  double magnitude, sine, cosine;
};

// The contacts that may be active, and the memory of the problem.
struct RingLCP {
  // a DUPLICATE has the direction of a deeper contact
  enum State : char { FREE, ACTIVE, DUPLICATE };

  int size = 0;
  int stride = 0;
  int active_count = 0;
  std::vector<int> contact, active;
  std::vector<double> angle, nx, ny, indentation;
  std::vector<double> green, d_green;    // lower triangles
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

  // from contact m to another one
  AngleBetween angle_to(int m, const Contact &to) const
  {
    const double difference = to.angle - angle[m], cross = nx[m] * to.ny - ny[m] * to.nx;
    const bool negative = difference < 0.0;
    return {negative, std::fabs(difference), negative ? -cross : cross,
            nx[m] * to.nx + ny[m] * to.ny};
  }

  void add(const Contacts &contacts, int c, double expansion, State as)
  {
    const Contact added = contacts[c];
    const int m = size++;
    candidate[c] = 1;
    state[m] = as;
    contact[m] = c;
    angle[m] = added.angle;
    nx[m] = added.nx;
    ny[m] = added.ny;
    indentation[m] = added.indentation + expansion;
    double *const row = &green[m * stride], *const d_row = &d_green[m * stride];
    for (int k = 0; k < m; ++k) {
      const AngleBetween t = angle_to(k, added);
      const double slope = deformable::d_green(t.magnitude, t.sine, t.cosine);
      row[k] = deformable::green(t.magnitude, t.sine, t.cosine);
      d_row[k] = t.negative ? -slope : slope;
    }
    row[m] = GREEN_AT_ZERO;
  }

  MatrixRows rows(std::vector<double> &matrix) const { return {matrix.data(), stride}; }
  double between(int m, int k) const { return green[m > k ? m * stride + k : k * stride + m]; }
};

// Whether the outline between the first n contacts, moved out by `expansion`, reaches the line of another one.
inline bool reaches(const RingLCP &p, int n, const Contact &contact, double expansion)
{
  double gap = contact.indentation;
  for (int m = 0; m < n; ++m)
    gap -= p.length[m] * green_bound(p.nx[m] * contact.nx + p.ny[m] * contact.ny);
  if (!(gap > -expansion)) return false;
  gap = contact.indentation;    // a - G L
  for (int m = 0; m < n; ++m) {
    const AngleBetween t = p.angle_to(m, contact);
    gap -= p.length[m] * green(t.magnitude, t.sine, t.cosine);
  }
  return gap > -expansion;
}

// x = G^-1 x. Returns -1, or the row where G is singular.
inline int solve_dense(int n, const MatrixRows &g, double *x, double *per_pivot)
{
  int singular = -1;
  solve_dense(n, g, x, per_pivot, [&](int row, bool vanishes) {
    if (vanishes) singular = row;
    return vanishes;
  });
  return singular;
}

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
    const int row = solve_dense(n, p.rows(p.block), p.block_length.data(), p.scratch.data());
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
