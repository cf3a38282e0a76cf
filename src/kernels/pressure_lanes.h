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

using ComplianceLanes = ComplianceOf<Lanes>;

// Pressure and compliance of rings that conserve their perimeter.
DEFORMABLE_LANE_FUNCTION ComplianceLanes press_rigid(const RingArrays &r)
{
  const Lanes kA = load<Lanes>(r.stiffness.kA);
  const Lanes p = cube_root(kA * load<Lanes>(r.work), load<Lanes>(r.pressure));
  const Mask loaded = p > 0.0;
  ComplianceLanes c = rigid_compliance(select(loaded, p, all(1.0)), kA);
  c.per_pressure = select(loaded, c.per_pressure, Lanes{});
  c.square = select(loaded, c.square, Lanes{});
  store(r.pressure, p);
  store(r.per_pressure, c.per_pressure);
  return c;
}

// find_expansion of ring_forces.h from the expansion of the last call, as long as Newton's method stays between its
// bounds. Returns where that leads to a ring.
DEFORMABLE_LANE_FUNCTION Mask expand(const RingArrays &r, Lanes &pressure, Lanes &expansion)
{
  constexpr double CLOSE = 1e-8, NOTHING = 1e-280;
  constexpr int ITERATIONS = 8;
  const bool tense = r.stiffness.tension;    // some rings may have a tension
  const Lanes radius = load<Lanes>(r.radius), kA = load<Lanes>(r.stiffness.kA),
              kP = load<Lanes>(r.stiffness.kP);
  const Lanes work = load<Lanes>(r.work), most = LARGEST_EXPANSION * radius;
  const Lanes per_kA = 1.0 / kA, spring = 2.0 * PI * kP;
  const Lanes pull = load<Lanes>(r.total) * (0.5 / PI);
  Lanes tension = pull, p0 = Lanes{};
  if (tense) {
    tension += load<Lanes>(r.stiffness.tension);
    p0 = load<Lanes>(r.stiffness.tension) / radius;
  }
  Lanes low = larger(-radius, -tension / spring), high = all(__builtin_inf());
  Lanes delta = load<Lanes>(r.expansion);
  Mask open = (kP / kA < all(__builtin_inf())) & (magnitude(work) > NOTHING) & (delta > low) &
              (delta < most) & (load<Lanes>(r.pressure) > 0.0);
  Mask found = Mask{};
  if (tense) {    // the closed form
    const Lanes x = work / (PI * tension * tension);
    found = open & (kA == all(__builtin_inf())) & (kP == Lanes{}) & (x < all(1.0));
    const Lanes part = root(1.0 - select(found, x, Lanes{}));
    delta = select(found, radius * x / (part * (1.0 + part)), delta);
    open &= ~found;
  }
  for (int iteration = 0; iteration < ITERATIONS && any(open); ++iteration) {
    const Expanded<Lanes> at = expanded(radius, per_kA, spring, p0, pull, work, delta);
    const Mask above = (at.slope > 0.0) & (at.h > 0.0);
    high = select(open & above, delta, high);
    low = select(open & ~above, delta, low);
    const Lanes next = delta - at.h / at.slope;
    const Mask inside = (at.slope > 0.0) & (low <= next) & (next <= high);
    Lanes least = at.E * at.p / spring;
    if (tense) {
      const Lanes lacks = magnitude(at.deficit);
      const Mask balanced = magnitude(at.h) <= 0.1 * lacks + 1e-14 * magnitude(at.above) * per_kA;
      least = select(p0 > 0.0, select(balanced, lacks * (0.5 / PI) / radius, Lanes{}), least);
    }
    const Mask close = magnitude(next - delta) <= CLOSE * (magnitude(next) + least);
    delta = select(open & inside, next, delta);
    found |= open & inside & close;
    open &= inside & ~close;
  }
  expansion = delta;
  pressure = p0 + ((spring - p0) * delta + pull) / (radius + delta);
  return found & (expansion < most);
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
    Mask found = expand(r, p, delta);
    if (r.stiffness.yield) found &= p <= load<Lanes>(r.stiffness.yield);
    c = soft_compliance(select(found, p, all(1.0)), load<Lanes>(r.radius) + delta,
                        load<Lanes>(r.work), load<Lanes>(r.stiffness.kA),
                        2.0 * PI * load<Lanes>(r.stiffness.kP));
    if (!all_true(found))    // also rings of constant perimeter, which are rare beside others
      for (int w = 0; w < W; ++w) {
        if (found[w]) continue;
        LoadedRing ring = {r.pressure[w], r.expansion[w]};
        const Stiffness k = stiffness_at(r.stiffness, w);
        exist &= find_pressure(r.radius[w], k, {r.work[w], r.total[w]}, ring);
        p[w] = ring.pressure;
        delta[w] = ring.expansion;
        const RingCompliance one = compliance_of(r.radius[w], k, r.work[w], ring);
        c.per_pressure[w] = one.per_pressure;
        c.mixed[w] = one.mixed;
        c.square[w] = one.square;
        c.rate[w] = one.rate;
      }
    store(r.pressure, p);
    store(r.expansion, delta);
    store(r.per_pressure, c.per_pressure);
    return exist;
  }
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
