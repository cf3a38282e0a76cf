// Rings with given forces, several side by side: the formulas of ring_forces.h in vectors.
//
// Kernels are templates of the number of contacts, so that all loops unroll; 0 contacts stands for a number known at
// run time only.

#ifndef DEFORMABLE_FORCE_LANES_H
#define DEFORMABLE_FORCE_LANES_H

#include "kernels/force_kernels.h"
#include "kernels/lane_geometry.h"
#include "kernels/lanes.h"
#include "laws/contact_curve.h"
#include "laws/ring_forces.h"

namespace deformable::DEFORMABLE_LEVEL {

// What films that stick do to rings (contact_curve.h): the arrays of films, from the rings and contacts on that c and r begin with.
DEFORMABLE_LANE_FUNCTION StickArrays films_of(const RingBatches &b, const ContactArrays &c,
                                              const RingArrays &r)
{
  StickArrays films = b.films;
  films.tension += r.radius - b.rings.radius;
  for (double *&term : films.terms) term += c.pair_side - b.contacts.pair_side;
  return films;
}

// The load of rings whose contacts stick, and their products.
DEFORMABLE_LANE_FUNCTION void stick_contacts(int n, const StickArrays &films, Lanes tension,
                                             const Lanes *force, Lanes *product, Lanes &work,
                                             Lanes &total)
{
  Lanes perimeter = Lanes{}, linear = Lanes{}, square = Lanes{};
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    perimeter += load<Lanes>(films.terms[0] + m * LANES);
    linear += force[m] * load<Lanes>(films.terms[1] + m * LANES);
    square += load<Lanes>(films.terms[2] + m * LANES);
  }
  const CurvedLoad<Lanes> loaded = film_load(work, total, tension, perimeter, linear, square);
  work = loaded.work;
  total = loaded.total;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m)
    product[m] += loaded.shift + tension * load<Lanes>(films.terms[3] + m * LANES);
}

// p of p^3 = kA Q, from the last pressure where that is close: two steps of Halley's method, each of which triples the digits.
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
DEFORMABLE_LANE_FUNCTION ComplianceLanes press_rigid(const RingArrays &r, const Lanes *caps)
{
  const Lanes kA = load<Lanes>(r.stiffness.kA);
  const Lanes p = cube_root(kA * load<Lanes>(r.work), load<Lanes>(r.pressure));
  const Mask loaded = p > 0.0;
  ComplianceLanes c = rigid_compliance(select(loaded, p, all(1.0)), kA);
  if (caps)
    c.square *= 3.0 / (3.0 - 2.0 * kA * *caps * c.per_pressure * c.per_pressure * c.per_pressure);
  c.per_pressure = select(loaded, c.per_pressure, Lanes{});
  c.square = select(loaded, c.square, Lanes{});
  store(r.pressure, p);
  store(r.per_pressure, c.per_pressure);
  return c;
}

// Returns where the last expansion leads to a ring.
DEFORMABLE_LANE_FUNCTION Mask expand(const RingArrays &r, Lanes &pressure, Lanes &expansion)
{
  constexpr double NOTHING = 1e-280;
  const StiffnessArrays &k = r.stiffness;
  const RingUnderLoad<Lanes> ring = {load<Lanes>(r.radius),
                                     load<Lanes>(k.kA),
                                     load<Lanes>(k.kP),
                                     k.tension ? load<Lanes>(k.tension) : Lanes{},
                                     load<Lanes>(r.total) * (0.5 / PI),
                                     load<Lanes>(r.work)};
  pressure = load<Lanes>(r.pressure);
  expansion = load<Lanes>(r.expansion);
  const Mask soft = ring.kP / ring.kA<__builtin_inf(), loaded = magnitude(ring.work)> NOTHING;
  return find_expansion(ring, k.tension != nullptr, soft & loaded, pressure, expansion) &
         (expansion < LARGEST_EXPANSION * ring.radius);
}

// Pressure, expansion and compliance of W rings; returns false where a ring does not exist. In compliances,
// unless that is null, `caps` are taken off the work, as for C at fixed curvature.
template <bool SOFT>
DEFORMABLE_LANE_FUNCTION bool press(const RingArrays &r, const Lanes *caps, ComplianceLanes &c)
{
  if constexpr (!SOFT) {
    c = press_rigid(r, caps);
    return true;
  } else {
    Lanes p, delta;
    bool exist = true;
    const Lanes work = load<Lanes>(r.work), work_at_curvature = caps ? work - *caps : work;
    Mask found = expand(r, p, delta);
    if (r.stiffness.yield) found &= p <= load<Lanes>(r.stiffness.yield);
    c = soft_compliance(select(found, p, all(1.0)), load<Lanes>(r.radius) + delta,
                        work_at_curvature, load<Lanes>(r.stiffness.kA),
                        2.0 * PI * load<Lanes>(r.stiffness.kP));
    if (!all_true(found))    // also rings of constant perimeter, which are rare beside others
      for (int w = 0; w < W; ++w) {
        if (found[w]) continue;
        LoadedRing ring = {r.pressure[w], r.expansion[w]};
        const Stiffness k = stiffness_at(r.stiffness, w);
        exist &= find_pressure(r.radius[w], k, {r.work[w], r.total[w]}, ring);
        p[w] = ring.pressure;
        delta[w] = ring.expansion;
        const RingCompliance one = compliance_of(r.radius[w], k, work_at_curvature[w], ring);
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

// The arrays of W rings of one batch: those of all batches from their place on.
DEFORMABLE_LANE_FUNCTION RingArrays rings_of(RingArrays r, int ring)
{
  const auto move = [ring](auto &...p) DEFORMABLE_LANE_LAMBDA { ((p ? p += ring : p), ...); };
  move(r.radius, r.pressure, r.work, r.total, r.per_pressure, r.square);
  move(r.expansion, r.mixed, r.rate, r.skin);
#pragma GCC unroll 8
  for (const Parameter &p : PARAMETERS) move(r.stiffness.*p.of_rings);
  return r;
}

DEFORMABLE_LANE_FUNCTION ContactArrays contacts_of(ContactArrays c, int contact, std::size_t green)
{
  c.pair_side += contact;
  for (double **p : {&c.indentation, &c.slope}) *p += contact;
  for (float **p : {&c.compliance, &c.share}) *p += contact;
  if (c.own) c.own += contact;
  c.green += green;
  return c;
}

// COUNT vectors for each of n contacts.
template <class Vector, int SIZE, int COUNT> struct OfContacts {
  Vector memory[COUNT][SIZE];
  OfContacts(int, void *) {}
  Vector *operator[](int k) { return memory[k]; }
};

template <class Vector, int COUNT> struct OfContacts<Vector, 0, COUNT> {
  int n;
  Vector *memory;
  OfContacts(int n, void *scratch) : n(n), memory(static_cast<Vector *>(scratch)) {}
  Vector *operator[](int k) { return memory + k * n; }
};

// The entry of the lower triangle for the contacts m and k < m.
DEFORMABLE_LANE_FUNCTION float *entry(float *triangle, int m, int k)
{
  return triangle + (m * (m - 1) / 2 + k) * LANES;
}

template <class Number>
DEFORMABLE_LANE_FUNCTION Lanes of_pairs(const Number *x, const int *pair_side)
{
  return gather<Lanes>(x, [&](int w) DEFORMABLE_LANE_LAMBDA { return pair_side[w] >> 1; });
}

// Angle and direction of a contact, as its ring sees it.
struct SeenLanes : DirectionLanes {
  Lanes angle, side;    // 1 or -1
};

DEFORMABLE_LANE_FUNCTION SeenLanes seen_from_ring(const PairDirections &pairs, const int *pair_side)
{
  const Lanes sign =
      each_lane([&](int w) DEFORMABLE_LANE_LAMBDA { return 1.0 - 2.0 * (pair_side[w] & 1); });
  const Lanes angle = of_pairs(pairs.angle, pair_side);
  return {{sign * of_pairs(pairs.nx, pair_side), sign * of_pairs(pairs.ny, pair_side)},
          select(sign > 0.0, angle, select(angle > 0.0, angle - PI, angle + PI)),
          sign};
}

// begin(m, side) for each contact of the rings and, after it, pair(m, k, angles between them) for those before. of[0] are the
// forces; of[2], of[3] and of[4] are taken too.
template <int SIZE, class Begin, class Pair>
DEFORMABLE_LANE_FUNCTION void for_contacts(const PairDirections &pairs, int n,
                                           const int *pair_sides, OfContacts<Lanes, SIZE, 7> &of,
                                           Begin &&begin, Pair &&pair)
{
  Lanes *const force = of[0], *const angle = of[2], *const nx = of[3], *const ny = of[4];
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const int *const pair_side = pair_sides + m * LANES;
    const SeenLanes seen = seen_from_ring(pairs, pair_side);
    angle[m] = seen.angle;
    nx[m] = seen.nx;
    ny[m] = seen.ny;
    force[m] = of_pairs(pairs.force, pair_side);
    begin(m, seen.side);
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k)
      pair(m, k, angles_between(angle[k], {nx[k], ny[k]}, angle[m], seen));
  }
}

// The load of rings whose contacts are arcs (contact_curve.h) with tan(b/2) = u, and their products, p (a + delta). Returns half of
// what caps take of the work at fixed curvature: of films h = 2 T sin(theta) counts, too.
template <class Pull>
DEFORMABLE_LANE_FUNCTION Lanes bend_contacts(int n, const Lanes *tangent, const Lanes *force,
                                             Lanes *product, Lanes &work, Lanes &total, Pull &&pull)
{
  Lanes excess = Lanes{}, cap = Lanes{}, cap_at_curvature = Lanes{};
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const Lanes u = tangent[m], h = pull(m);
    const ArcTerms<Lanes> arc = arc_terms(u);
    excess += force[m] * arc.excess;
    cap += force[m] * force[m] * arc.cap;
    cap_at_curvature += (force[m] - 2.0 * h) * (force[m] + h) * arc.cap;
    product[m] -= 0.5 * u * force[m];
  }
  const CurvedLoad<Lanes> load = curved_load(work, total, excess, cap);
  work = load.work;
  total = load.total;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) product[m] += load.shift;
  return 0.5 * smaller(cap_at_curvature, work);
}

// The arrays of outlines, from the rings and contacts on that c and r begin with.
DEFORMABLE_LANE_FUNCTION OutlineArrays outlines_of(const RingBatches &b, const ContactArrays &c,
                                                   const RingArrays &r)
{
  OutlineArrays o = b.outline;
  o.free_radius += r.radius - b.rings.radius;
  for (double **p : {&o.bulk_and_swell, &o.change}) *p += r.radius - b.rings.radius;
  o.per_lengths += r.radius - b.rings.radius;
  for (float **p : {&o.nx, &o.ny, &o.rate, &o.across}) *p += c.pair_side - b.contacts.pair_side;
  o.turn += c.green - b.contacts.green;
  return o;
}

// Shapes from forces and their sums with G. Curved lines: C at fixed curvature (contact_curve.h), and what the lines need.
template <bool SOFT, bool CURVED, bool STICK>
DEFORMABLE_LANE_FUNCTION bool
finish_shapes(int n, const Lanes *force, Lanes *product, const Lanes *tangent, const Lanes *nx,
              const Lanes *ny, const Lanes *slope, const ContactArrays &c, const RingArrays &rings,
              const OutlineArrays &outline, const StickArrays &films, const PairDirections &pairs)
{
  Lanes work = Lanes{}, total = Lanes{};
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    work += force[m] * product[m];
    total += force[m];
  }
  work *= 0.5;
  // what a film bears beside its force, 2 T sin(theta)
  const auto pull = [&](int m) DEFORMABLE_LANE_LAMBDA {
    if constexpr (STICK)
      return -of_pairs(pairs.least, c.pair_side + m * LANES);
    else
      return Lanes{};
  };
  Lanes caps = Lanes{}, net_x = Lanes{}, net_y = Lanes{};
  if constexpr (CURVED) {
#pragma GCC unroll 8
    for (int m = 0; m < n; ++m) {
      net_x += force[m] * nx[m];
      net_y += force[m] * ny[m];
    }
    caps = bend_contacts(n, tangent, force, product, work, total, pull);
  }
  Lanes size = total;    // of the sum of lengths, a scale
  if constexpr (STICK) {
    const Lanes tension = load<Lanes>(films.tension);
    stick_contacts(n, films, tension, force, product, work, total);
    size = magnitude(total) + tension;
  }
  store(rings.work, work);
  store(rings.total, total);
  ComplianceLanes by;
  const bool exist = press<SOFT>(rings, CURVED ? &caps : nullptr, by);
  const Lanes per_p = by.per_pressure, lengths = size * per_p;
  const Lanes p = load<Lanes>(rings.pressure);
  store(rings.square, by.square * lengths * lengths * p);
  if constexpr (SOFT) {
    store(rings.mixed, by.mixed * lengths * p);
    store(rings.rate, by.rate * p);
  }
  const double per_scale = 1.0 / rings.scale;
  const Lanes per_size = select(size > 0.0, 1.0 / select(size > 0.0, size, all(1.0)), Lanes{});
  Lanes swell = Lanes{};
  // C of arcs that bend further than MOST is none of stable contacts
  constexpr double NOTHING = 1e-280, MOST = 0.1;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    Lanes b = product[m] * per_p, a = b, own = all(GREEN_AT_ZERO);
    if constexpr (SOFT) a -= load<Lanes>(rings.expansion);
    if constexpr (CURVED) {
      const Lanes u = smaller(larger(tangent[m], all(-MOST)), all(MOST)), cube = u * u * u,
                  length = force[m] * per_p;
      Lanes inward = b;    // (GL)_c
      if constexpr (STICK)
        inward -= load<Lanes>(films.tension) * per_p * load<Lanes>(films.terms[3] + m * LANES);
      const Lanes along = (nx[m] * net_x + ny[m] * net_y) * per_p;
      store(outline.rate + m * LANES,
            slope_rate(total * per_p, along, inward, length) * (1.0 / outline.length));
      store(outline.nx + m * LANES, nx[m]);
      store(outline.ny + m * LANES, ny[m]);
      store(c.slope + m * LANES, per_p * slope[m]);
      if constexpr (STICK) {
        const Lanes h = pull(m), all_of = larger(force[m] + h, all(NOTHING));
        own -= smaller(larger((u + cube) * force[m] / all_of, all(-MOST)), all(MOST));
        b -= (length - h * per_p) * (0.5 * u + cube);
      } else {
        own -= u + cube;
        b -= length * (0.5 * u + cube);
      }
      product[m] = b * p;
      store(c.own + m * LANES, own);
      swell = larger(swell, magnitude(by.mixed + by.square * b));
    }
    Lanes diagonal = own * per_p - by.square * b * b;
    if constexpr (SOFT) diagonal += by.rate - 2.0 * by.mixed * b;
    store(c.share + m * LANES, product[m] * per_size);
    store(c.indentation + m * LANES, a);
    store(c.compliance + m * LANES,
          select(per_p > 0.0, diagonal * per_scale, all(__builtin_inf())));
  }
  if constexpr (CURVED) {
    Lanes Q = load<Lanes>(rings.radius) - total * per_p * (0.5 / PI);
    if constexpr (SOFT) Q += load<Lanes>(rings.expansion);
    if (rings.skin) Q += load<Lanes>(rings.skin);
    store(outline.free_radius, Q);
    store_both(outline.bulk_and_swell,
               p * p * by.square * (outline.length * outline.length * rings.scale),
               p * swell * outline.length);
    store(outline.per_lengths, p * per_size * outline.length);
  }
  return exist;
}

// Shapes the rings for the forces of their pairs. Curved lines also need the slopes of the outline,
//   t_c = sum over k of L_k G'(theta_c - theta_k);   -f_c t_c is dU/dtheta_c.
template <int SIZE, bool SOFT, bool CURVED = false, bool STICK = false>
DEFORMABLE_LANE_FUNCTION bool shape_lanes(const PairDirections &pairs, int contacts,
                                          const ContactArrays &c, const RingArrays &rings,
                                          const OutlineArrays &outline = {},
                                          const StickArrays &films = {})
{
  const int n = SIZE > 0 ? SIZE : contacts;
  OfContacts<Lanes, SIZE, 7> of(n, c.scratch);
  Lanes *const force = of[0], *const product = of[1], *const slope = of[5], *const tangent = of[6];
  for_contacts<SIZE>(
      pairs, n, c.pair_side, of,
      [&](int m, Lanes side) DEFORMABLE_LANE_LAMBDA {
        product[m] = GREEN_AT_ZERO * force[m];
        if constexpr (CURVED) {
          slope[m] = Lanes{};
          tangent[m] = side * of_pairs(pairs.bend, c.pair_side + m * LANES);
        }
      },
      [&](int m, int k, const AngleLanes &t) DEFORMABLE_LANE_LAMBDA {
        const Lanes between = green(t.magnitude, t.sine, t.cosine);
        store(entry(c.green, m, k), between);
        product[m] += between * force[k];
        product[k] += between * force[m];
        if constexpr (CURVED) {
          const Lanes size = d_green(t.magnitude, t.sine, t.cosine);
          const Lanes turn = select(t.negative, -size, size);
          store(entry(outline.turn, m, k), turn);
          slope[m] += turn * force[k];
          slope[k] -= turn * force[m];
        }
      });
  return finish_shapes<SOFT, CURVED, STICK>(n, force, product, tangent, of[3], of[4], slope, c,
                                            rings, outline, films, pairs);
}

// Shapes the rings anew after their forces have changed a little, in the same directions, with the last G in single
// precision for the changes; for straight contact lines.
template <int SIZE, bool SOFT>
DEFORMABLE_LANE_FUNCTION bool adapt_lanes(const double *forces, const float *changes, double unit,
                                          int contacts, const ContactArrays &c,
                                          const RingArrays &rings)
{
  const int n = SIZE > 0 ? SIZE : contacts;
  OfContacts<Lanes, SIZE, 7> of(n, c.scratch);
  Lanes *const force = of[0], *const product = of[1], *const change = of[2];
  const Lanes p = load<Lanes>(rings.pressure);
  Lanes delta = Lanes{};
  if constexpr (SOFT) delta = load<Lanes>(rings.expansion);
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const int *const pair_side = c.pair_side + m * LANES;
    force[m] = of_pairs(forces, pair_side);
    change[m] = of_pairs(changes, pair_side) * unit;
    product[m] = (load<Lanes>(c.indentation + m * LANES) + delta) * p + GREEN_AT_ZERO * change[m];
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      const Lanes between = load<Lanes>(entry(c.green, m, k));
      product[m] += between * change[k];
      product[k] += between * change[m];
    }
  }
  return finish_shapes<SOFT, false, false>(n, force, product, nullptr, nullptr, nullptr, nullptr, c,
                                           rings, {}, {}, {});
}

// The slopes alone.
template <int SIZE>
DEFORMABLE_LANE_FUNCTION void slope_lanes(const PairDirections &pairs, int contacts,
                                          const ContactArrays &c, const RingArrays &rings)
{
  const int n = SIZE > 0 ? SIZE : contacts;
  OfContacts<Lanes, SIZE, 7> of(n, c.scratch);
  Lanes *const force = of[0], *const slope = of[1];
  for_contacts<SIZE>(
      pairs, n, c.pair_side, of, [&](int m, Lanes) DEFORMABLE_LANE_LAMBDA { slope[m] = Lanes{}; },
      [&](int m, int k, const AngleLanes &t) DEFORMABLE_LANE_LAMBDA {
        const Lanes size = d_green(t.magnitude, t.sine, t.cosine);
        const Lanes between = select(t.negative, -size, size);
        slope[m] += between * force[k];
        slope[k] -= between * force[m];
      });
  const Lanes per_p = load<Lanes>(rings.per_pressure);
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) store(c.slope + m * LANES, per_p * slope[m]);
}

// kernel(n, contacts, rings) for each vector of rings, with n contacts each.
template <int STEP = W, class Kernel>
DEFORMABLE_LANE_FUNCTION void for_each_vector(const RingBatches &b, Kernel &&kernel)
{
  for (int batch = b.begin; batch < b.end; ++batch)
    for (int w = 0; w < LANES; w += STEP)
      kernel(b.size[batch], contacts_of(b.contacts, b.first[batch] + w, b.first_green[batch] + w),
             rings_of(b.rings, batch * LANES + w));
}

// kernel(n, number of contacts, contacts, rings) for each vector of rings, n a constant for the usual numbers.
template <int STEP = W, class Kernel>
DEFORMABLE_LANE_FUNCTION void for_all(const RingBatches &b, Kernel &&kernel)
{
  for_each_vector<STEP>(b, [&](int n, const ContactArrays &c, const RingArrays &r)
                               DEFORMABLE_LANE_LAMBDA {
                                 switch (n) {
                                   case 4: kernel(std::integral_constant<int, 4>(), n, c, r); break;
                                   case 5: kernel(std::integral_constant<int, 5>(), n, c, r); break;
                                   case 6: kernel(std::integral_constant<int, 6>(), n, c, r); break;
                                   case 7: kernel(std::integral_constant<int, 7>(), n, c, r); break;
                                   default: kernel(std::integral_constant<int, 0>(), n, c, r);
                                 }
                               });
}

template <bool SOFT, bool CURVED, bool STICK = false>
static bool shape_all(RingBatches b, PairDirections pairs)
{
  bool exist = true;
  for_all(
      b, [&](auto size, int n, const ContactArrays &c, const RingArrays &r) DEFORMABLE_LANE_LAMBDA {
        OutlineArrays outline = {};
        if constexpr (CURVED) outline = outlines_of(b, c, r);
        StickArrays films = {};
        if constexpr (STICK) films = films_of(b, c, r);
        exist &=
            shape_lanes<decltype(size)::value, SOFT, CURVED, STICK>(pairs, n, c, r, outline, films);
      });
  return exist;
}

static bool shape_rings(RingBatches b, PairDirections pairs)
{
  const bool curved = pairs.bend;
  if (b.films.tension && b.soft) return shape_all<true, true, true>(b, pairs);
  if (curved) return b.soft ? shape_all<true, true>(b, pairs) : shape_all<false, true>(b, pairs);
  return b.soft ? shape_all<true, false>(b, pairs) : shape_all<false, false>(b, pairs);
}

template <bool SOFT>
static bool adapt_all(RingBatches b, const double *forces, const float *changes, double unit)
{
  bool exist = true;
  for_all(
      b, [&](auto size, int n, const ContactArrays &c, const RingArrays &r) DEFORMABLE_LANE_LAMBDA {
        exist &= adapt_lanes<decltype(size)::value, SOFT>(forces, changes, unit, n, c, r);
      });
  return exist;
}

static bool adapt_rings(RingBatches b, const double *forces, const float *changes, double unit)
{
  return b.soft ? adapt_all<true>(b, forces, changes, unit)
                : adapt_all<false>(b, forces, changes, unit);
}

static void slopes_of_rings(RingBatches b, PairDirections pairs)
{
  for_all(b, [&](auto size, int n, const ContactArrays &c, const RingArrays &r)
                 DEFORMABLE_LANE_LAMBDA { slope_lanes<decltype(size)::value>(pairs, n, c, r); });
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
