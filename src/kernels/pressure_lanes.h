// Pressure and compliance of rings with given forces, several side by side: the formulas of ring_forces.h in vectors.

#ifndef DEFORMABLE_PRESSURE_LANES_H
#define DEFORMABLE_PRESSURE_LANES_H

#include "kernels/force_kernels.h"
#include "kernels/lanes.h"
#include "laws/ring_forces.h"

namespace deformable::DEFORMABLE_LEVEL {

// p^3 = kA Q, from the last pressure where that is close: two steps of Halley's method, each of which triples the
// digits.
DEFORMABLE_LANE_FUNCTION Lanes cube_root(Lanes cube, Lanes guess)
{
  constexpr double CLOSE = 0.05, NOTHING = 1e-280;
  const Lanes guessed = guess * guess * guess;
  const Mask far = ~(magnitude(cube - guessed) <= CLOSE * guessed);
  if (any(far))
    for_each_lane([&](int w) DEFORMABLE_LANE_LAMBDA {
      if (far[w]) guess[w] = std::cbrt(cube[w]);
    });
  for (int step = 0; step < 2; ++step) {
    const Lanes third = guess * guess * guess;
    guess *= (third + 2.0 * cube) / (2.0 * third + cube + NOTHING);
  }
  return select(cube > NOTHING, guess, Lanes{});
}

// RingCompliance of W rings.
struct ComplianceLanes {
  Lanes per_pressure, mixed, square, rate;
};

// Pressure and compliance of rings that conserve their perimeter.
DEFORMABLE_LANE_FUNCTION ComplianceLanes press_rigid(const RingArrays &r)
{
  const Lanes kA = load<Lanes>(r.stiffness.kA);
  const Lanes p = cube_root(kA * load<Lanes>(r.work), load<Lanes>(r.pressure));
  const Lanes per_p = select(p > 0.0, 1.0 / select(p > 0.0, p, all(1.0)), Lanes{});
  store(r.pressure, p);
  store(r.per_pressure, per_p);
  return {per_p, Lanes{}, kA * per_p * per_p * (1.0 / 3.0), Lanes{}};
}

// find_expansion of ring_forces.h from the expansion of the last call, as long as Newton's method stays between its
// bounds. TENSE: some rings may have a tension, as in find_expansion_under_tension. Returns where that leads to a ring.
template <bool TENSE>
DEFORMABLE_LANE_FUNCTION Mask expand(const RingArrays &r, Lanes &pressure, Lanes &expansion)
{
  constexpr double CLOSE = 1e-8, NOTHING = 1e-280;
  constexpr int ITERATIONS = 8;
  const Lanes radius = load<Lanes>(r.radius), kA = load<Lanes>(r.stiffness.kA),
              kP = load<Lanes>(r.stiffness.kP);
  const Lanes work = load<Lanes>(r.work), most = LARGEST_EXPANSION * radius;
  const Lanes per_kA = 1.0 / kA, spring = 2.0 * PI * kP;
  const Lanes pull = load<Lanes>(r.total) * (0.5 / PI);
  Lanes tension = pull, p0 = Lanes{};
  if constexpr (TENSE) {
    tension += load<Lanes>(r.stiffness.tension);
    p0 = load<Lanes>(r.stiffness.tension) / radius;
  }
  Lanes low = larger(-radius, -tension / spring), high = all(__builtin_inf());
  Lanes delta = load<Lanes>(r.expansion);
  Mask open = (kP / kA < all(__builtin_inf())) & (magnitude(work) > NOTHING) & (delta > low) &
              (delta < most) & (load<Lanes>(r.pressure) > 0.0);
  Mask found = Mask{}, droplet = Mask{};
  Lanes droplet_delta = Lanes{};
  if constexpr (TENSE) {    // the closed form
    const Lanes x = work / (PI * tension * tension);
    droplet = open & (kA == all(__builtin_inf())) & (kP == Lanes{}) & (x < all(1.0));
    const Lanes part = root(1.0 - select(droplet, x, Lanes{}));
    droplet_delta = radius * x / (part * (1.0 + part));
    open &= ~droplet;
  }
  for (int iteration = 0; iteration < ITERATIONS && any(open); ++iteration) {
    const Lanes E = radius + delta;
    Lanes p = (spring * delta + tension) / E, above_rest = p;
    if constexpr (TENSE) {
      above_rest = ((spring - p0) * delta + pull) / E;
      p = p0 + above_rest;
    }
    const Lanes deficit = work / (p * p);
    const Lanes h = above_rest * per_kA + PI * delta * (2.0 * radius + delta) - deficit;
    const Lanes slope = 2.0 * PI * E + (per_kA + 2.0 * deficit / p) * (spring - p) / E;
    const Mask above = (slope > 0.0) & (h > 0.0);
    high = select(open & above, delta, high);
    low = select(open & ~above, delta, low);
    const Lanes next = delta - h / slope;
    const Mask inside = (slope > 0.0) & (low <= next) & (next <= high);
    Lanes size = magnitude(next) + E * p / spring;
    if constexpr (TENSE) {
      const Lanes lacks = magnitude(deficit);
      const Mask balanced = magnitude(h) <= 0.1 * lacks + 1e-14 * magnitude(above_rest) * per_kA;
      const Lanes least = select(balanced, lacks * (0.5 / PI) / radius, Lanes{});
      size = select(p0 > 0.0, magnitude(next) + least, size);
    }
    const Mask close = magnitude(next - delta) <= CLOSE * size;
    delta = select(open & inside, next, delta);
    found |= open & inside & close;
    open &= inside & ~close;
  }
  expansion = delta;
  pressure = (spring * delta + tension) / (radius + delta);
  if constexpr (TENSE) {
    expansion = select(droplet, droplet_delta, delta);
    pressure = p0 + ((spring - p0) * expansion + pull) / (radius + expansion);
  }
  return (found | droplet) & (expansion < most);
}

// Pressure, expansion and compliance of W rings; returns false where a ring does not exist.
template <bool SOFT> DEFORMABLE_LANE_FUNCTION bool press(const RingArrays &r, ComplianceLanes &c)
{
  if constexpr (!SOFT) {
    c = press_rigid(r);
    return true;
  } else {
    Lanes p, delta;
    bool exist = true;
    Mask found = r.stiffness.tension ? expand<true>(r, p, delta) : expand<false>(r, p, delta);
    if (r.stiffness.yield) found &= p <= load<Lanes>(r.stiffness.yield);
    if (!all_true(found))    // also rings of constant perimeter, which are rare beside others
      for (int w = 0; w < W; ++w) {
        if (found[w]) continue;
        LoadedRing ring = {r.pressure[w], r.expansion[w]};
        const Stiffness k = stiffness_at(r.stiffness, w);
        exist &= find_pressure(r.radius[w], k, {r.work[w], r.total[w]}, ring);
        p[w] = ring.pressure;
        delta[w] = ring.expansion;
      }
    // compliance_of in ring_forces.h
    const Lanes kP = load<Lanes>(r.stiffness.kP), zero = Lanes{};
    Lanes kA = load<Lanes>(r.stiffness.kA);
    if (r.stiffness.yield)
      for (int w = 0; w < W; ++w) {
        const Stiffness k = stiffness_at(r.stiffness, w);
        if (k.gives_way(p[w])) kA[w] = k.yielding_kA(r.radius[w], p[w]);
      }
    const Mask loaded = p > 0.0, rigid = ~(kP / kA < all(__builtin_inf()));
    const Lanes some_p = select(loaded, p, all(1.0)), per_p = 1.0 / some_p;
    const Lanes E = load<Lanes>(r.radius) + delta;
    const Lanes e = 1.0 / kA + 2.0 * load<Lanes>(r.work) / (some_p * some_p * some_p);
    const Lanes excess = 2.0 * PI * kP - some_p, per_D = 1.0 / (2.0 * PI * E * E + excess * e);
    const Mask changes = loaded & ~rigid;
    store(r.pressure, p);
    store(r.expansion, delta);
    c.per_pressure = select(loaded, per_p, zero);
    c.mixed = select(changes, E * per_p * per_D, zero);
    c.square = select(changes, excess * per_p * per_D * per_p,
                      select(loaded, kA * per_p * per_p * (1.0 / 3.0), zero));
    c.rate = select(changes, e * per_D * (0.5 / PI), zero);
    store(r.per_pressure, c.per_pressure);
    return exist;
  }
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
