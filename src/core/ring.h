// Contact law "ring": contacts slip. An inextensible ring, pinned by its Steiner point at the particle's
// centre, is pressed by frictionless contact lines; it takes the shape of largest area.
//
// With H(theta) the support function of the outline, P = int H and A = 1/2 int (H^2 - H'^2), the largest
// A at fixed P and Steiner point under H(theta_c) <= h_c is the convex quadratic programme
//   maximise a.L - 1/2 L.G L over L >= 0,   G_cc' = G(theta_c - theta_c'),
// whose multipliers L are the contact lengths: S = 1/2 a.L, H(theta) = R - sum_c L_c G(theta - theta_c).
// docs/theory.md derives it.

#ifndef DEFORMABLE_RING_H
#define DEFORMABLE_RING_H

#include "shape.h"
#include "trigonometry.h"

#include <algorithm>
#include <limits>

namespace deformable {

// Green function of -u'' - u on the angular modes n >= 2, for 0 <= t <= 2 pi; even and 2 pi periodic:
//   G(t) = [1/2 + cos t/4 - (pi - t) sin t/2]/pi
inline double green(double t, double sine, double cosine)
{
  return (0.5 + 0.25 * cosine - 0.5 * (PI - t) * sine) * (1.0 / PI);
}

// dG/dt, 0 < t < 2 pi; odd, with a jump of -1 at t = 0
inline double d_green(double t, double sine, double cosine)
{
  return (0.25 * sine - 0.5 * (PI - t) * cosine) * (1.0 / PI);
}

constexpr double GREEN_AT_ZERO = 0.75 / PI;

// G(t) >= -GREEN_DEPTH: no outline bulges by more than GREEN_DEPTH sum_c L_c
constexpr double GREEN_DEPTH = 0.0923;

// The quadratic programme over the contacts that may be active, and the memory to solve it in.
struct RingProgramme {
  int size = 0;
  std::vector<int> contact;          // index of each candidate in Contacts
  std::vector<double> matrix;        // G, row by row, `stride` apart
  std::vector<double> length;        // the solution
  std::vector<int> active;           // the candidates in the factored block
  std::vector<char> state;           // FREE, ACTIVE or DUPLICATE of another direction
  std::vector<double> unit, scaled;  // the factor of the active block: G = unit diag unit^T
  std::vector<double> per_pivot;
  std::vector<double> rhs;
  std::size_t stride = 0;

  enum State : char { FREE, ACTIVE, DUPLICATE };

  void clear(std::size_t capacity)
  {
    size = 0;
    if (capacity <= stride) return;
    stride = capacity;
    contact.resize(stride);
    length.resize(stride);
    active.resize(stride);
    state.resize(stride);
    per_pivot.resize(stride);
    rhs.resize(stride);
    matrix.resize(stride * stride);
    unit.resize(stride * stride);
    scaled.resize(stride * stride);
  }

  void add(const Contacts &contacts, int c)
  {
    double *row = &matrix[size * stride];
    for (int m = 0; m < size; ++m) {
      const int b = contact[m];
      const double difference = contacts.angle[c] - contacts.angle[b];
      const double cross = contacts.nx[b] * contacts.ny[c] - contacts.ny[b] * contacts.nx[c];
      const double g = green(std::fabs(difference), std::copysign(1.0, difference) * cross,
                             contacts.nx[b] * contacts.nx[c] + contacts.ny[b] * contacts.ny[c]);
      row[m] = g;
      matrix[m * stride + size] = g;
    }
    row[size] = GREEN_AT_ZERO;
    contact[size] = c;
    length[size] = 0.0;
    state[size] = FREE;
    ++size;
  }
};

// L = G^-1 a on the active block, by L D L^T. A direction that the block already holds, up to rounding,
// makes a pivot vanish: of the two contacts the deeper one carries everything.
inline void solve_active(RingProgramme &p, const Contacts &contacts)
{
  constexpr double SMALLEST_PIVOT = 1e-13;
  const auto indentation = [&](int m) { return contacts.indentation[p.contact[m]]; };

  int n = 0;
  for (int m = 0; m < p.size; ++m) {
    p.length[m] = 0.0;
    if (p.state[m] == RingProgramme::ACTIVE) p.active[n++] = m;
  }

  for (int r = 0; r < n; ++r) {
    const double *g = &p.matrix[p.active[r] * p.stride];
    double *unit = &p.unit[r * p.stride], *scaled = &p.scaled[r * p.stride];
    double pivot = g[p.active[r]], y = indentation(p.active[r]);
    for (int c = 0; c < r; ++c) {
      double v = g[p.active[c]];
      const double *above = &p.unit[c * p.stride];
      for (int k = 0; k < c; ++k) v -= scaled[k] * above[k];
      scaled[c] = v;
      unit[c] = v * p.per_pivot[c];
      pivot -= v * unit[c];
      y -= unit[c] * p.rhs[c];
    }
    if (pivot < SMALLEST_PIVOT) {
      int twin = p.active[0];
      for (int c = 1; c < r; ++c)
        if (g[p.active[c]] > g[twin]) twin = p.active[c];
      const int shallow = indentation(twin) < indentation(p.active[r]) ? twin : p.active[r];
      p.state[shallow] = RingProgramme::DUPLICATE;
      return solve_active(p, contacts);
    }
    p.per_pivot[r] = 1.0 / pivot;
    p.rhs[r] = y;
  }
  for (int r = n - 1; r >= 0; --r) {
    double v = p.rhs[r] * p.per_pivot[r];
    for (int k = r + 1; k < n; ++k) v -= p.unit[k * p.stride + r] * p.length[p.active[k]];
    p.length[p.active[r]] = v;
  }
}

// L >= 0, g = a - G L <= 0, L.g = 0 by block principal pivoting: exchange every contact that violates its
// condition as long as their number falls, one at a time (Murty's rule, which must end) where it does not.
// J. J. Judice and F. M. Pires, Comput. Oper. Res. 21, 587 (1994).
inline void solve(RingProgramme &p, const Contacts &contacts)
{
  constexpr double EPSILON = std::numeric_limits<double>::epsilon();
  int fewest = p.size + 1, patience = 3;
  for (int iteration = 0; iteration < 100 + 10 * p.size; ++iteration) {
    solve_active(p, contacts);
    double sum = 0.0;
    for (int m = 0; m < p.size; ++m) sum += std::fabs(p.length[m]);

    // rhs is done with: it marks the violations
    int violations = 0, last = -1;
    for (int m = 0; m < p.size; ++m) {
      bool violates = false;
      if (p.state[m] == RingProgramme::ACTIVE) {
        violates = p.length[m] < 0.0;
      } else if (p.state[m] == RingProgramme::FREE) {
        const double a = contacts.indentation[p.contact[m]];
        const double *g = &p.matrix[m * p.stride];
        double gap = a;
        for (int k = 0; k < p.size; ++k) gap -= g[k] * p.length[k];
        violates = gap > 8.0 * EPSILON * (std::fabs(a) + sum);
      }
      p.rhs[m] = violates;
      if (violates) {
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
    const bool all = falls || patience-- > 0;
    for (int m = all ? 0 : last; m < p.size; ++m)
      if (p.rhs[m] != 0.0)
        p.state[m] =
            p.state[m] == RingProgramme::ACTIVE ? RingProgramme::FREE : RingProgramme::ACTIVE;
  }
  for (int m = 0; m < p.size; ++m) p.length[m] = std::max(p.length[m], 0.0);
}

// S = 1/2 a.L,  dS/da_c = L_c,  dS/dtheta_c = -L_c sum_{c' != c} L_c' G'(theta_c - theta_c')
// Smallest radius of curvature: q - |m| with q = R - sum L/2 pi and m = (1/pi) sum L_c n_c.
inline void ring_shape(double radius, const Contacts &contacts, RingProgramme &p, Shape &shape)
{
  shape.clear(contacts.size);
  shape.arc_radius = radius;
  p.clear(contacts.size);

  // The indented contacts decide how far the outline bulges, and so which others it can reach.
  for (int c = 0; c < contacts.size; ++c)
    if (contacts.indentation[c] > 0.0) {
      p.add(contacts, c);
      p.state[p.size - 1] = RingProgramme::ACTIVE;
    }
  if (p.size == 0) return;
  solve(p, contacts);

  const int indented = p.size;
  if (indented < contacts.size) {
    double sum = 0.0;
    for (int m = 0; m < p.size; ++m) sum += p.length[m];
    for (int c = 0; c < contacts.size; ++c)
      if (contacts.indentation[c] <= 0.0 && contacts.indentation[c] > -GREEN_DEPTH * sum)
        p.add(contacts, c);
    if (p.size > indented) solve(p, contacts);
  }

  double sum = 0.0, twice_deficit = 0.0, mx = 0.0, my = 0.0;
  for (int m = 0; m < p.size; ++m) {
    const double length = p.length[m];
    if (length == 0.0) continue;
    const int c = p.contact[m];
    shape.contact_length[c] = shape.d_indentation[c] = length;
    sum += length;
    twice_deficit += contacts.indentation[c] * length;
    mx += length * contacts.nx[c];
    my += length * contacts.ny[c];
    for (int k = 0; k < m; ++k) {
      const int b = p.contact[k];
      const double difference = contacts.angle[c] - contacts.angle[b];
      const double sign = std::copysign(1.0, difference);
      const double cross = contacts.nx[b] * contacts.ny[c] - contacts.ny[b] * contacts.nx[c];
      const double d_angle =
          -length * p.length[k] * sign *
          d_green(std::fabs(difference), sign * cross,
                  contacts.nx[b] * contacts.nx[c] + contacts.ny[b] * contacts.ny[c]);
      shape.d_angle[c] += d_angle;
      shape.d_angle[b] -= d_angle;
    }
  }
  shape.area_deficit = 0.5 * twice_deficit;
  shape.arc_radius = radius - sum / (2.0 * PI) - std::sqrt(mx * mx + my * my) / PI;
}

// The outline's support function in one direction:
//   H = R - sum L G,  H' = -sum L G',  rho = H + H'' = q - (1/pi) sum L cos   (between contacts)
struct Support {
  double height, d_height, curvature_radius;
};

inline Support ring_support(double radius, const Contacts &contacts, const Shape &shape, double theta)
{
  Support support = {radius, 0.0, radius};
  for (int c = 0; c < contacts.size; ++c) {
    const double length = shape.contact_length[c];
    if (length == 0.0) continue;
    double t = std::remainder(theta - contacts.angle[c], 2.0 * PI);
    const double sign = t < 0.0 ? -1.0 : 1.0;
    t = std::fabs(t);
    const double sine = std::sin(t), cosine = std::cos(t);
    support.height -= length * green(t, sine, cosine);
    support.d_height -= length * sign * d_green(t, sine, cosine);
    support.curvature_radius -= length * (0.5 + cosine) / PI;
  }
  return support;
}

// Largest H - R: how far the outline reaches out of the circle it came from. The best of 48 directions
// is refined by Newton on H' = 0, with H'' = rho - H.
inline double ring_bulge(double radius, const Contacts &contacts, const Shape &shape)
{
  constexpr int SAMPLES = 48;
  double best = 0.0, at = 0.0;
  for (int k = 0; k < SAMPLES; ++k) {
    const double theta = 2.0 * PI * k / SAMPLES;
    const double height = ring_support(radius, contacts, shape, theta).height - radius;
    if (height > best) {
      best = height;
      at = theta;
    }
  }
  if (best == 0.0) return 0.0;
  for (int step = 0; step < 4; ++step) {
    const Support support = ring_support(radius, contacts, shape, at);
    best = std::max(best, support.height - radius);
    const double second = support.curvature_radius - support.height;
    if (second >= 0.0) break;
    at -= support.d_height / second;
  }
  return best;
}

}    // namespace deformable

#endif
