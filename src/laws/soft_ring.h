// The ring law of a ring whose perimeter may change. The ring of radius r = R - c (c: thickness of a rigid skin
// around it) expands by delta, and its contacts have the indentations a + delta.
//
//   U = kA/2 (A - A0)^2 + kP/2 (P - P0)^2 + gamma (P - P0) - (gamma/r) (A - A0),
//   A0 - A = S - pi delta (2 r + delta),   P - P0 = 2 pi delta
// is smallest where Laplace's law holds: p q = gamma + kP (P - P0) with p = gamma/r + kA (A0 - A) and the mean
// radius of curvature q = r + delta - sum L/2 pi. docs/theory/laws.md has the derivation.

#ifndef DEFORMABLE_SOFT_RING_H
#define DEFORMABLE_SOFT_RING_H

#include "laws/ring.h"
#include "laws/stiffness.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deformable {

// While the same contacts are active:  S = deficit + sum delta + rate delta^2/2,  sum L = sum + rate delta. T is double, or a vector
// of doubles of several rings.
template <class T> struct BranchOf {
  T deficit, sum;    // S and sum L at delta = 0
  T rate;            // 1.G^-1.1
};
using Branch = BranchOf<double>;

// The root delta of f = 2 pi delta kP/kA - D q, D = A0 - A, on one branch, where with e = 1 - rate/2 pi
//   q = q0 + e delta,   D = S0 - pi delta (q0 + q),   f' = 2 pi kP/kA + 2 pi q^2 - e D.
// It lies between delta = 0 (kP = inf) and the delta where D = 0 (kA = inf). If no ring has this area, the
// far end is that of the largest ring, q = 0. Newton's method starts from the root for a constant q. `odd` becomes true where it
// does not end and, in vectors, of those rings of `which` that only a ring alone can be.
template <class T, class M>
DEFORMABLE_INLINE T expansion_of(const BranchOf<T> &branch, T radius, T ratio, M which, M &odd)
{
  constexpr double CLOSE = 1e-8;    // each step doubles the digits, so this one is the last
  constexpr int MOST = IS_ONE<T> ? 100 : 30;
  const T e = 1.0 - branch.rate * (0.5 / PI), q0 = radius - branch.sum * (0.5 / PI);
  const T drive = branch.deficit * q0, spring = 2.0 * PI * ratio;
  const T square = PI * q0 * q0 + e * branch.deficit;    // pi q^2 where D = 0
  T near{}, far = branch.deficit / (PI * q0);            // they enclose the root
  if constexpr (IS_ONE<T>) {
    if (drive == 0.0) return 0.0;
    if (!(square > 0.0)) far = -q0 / e;
    if (!(square > 0.0) && ratio == 0.0) return far;
  } else {
    odd |= which & !((q0 > 0.0) & (square > 0.0) & (drive > 0.0));
  }
  T delta = drive / (spring + 2.0 * PI * q0 * q0);
  delta = select(magnitude(delta) > magnitude(far), far, delta);
  const M by_area = ratio == 0.0;
  delta = select(by_area, branch.deficit / (PI * q0 + with_sign_of(root(PI * square), q0)), delta);
  M open = which & !by_area & !odd;
  for (int iteration = 0; any(open); ++iteration) {
    if (iteration == MOST) {
      odd |= open;
      break;
    }
    const T q = q0 + e * delta, deficit = branch.deficit - PI * delta * (q0 + q);
    const T f = spring * delta - deficit * q;
    const M beyond = (f > 0.0) == (q0 > 0.0);
    far = select(open & beyond, delta, far);
    near = select(open & !beyond, delta, near);
    const T next = delta - f / (spring + 2.0 * PI * q * q - e * deficit), step = next - delta;
    const M above = next >= smaller(near, far), below = next <= larger(near, far);
    const M inside = above & below;
    delta = select(open, select(inside, next, 0.5 * (near + far)), delta);
    open &= !(inside & (magnitude(step) <= CLOSE * magnitude(delta)));
  }
  return delta;
}

// The same with a line tension, of f = 2 pi delta kP/kA + (p0/kA) (r - q) - D q with the pressure at rest p0 =
// gamma/r and r - q = sum0/2 pi - e delta;  f' = 2 pi kP/kA + 2 pi q^2 - e (D + p0/kA).
// f is not negative where D = 0, from where Newton's method starts, and convex for e > 0, where the stable root is
// the larger one, concave for e < 0: so it converges without bounds. `odd` also becomes true where there is no root. rest: p0/kA.
template <class T, class M>
DEFORMABLE_INLINE T expansion_under_tension(const BranchOf<T> &branch, T radius, T ratio, T rest,
                                            M &odd)
{
  constexpr double CLOSE = 1e-8, ROUNDING = 1e-12;    // each step doubles the digits
  constexpr int MOST = IS_ONE<T> ? 100 : 30;
  const T e = 1.0 - branch.rate * (0.5 / PI), shorter = branch.sum * (0.5 / PI);
  const T q0 = radius - shorter, spring = 2.0 * PI * ratio;
  const T square = PI * q0 * q0 + e * branch.deficit;    // pi q^2 where D = 0
  const T q_by_area = root(larger(square, T{}) * (1.0 / PI));
  T by_area = branch.deficit / (PI * (q0 + q_by_area));
  const M common = (q0 > 0.0) & (square > 0.0);
  if constexpr (!IS_ONE<T>)
    odd |= !common;
  else if (!common)
    by_area = (q_by_area - q0) / e;
  M open = ((ratio > 0.0) | (rest > 0.0)) & !odd;
  odd |= !(open | (square > 0.0));
  T delta = by_area;
  for (int iteration = 0; any(open); ++iteration) {
    const T q = q0 + e * delta, deficit = branch.deficit - PI * delta * (q0 + q);
    const T f = spring * delta + rest * (shorter - e * delta) - deficit * q;
    const T slope = spring + 2.0 * PI * q * q - e * (deficit + rest);
    const M fails = open & !((slope > 0.0) & (q >= -ROUNDING * radius));
    odd |= fails;
    open &= !fails;
    if (iteration == MOST) {
      odd |= open;
      break;
    }
    const T step = f / slope;
    delta = select(open, delta - step, delta);
    open &= !(magnitude(step) <= CLOSE * (magnitude(delta) + magnitude(by_area)));
  }
  return delta;
}

// Of a ring that gives way, p = T/q and p A = y A0:  f = A T/y - A0 q,  T/y = gamma/y + 2 pi delta kP/y,  A = A0 - D. The root
// lies between T = 0 and q = 0, beyond which p would be negative; or D = 0, where p > y. Not a number if there is none.
inline double expansion_of_gas(const Branch &branch, double radius, double ratio, double rest)
{
  constexpr double CLOSE = 1e-8;
  const double e = 1.0 - branch.rate * (0.5 / PI), q0 = radius - branch.sum * (0.5 / PI);
  const double square = PI * q0 * q0 + e * branch.deficit, A0 = PI * radius * radius;
  const double slack = ratio > 0.0 ? std::max(-radius, -rest / (2.0 * PI * ratio)) : -radius;
  const bool grows = q0 + e * slack > 0.0;    // f < 0 at T = 0
  double end = -q0 / e;
  if (grows && q0 > 0.0 && square > 0.0)
    end = branch.deficit / (PI * (q0 + std::sqrt(square / PI)));
  double negative = grows ? slack : end, positive = grows ? end : slack, delta = end;
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double q = q0 + e * delta, A = A0 - branch.deficit + PI * delta * (q0 + q);
    const double T = rest + 2.0 * PI * ratio * delta, f = T * A - A0 * q;
    (f > 0.0 ? positive : negative) = delta;
    const double next = delta - f / (2.0 * PI * (ratio * A + T * q) - A0 * e);
    const bool inside =
        std::min(negative, positive) <= next && next <= std::max(negative, positive);
    const double step = next - delta;
    delta = inside ? next : 0.5 * (negative + positive);
    if (inside && std::fabs(step) <= CLOSE * std::fabs(delta)) return delta;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

struct SoftRing {
  double radius;             // R - c
  double ratio;              // kP/kA, finite
  double expansion;          // delta
  double rest = -1.0;        // p0/kA, not negative if there is a tension
  bool gives_way = false;    // then with y in place of kA, and gamma/y in place of p0/kA

  // Whether a ring that has left all of its contacts would shrink further by itself.
  bool shrinks_freely(int contacts) const
  {
    const double size = radius + expansion;
    return rest >= 0.0 && !gives_way && contacts == 0 && expansion < 0.0 &&
           2.0 * PI * ratio + PI * (radius + size) * size < rest;
  }

  double expansion_on(const Branch &branch) const
  {
    if (gives_way) return expansion_of_gas(branch, radius, ratio, rest);
    bool odd = false;
    const double found = rest < 0.0 ? expansion_of(branch, radius, ratio, true, odd)
                                    : expansion_under_tension(branch, radius, ratio, rest, odd);
    return odd ? std::numeric_limits<double>::quiet_NaN() : found;
  }

  // Finds delta from the lengths at delta = 0 and the factors of G; changes indentations and lengths to it.
  void expand(RingLCP &p)
  {
    double *const rate = p.block_length.data();
    std::fill_n(rate, p.size, 1.0);
    solve_factored(p.size, p.rows(p.green), p.scratch.data(), rate);
    Branch branch = {0.0, 0.0, 0.0};
    for (int m = 0; m < p.size; ++m) {
      branch.deficit += 0.5 * p.indentation[m] * p.length[m];
      branch.sum += p.length[m];
      branch.rate += rate[m];
    }
    expansion = expansion_on(branch);
    for (int m = 0; m < p.size; ++m) {
      p.indentation[m] += expansion;
      p.length[m] += expansion * rate[m];
    }
  }
};

// The contacts that are active at one delta give the next delta. `below` and `above` bound it.
inline void ring_shape_by_lcp(SoftRing &ring, const Contacts &contacts, RingLCP &p, Shape &shape)
{
  constexpr double ROUNDING = 1e-13, NONE = std::numeric_limits<double>::quiet_NaN();
  double below = -std::numeric_limits<double>::infinity(), above = -below;
  ring.expansion = 0.0;
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double delta = ring.expansion;
    solve_all(contacts, delta, p);
    double *const rate = p.block_length.data();
    std::fill_n(rate, p.active_count, 1.0);
    solve_factored(p.active_count, p.rows(p.block), p.scratch.data(), rate);
    Branch branch = {0.0, 0.0, 0.0};
    for (int k = 0; k < p.active_count; ++k) {
      const int m = p.active[k];
      branch.deficit += 0.5 * p.indentation[m] * p.length[m];
      branch.sum += p.length[m];
      branch.rate += rate[k];
    }
    branch.deficit -= delta * (branch.sum - 0.5 * delta * branch.rate);
    branch.sum -= delta * branch.rate;

    const double next = ring.shrinks_freely(p.active_count) ? NONE : ring.expansion_on(branch);
    if (std::fabs(next - delta) <= ROUNDING * std::fabs(next)) break;
    if (std::isnan(next)) {
      ring.expansion = next;
      break;
    }
    (next > delta ? below : above) = delta;
    ring.expansion = below < next && next < above ? next : 0.5 * (below + above);
  }
  fill_shape(ring.radius + ring.expansion, p, shape);
}

// The energy of a ring under tension without differences of large numbers: with p - p0 = kA (A0 - A),
//   U = p0 (S - pi delta^2) + [(p - p0) (A0 - A) + kP (P - P0)^2]/2
struct TenseRing {
  double pressure, area_deficit, energy;
};

// S, A0 - A, q and sum L/2 pi of the ring that has expanded by delta
DEFORMABLE_INLINE TenseRing tense_ring(double radius, const Stiffness &k, double delta, double S,
                                       double deficit, double q, double shorter)
{
  const double p0 = k.rest_pressure(radius), stretched = k.kP * 2.0 * PI * delta;
  // from Laplace's law, or from the area, whichever loses fewer digits
  const bool by_tension = std::isinf(k.kA) || deficit * (radius + delta) <= std::fabs(q) * S;
  const double above = by_tension ? (stretched + p0 * (shorter - delta)) / q : k.kA * deficit;
  const double D = above / k.kA;
  return {p0 + above, D,
          p0 * (S - PI * delta * delta) + 0.5 * (above * D + stretched * 2.0 * PI * delta)};
}

// A ring that gives way, see stiffness.h.
inline Energy gas_ring_shape(double radius, const Stiffness &k, const Contacts &contacts,
                             char *is_active, RingLCP &p, Shape &shape)
{
  SoftRing ring = {radius, k.kP / k.yield, 0.0, k.tension / k.yield, true};
  ring_shape(ring, contacts, is_active, p, shape);
  const double delta = ring.expansion, excess = 2.0 * PI * delta, A0 = PI * radius * radius;
  shape.perimeter_excess = excess;
  shape.area_deficit -= PI * delta * (2.0 * radius + delta);
  const double pressure = k.yield * A0 / (A0 - shape.area_deficit);
  return {(k.tension + 0.5 * k.kP * excess) * excess + k.yield * A0 * std::log(pressure / k.yield),
          pressure};
}

// Shape and energy of a ring of radius R - c, also of one that conserves its perimeter. The derivatives of the energy are
// those in `shape` times the pressure. Returns whether the shape exists: with infinite kA the contacts may leave too little area.
inline bool soft_ring_shape(double radius, const Stiffness &stiffness, const Contacts &contacts,
                            char *is_active, RingLCP &p, Shape &shape, Energy &energy)
{
  if (stiffness.conserves_perimeter()) {
    ring_shape(radius, contacts, is_active, p, shape);
    energy = harmonic(stiffness.kA, shape.area_deficit);
    return true;
  }
  if (std::isfinite(stiffness.yield)) {
    Stiffness firm = stiffness;
    firm.yield = std::numeric_limits<double>::infinity();
    if (soft_ring_shape(radius, firm, contacts, is_active, p, shape, energy) &&
        !stiffness.gives_way(energy.derivative))
      return true;
    energy = gas_ring_shape(radius, stiffness, contacts, is_active, p, shape);
    return std::isfinite(energy.derivative);
  }
  SoftRing ring = {radius, stiffness.ratio(), 0.0};
  if (stiffness.tension > 0.0) ring.rest = stiffness.rest_pressure(radius) / stiffness.kA;
  ring_shape(ring, contacts, is_active, p, shape);

  const double delta = ring.expansion, excess = 2.0 * PI * delta;
  const double deficit = shape.area_deficit - PI * delta * (2.0 * radius + delta);
  shape.perimeter_excess = excess;
  double q = radius + delta;
  for (int c = 0; c < contacts.size; ++c) q -= shape.contact[c].length * (0.5 / PI);
  if (stiffness.tension > 0.0) {
    double shorter = 0.0;
    for (int c = 0; c < contacts.size; ++c) shorter += shape.contact[c].length * (0.5 / PI);
    const TenseRing tense =
        tense_ring(radius, stiffness, delta, shape.area_deficit, deficit, q, shorter);
    shape.area_deficit = tense.area_deficit;
    energy = {tense.energy, tense.pressure};
    return std::isfinite(tense.pressure);
  }
  // both sides of Laplace's law give p: take the one that loses fewer digits to a difference of large numbers
  const bool by_tension = deficit * (radius + delta) <= std::fabs(q) * shape.area_deficit;
  const double pressure = by_tension ? stiffness.kP * excess / q : stiffness.kA * deficit;

  shape.area_deficit = pressure / stiffness.kA;
  energy = {0.5 * (pressure * shape.area_deficit + stiffness.kP * excess * excess), pressure};
  return std::isfinite(pressure);
}

}    // namespace deformable

#endif
