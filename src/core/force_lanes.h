// Rings with given forces, several side by side: the formulas of ring_forces.h in vectors.
//
// Kernels are templates of the number of contacts, so that all loops unroll; 0 contacts stands for a number known at
// run time only.

#ifndef DEFORMABLE_FORCE_LANES_H
#define DEFORMABLE_FORCE_LANES_H

#include "force_kernels.h"
#include "lane_geometry.h"
#include "ring_forces.h"

namespace deformable::DEFORMABLE_LEVEL {

// The arrays of W rings of one batch: those of all batches from their place on.
DEFORMABLE_LANE_FUNCTION RingArrays rings_of(RingArrays r, int ring)
{
  for (const double **p : {&r.radius, &r.kA, &r.kP}) *p += ring;
  if (r.tension) r.tension += ring;
  for (double **p : {&r.pressure, &r.expansion, &r.work, &r.total, &r.per_pressure, &r.mixed,
                     &r.square, &r.rate})
    *p += ring;
  return r;
}

DEFORMABLE_LANE_FUNCTION ContactArrays contacts_of(ContactArrays c, int contact, int green)
{
  c.seat += contact;
  for (double **p : {&c.indentation, &c.compliance, &c.product}) *p += contact;
  for (double **p : {&c.green, &c.d_green}) *p += green;
  return c;
}

// COUNT numbers for each of n contacts.
template <int SIZE, int COUNT> struct OfContacts {
  Lanes memory[COUNT][SIZE];
  OfContacts(int, double *) {}
  Lanes *operator[](int k) { return memory[k]; }
};

template <int COUNT> struct OfContacts<0, COUNT> {
  int n;
  Lanes *memory;
  OfContacts(int n, double *scratch) : n(n), memory(reinterpret_cast<Lanes *>(scratch)) {}
  Lanes *operator[](int k) { return memory + k * n; }
};

// The row m of a lower triangle.
DEFORMABLE_LANE_FUNCTION double *row_of(double *triangle, int m)
{
  return triangle + m * (m - 1) / 2 * LANES;
}

DEFORMABLE_LANE_FUNCTION Lanes of_pairs(const double *x, const int *seat)
{
  return each_lane([&](int w) DEFORMABLE_LANE_LAMBDA { return x[seat[w] >> 1]; });
}

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

// Rings of a tension alone that conserve their area: the closed form of find_expansion_under_tension, and
// compliance_of.
DEFORMABLE_LANE_FUNCTION bool press_droplets(const RingArrays &r)
{
  constexpr double NOTHING = 1e-280;
  const Lanes radius = load<Lanes>(r.radius), work = load<Lanes>(r.work);
  const Lanes gamma = load<Lanes>(r.tension), tension = gamma + load<Lanes>(r.total) / (2.0 * PI);
  const Mask loaded = work > all(NOTHING);
  const Lanes x = select(loaded, work / (PI * tension * tension), Lanes{});
  const Mask exist = x < all(1.0);
  const Lanes part = root(1.0 - select(exist, x, Lanes{}));
  const Lanes p = select(loaded, tension * part / radius, gamma / radius);
  const Lanes delta = radius * x / (part * (1.0 + part)), E = radius + delta;
  const Lanes e = 2.0 * work / (p * p * p), per_D = 1.0 / (2.0 * PI * E * E - p * e);
  store(r.pressure, p);
  store(r.expansion, delta);
  store(r.per_pressure, 1.0 / p);
  store(r.mixed, E / p * per_D);
  store(r.square, -p / p * per_D / p);
  store(r.rate, e * per_D / (2.0 * PI));
  return !any(~exist);
}

DEFORMABLE_LANE_FUNCTION bool are_droplets(const RingArrays &r)
{
  return r.tension &&
         !any(~((load<Lanes>(r.kA) == all(__builtin_inf())) & (load<Lanes>(r.kP) == Lanes{})));
}

// Pressure, expansion and compliance of W rings; returns false where a ring does not exist.
template <bool SOFT> DEFORMABLE_LANE_FUNCTION bool press(const RingArrays &r)
{
  if constexpr (SOFT) {
    if (are_droplets(r)) return press_droplets(r);
    bool exist = true;
    for (int w = 0; w < W; ++w) {
      const Stiffness k = {r.kA[w], r.kP[w], r.tension ? r.tension[w] : 0.0};
      LoadedRing ring = {r.pressure[w], r.expansion[w]};
      exist &= find_pressure(r.radius[w], k, {r.work[w], r.total[w]}, ring);
      const RingCompliance c = compliance_of(r.radius[w], k, r.work[w], ring);
      r.pressure[w] = ring.pressure;
      r.expansion[w] = ring.expansion;
      r.per_pressure[w] = c.per_pressure;
      r.mixed[w] = c.mixed;
      r.square[w] = c.square;
      r.rate[w] = c.rate;
    }
    return exist;
  } else {
    const Lanes kA = load<Lanes>(r.kA);
    const Lanes p = cube_root(kA * load<Lanes>(r.work), load<Lanes>(r.pressure));
    const Lanes per_p = select(p > 0.0, 1.0 / select(p > 0.0, p, all(1.0)), Lanes{});
    store(r.pressure, p);
    store(r.per_pressure, per_p);
    store(r.square, kA * per_p * per_p * (1.0 / 3.0));
    return true;
  }
}

// Shapes the rings for the forces of their pairs. NEW computes G and G' from the directions, which otherwise are
// those of the last call.
template <int SIZE, bool SOFT, bool NEW>
DEFORMABLE_LANE_FUNCTION bool shape_lanes(const PairDirections &pairs, int contacts,
                                          const ContactArrays &c, const RingArrays &rings)
{
  const int n = SIZE > 0 ? SIZE : contacts;
  OfContacts<SIZE, 5> of(n, c.scratch);
  Lanes *const force = of[0], *const product = of[1], *const angle = of[2];
  Lanes *const nx = of[3], *const ny = of[4];
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const int *const seat = c.seat + m * LANES;
    force[m] = of_pairs(pairs.force, seat);
    product[m] = GREEN_AT_ZERO * force[m];
    if constexpr (NEW) {
      const Lanes sign =
          each_lane([&](int w) DEFORMABLE_LANE_LAMBDA { return 1.0 - 2.0 * (seat[w] & 1); });
      const Lanes seen = of_pairs(pairs.angle, seat);
      angle[m] = select(sign > 0.0, seen, select(seen > 0.0, seen - PI, seen + PI));
      nx[m] = sign * of_pairs(pairs.nx, seat);
      ny[m] = sign * of_pairs(pairs.ny, seat);
    }
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      double *const g = row_of(c.green, m) + k * LANES;
      if constexpr (NEW) {
        const AngleLanes t = angles_between(angle[k], {nx[k], ny[k]}, angle[m], {nx[m], ny[m]});
        const Lanes slope = d_green(t.magnitude, t.sine, t.cosine);
        store(g, green(t.magnitude, t.sine, t.cosine));
        store(row_of(c.d_green, m) + k * LANES, select(t.negative, -slope, slope));
      }
      const Lanes between = load<Lanes>(g);
      product[m] += between * force[k];
      product[k] += between * force[m];
    }
  }
  Lanes work = Lanes{}, total = Lanes{};
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    work += force[m] * product[m];
    total += force[m];
  }
  store(rings.work, 0.5 * work);
  store(rings.total, total);
  const bool exist = press<SOFT>(rings);
  const Lanes per_p = load<Lanes>(rings.per_pressure), square = load<Lanes>(rings.square);
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const Lanes b = product[m] * per_p;
    Lanes a = b, diagonal = GREEN_AT_ZERO * per_p;
    if constexpr (SOFT) {
      a -= load<Lanes>(rings.expansion);
      diagonal += load<Lanes>(rings.rate) - 2.0 * load<Lanes>(rings.mixed) * b;
    }
    diagonal -= square * b * b;
    store(c.indentation + m * LANES, a);
    store(c.compliance + m * LANES, select(per_p > 0.0, diagonal, all(__builtin_inf())));
  }
  return exist;
}

// C x of each ring, x by pair, the product by contact.
template <int SIZE, bool SOFT>
DEFORMABLE_LANE_FUNCTION void multiply_lanes(const double *x, int contacts, const ContactArrays &c,
                                             const RingArrays &rings)
{
  const int n = SIZE > 0 ? SIZE : contacts;
  OfContacts<SIZE, 2> of(n, c.scratch);
  Lanes *const own = of[0], *const product = of[1];
  Lanes along = Lanes{}, sum = Lanes{}, delta = Lanes{};
  if constexpr (SOFT) delta = load<Lanes>(rings.expansion);
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    own[m] = of_pairs(x, c.seat + m * LANES);
    product[m] = GREEN_AT_ZERO * own[m];
    const Lanes a = load<Lanes>(c.indentation + m * LANES);
    along += (SOFT ? a + delta : a) * own[m];
    if constexpr (SOFT) sum += own[m];
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      const Lanes between = load<Lanes>(row_of(c.green, m) + k * LANES);
      product[m] += between * own[k];
      product[k] += between * own[m];
    }
  }
  const Lanes per_p = load<Lanes>(rings.per_pressure);
  Lanes of_b = load<Lanes>(rings.square) * along, constant = Lanes{};
  if constexpr (SOFT) {
    const Lanes mixed = load<Lanes>(rings.mixed);
    of_b += mixed * sum;
    constant = load<Lanes>(rings.rate) * sum - mixed * along;
  }
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const Lanes a = load<Lanes>(c.indentation + m * LANES);
    Lanes y = per_p * product[m] - of_b * (SOFT ? a + delta : a);
    if constexpr (SOFT) y += constant;
    store(c.product + m * LANES, y);
  }
}

// The slope of the outline at each contact, sum_k L_k G'(theta_c - theta_k); -f_c times that is dU/dtheta_c.
template <int SIZE>
DEFORMABLE_LANE_FUNCTION void slope_lanes(const double *force, int contacts, const ContactArrays &c,
                                          const RingArrays &rings)
{
  const int n = SIZE > 0 ? SIZE : contacts;
  OfContacts<SIZE, 2> of(n, c.scratch);
  Lanes *const own = of[0], *const slope = of[1];
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    own[m] = of_pairs(force, c.seat + m * LANES);
    slope[m] = Lanes{};
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      const Lanes between = load<Lanes>(row_of(c.d_green, m) + k * LANES);
      slope[m] += between * own[k];
      slope[k] -= between * own[m];
    }
  }
  const Lanes per_p = load<Lanes>(rings.per_pressure);
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) store(c.product + m * LANES, per_p * slope[m]);
}

// kernel(n, number of contacts, contacts, rings) for each vector of rings, n a constant for the usual numbers.
template <class Kernel> DEFORMABLE_LANE_FUNCTION void for_all(const RingBatches &b, Kernel &&kernel)
{
  for (int batch = 0; batch < b.batches; ++batch)
    for (int w = 0; w < LANES; w += W) {
      const int n = b.size[batch];
      const RingArrays r = rings_of(b.rings, batch * LANES + w);
      const ContactArrays c = contacts_of(b.contacts, b.first[batch] + w, b.first_green[batch] + w);
      switch (n) {
        case 3: kernel(std::integral_constant<int, 3>(), n, c, r); break;
        case 4: kernel(std::integral_constant<int, 4>(), n, c, r); break;
        case 5: kernel(std::integral_constant<int, 5>(), n, c, r); break;
        case 6: kernel(std::integral_constant<int, 6>(), n, c, r); break;
        case 7: kernel(std::integral_constant<int, 7>(), n, c, r); break;
        case 8: kernel(std::integral_constant<int, 8>(), n, c, r); break;
        default: kernel(std::integral_constant<int, 0>(), n, c, r);
      }
    }
}

template <bool SOFT, bool NEW>
static bool shape_all(const RingBatches &b, const PairDirections &pairs)
{
  bool exist = true;
  for_all(b, [&](auto size, int n, const ContactArrays &c, const RingArrays &r)
                 DEFORMABLE_LANE_LAMBDA {
                   exist &= shape_lanes<decltype(size)::value, SOFT, NEW>(pairs, n, c, r);
                 });
  return exist;
}

static bool shape_rings(const RingBatches &b, const PairDirections &p, bool new_directions)
{
  if (b.soft) return new_directions ? shape_all<true, true>(b, p) : shape_all<true, false>(b, p);
  return new_directions ? shape_all<false, true>(b, p) : shape_all<false, false>(b, p);
}

template <bool SOFT> static void multiply_all(const RingBatches &b, const double *x)
{
  for_all(b,
          [&](auto size, int n, const ContactArrays &c, const RingArrays &r)
              DEFORMABLE_LANE_LAMBDA { multiply_lanes<decltype(size)::value, SOFT>(x, n, c, r); });
}

static void multiply_rings(const RingBatches &b, const double *x)
{
  b.soft ? multiply_all<true>(b, x) : multiply_all<false>(b, x);
}

static void slopes_of_rings(const RingBatches &b, const double *force)
{
  for_all(b, [&](auto size, int n, const ContactArrays &c, const RingArrays &r)
                 DEFORMABLE_LANE_LAMBDA { slope_lanes<decltype(size)::value>(force, n, c, r); });
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
