// The ring law with given contact forces: the dual of soft_ring.h. The forces f >= 0 at the angles theta determine
// pressure, expansion and indentations of the ring without any inverse or active set.
//
// W(f) = max over a of f.a - U(a) is the convex conjugate of the energy. With the matrix G_cc' = G(theta_c -
// theta_c'), Q = f.Gf/2 and F = sum f,
//   L = f/p,   a = dW/df = Gf/p - delta,   S = Q/p^2,   W = 2Q/p - delta F - U,
// with U of stiffness.h, where p and delta solve, with the radius r = R - c of the ring (c: its skin), E = r + delta
// and the pressure at rest p0 = gamma/r,
//   p E - F/2 pi = gamma + 2 pi kP delta          (Laplace's law)
//   (p - p0)/kA = Q/p^2 - pi delta (2 r + delta)    (A0 - A)
// For kP = inf: delta = 0 and p^3 = kA Q. docs/theory/lines.md has the derivation.

#ifndef DEFORMABLE_RING_FORCES_H
#define DEFORMABLE_RING_FORCES_H

#include "laws/green.h"
#include "laws/stiffness.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deformable {

// Q and F of the forces on a ring.
struct RingLoad {
  double work, total;
};

// A ring under load. No pressure: a circle.
struct LoadedRing {
  double pressure = 0.0, expansion = 0.0;

  // A0 - A
  double area_deficit(double radius, const Stiffness &k, double work) const
  {
    if (k.gives_way(pressure)) return PI * radius * radius * (1.0 - k.yield / pressure);
    if (k.tension == 0.0 || std::isinf(k.kA)) return k.tension == 0.0 ? pressure / k.kA : 0.0;
    return work / (pressure * pressure) - PI * expansion * (2.0 * radius + expansion);
  }

  // U; with a tension, the formula of tense_ring in soft_ring.h
  double energy(double radius, const Stiffness &k, double work) const
  {
    if (!(pressure > 0.0)) return 0.0;
    if (k.gives_way(pressure)) {
      const double excess = 2.0 * PI * expansion, gas = k.yield * PI * radius * radius;
      return (k.tension + 0.5 * k.kP * excess) * excess + gas * std::log(pressure / k.yield);
    }
    if (k.tension > 0.0) {
      const double S = work / (pressure * pressure);
      const double D = area_deficit(radius, k, work);
      return k.rest_pressure(radius) * (S - PI * expansion * expansion) +
             (D == 0.0 ? 0.0 : 0.5 * k.kA * D * D) + 2.0 * PI * PI * k.kP * expansion * expansion;
    }
    const double by_perimeter =
        k.conserves_perimeter() ? 0.0 : 2.0 * PI * PI * k.kP * expansion * expansion;
    return 0.5 * pressure * (pressure / k.kA) + by_perimeter;
  }

  // W
  double conjugate(double radius, const Stiffness &k, const RingLoad &load) const
  {
    if (!(pressure > 0.0)) return 0.0;
    return 2.0 * load.work / pressure - expansion * load.total - energy(radius, k, load.work);
  }
};

// The stiffness of a small load: p (1/kA + r^2/kP) is about Q/p^2.
DEFORMABLE_INLINE double area_stiffness(double radius, const Stiffness &k)
{
  return 1.0 / (1.0 / k.kA + radius * radius / k.kP);
}

// In radii. Where no ring bears a load, Newton's method may run away: what it finds beyond is rounding, and no guess for
// the next load.
constexpr double LARGEST_EXPANSION = 1e6;

// A ring that has expanded by delta, see find_expansion. T is double, or several numbers side by side.
template <class T> struct Expanded {
  T E, above, p, deficit, h, slope;
};

template <class T>
DEFORMABLE_INLINE Expanded<T> expanded(T radius, T per_kA, T spring, T p0, T pull, T work, T delta)
{
  Expanded<T> at;
  at.E = radius + delta;
  at.above = ((spring - p0) * delta + pull) / at.E;
  at.p = p0 + at.above;
  at.deficit = work / (at.p * at.p);
  at.h = at.above * per_kA + PI * delta * (2.0 * radius + delta) - at.deficit;
  at.slope = 2.0 * PI * at.E + (per_kA + 2.0 * at.deficit / at.p) * (spring - at.p) / at.E;
  return at;
}

// A ring, its stiffness and its load. T is double, or a vector of doubles of several rings.
template <class T> struct RingUnderLoad {
  T radius, kA, kP, tension, pull, work;    // pull: F/2 pi
};

// The root delta of h(delta) = (p - p0)/kA + pi delta (2 r + delta) - Q/p^2, with
//   p - p0 = ((2 pi kP - p0) delta + F/2 pi)/E,
// so that no difference of large numbers remains in h, and
//   E h' = D = 2 pi E^2 + (2 pi kP - p) e,   e = 1/kA + 2 Q/p^3.
// Stable rings have D > 0; h < 0, or D < 0, to the left of that root. For kA = inf and kP = 0 the root is E = r/sqrt(1 - x),
// x = Q/pi (gamma + F/2 pi)^2. Newton's method starts from p and delta where p is positive. Returns of which rings of `open` a root is
// found: without it a negative area would be needed or, of one in a vector, it is far from where the method starts. `tense`: some
// ring may have a tension.
template <class T, class M>
DEFORMABLE_INLINE M find_expansion(const RingUnderLoad<T> &r, bool tense, M open, T &p, T &delta)
{
  constexpr double CLOSE = 1e-8;    // each step doubles the digits, so this one is the last
  constexpr double INF = std::numeric_limits<double>::infinity();
  constexpr int MOST = IS_ONE<T> ? 200 : 8;
  const T per_kA = 1.0 / r.kA, spring = 2.0 * PI * r.kP;
  T tension = r.pull, p0{};
  if (tense) {
    tension += r.tension;
    p0 = r.tension / r.radius;
  }
  T low = select(r.kP > 0.0, larger(-r.radius, -tension / spring), -r.radius);    // E > 0 and p > 0
  T high = T{} + INF;
  const M known = (p > 0.0) & (delta > low) & (delta < LARGEST_EXPANSION * r.radius);
  if constexpr (!IS_ONE<T>) {
    open &= known;
  } else if (!known) {
    delta = 0.0;
    // without the terms of second order in delta:  p^3 <= K (Q + p^2 r F/(2 pi kP))
    if (r.tension == 0.0) {
      const double K = 1.0 / (per_kA + r.radius * r.radius / r.kP);
      const double guess = std::cbrt(K * r.work) + K * r.radius / r.kP * tension;
      delta = larger((guess * r.radius - tension) / spring, 0.5 * low);
    }
  }
  M found{};
  if (tense) {
    const T x = r.work / (PI * tension * tension);
    found = open & (r.kA == INF) & (r.kP == 0.0) & (x < 1.0);
    const T part = root(1.0 - select(found, x, T{}));
    delta = select(found, r.radius * x / (part * (1.0 + part)), delta);
    if constexpr (IS_ONE<T>) {
      p = tension * part / r.radius;
      if (r.kA == INF && r.kP == 0.0) return found;
    }
    open &= !found;
  }
  for (int iteration = 0; iteration < MOST && any(open); ++iteration) {
    const Expanded<T> at = expanded(r.radius, per_kA, spring, p0, r.pull, r.work, delta);
    const M stable = at.slope > 0.0, above = stable & (at.h > 0.0);
    high = select(open & above, delta, high);
    low = select(open & !above, delta, low);
    T next = delta - at.h / at.slope;
    const M inside = stable & (low <= next) & (next <= high);
    if constexpr (IS_ONE<T>)
      if (!inside) next = high == INF ? 2.0 * at.E - r.radius : 0.5 * (low + high);
    T least = at.E * at.p / spring;
    if (tense) {
      // delta may vanish; a deficit of which little is balanced says nothing about its size
      const T lacks = magnitude(at.deficit);
      const M balanced = magnitude(at.h) <= 0.1 * lacks + 1e-14 * magnitude(at.above) * per_kA;
      least = select(p0 > 0.0, select(balanced, lacks * (0.5 / PI) / r.radius, T{}), least);
    }
    const M close = magnitude(next - delta) <= CLOSE * (magnitude(next) + least);
    delta = select(IS_ONE<T> ? open : open & inside, next, delta);
    found |= open & inside & close;
    open &= IS_ONE<T> ? !found : inside & !close;
  }
  p = p0 + ((spring - p0) * delta + r.pull) / (r.radius + delta);
  return found;
}

DEFORMABLE_INLINE bool find_expansion(double radius, const Stiffness &k, const RingLoad &load,
                                      LoadedRing &ring)
{
  const RingUnderLoad<double> r = {radius,   k.kA, k.kP, k.tension, load.total / (2.0 * PI),
                                   load.work};
  return find_expansion(r, true, true, ring.pressure, ring.expansion);
}

// Of a ring that gives way, with p = T/E and T = gamma + F/2 pi + 2 pi kP delta: the area pi E^2 - Q/p^2 is A0 y/p, so that
//   T - Q/(pi T) - A0 y/(pi E) = 0.
// The left side g grows with E = r + delta and is concave: Newton's method converges from where g < 0. `low`: T^2 = Q/pi or E = 0.
DEFORMABLE_INLINE bool find_expansion_of_gas(double radius, const Stiffness &k,
                                             const RingLoad &load, LoadedRing &ring)
{
  constexpr double CLOSE = 1e-8;
  const double spring = 2.0 * PI * k.kP, at_rest = k.tension + load.total / (2.0 * PI);
  const double gas = radius * radius * k.yield, work = load.work / PI;
  const double least = std::sqrt(std::max(work, 0.0));
  if (spring == 0.0 && at_rest <= least) return false;
  const double low = spring > 0.0 ? std::max(0.0, radius + (least - at_rest) / spring) : 0.0;
  double E = radius + ring.expansion;
  if (!(ring.pressure > 0.0 && E > low && E < LARGEST_EXPANSION * radius)) E = low + radius;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const double T = at_rest + spring * (E - radius), g = T - work / T - gas / E;
    double next = E - g / (spring * (1.0 + work / (T * T)) + gas / (E * E));
    const bool inside = next > low;
    if (!inside) next = 0.5 * (E + low);
    const bool close = std::fabs(next - E) <= CLOSE * next;
    E = next;
    if (!inside || !close) continue;
    ring = {(at_rest + spring * (E - radius)) / E, E - radius};
    return true;
  }
  return false;
}

// Pressure and expansion under a load; `ring` is also the first guess. Films that stick (contact_curve.h) may make Q a bit
// negative where the forces on a ring do not balance.
DEFORMABLE_INLINE bool find_pressure(double radius, const Stiffness &k, const RingLoad &load,
                                     LoadedRing &ring)
{
  constexpr double NOTHING = 1e-280;    // its square root is the least force that counts
  if (!(std::fabs(load.work) > NOTHING)) {
    ring = {k.rest_pressure(radius), 0.0};
    return true;
  }
  if (k.tension == 0.0 && k.conserves_perimeter()) {
    ring = {std::cbrt(k.kA * load.work), 0.0};
    return true;
  }
  const LoadedRing guess = ring;
  bool found = find_expansion(radius, k, load, ring);
  if (std::isfinite(k.yield) && (!found || k.gives_way(ring.pressure))) {
    ring = guess;
    found = find_expansion_of_gas(radius, k, load, ring);
  }
  return found && ring.expansion < LARGEST_EXPANSION * radius;
}

// C = da/df = G/p - mixed (b 1^T + 1 b^T) - square b b^T + rate 1 1^T, b = Gf/p, with
//   mixed = E/pD,   square = (2 pi kP - p)/p^2 D,   rate = e/2 pi D;   for kP = inf: 0, kA/3p^2, 0.
// C is positive semidefinite, the inverse of the stiffness of the active contacts.
template <class T> struct ComplianceOf {
  T per_pressure{}, mixed{}, square{}, rate{};

  T diagonal(T b) const
  {
    return GREEN_AT_ZERO * per_pressure - (2.0 * mixed + square * b) * b + rate;
  }
};
using RingCompliance = ComplianceOf<double>;

template <class T> DEFORMABLE_INLINE ComplianceOf<T> rigid_compliance(T p, T kA)
{
  const T per_p = 1.0 / p;
  return {per_p, T{}, kA * per_p * per_p * (1.0 / 3.0), T{}};
}

template <class T>
DEFORMABLE_INLINE ComplianceOf<T> soft_compliance(T p, T E, T work, T kA, T spring)
{
  const T per_p = 1.0 / p, e = 1.0 / kA + 2.0 * work / (p * p * p);
  const T excess = spring - p, per_D = 1.0 / (2.0 * PI * E * E + excess * e);
  return {per_p, E * per_p * per_D, excess * per_p * per_D * per_p, e * per_D * (0.5 / PI)};
}

DEFORMABLE_INLINE RingCompliance compliance_of(double radius, const Stiffness &k, double work,
                                               const LoadedRing &ring)
{
  const double p = ring.pressure;
  if (!(p > 0.0)) return {};
  if (k.conserves_perimeter()) return rigid_compliance(p, k.kA);
  return soft_compliance(p, radius + ring.expansion, work,
                         k.gives_way(p) ? k.yielding_kA(radius, p) : k.kA,
                         2.0 * PI * k.perimeter_stiffness(ring.expansion));
}

}    // namespace deformable

#endif
