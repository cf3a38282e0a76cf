// How outlines follow a correction of forces and the answer of curved lines, ring by ring, in single precision (OutlineArrays
// in force_kernels.h).
//
// To first order in changes x of the forces, y = f dtau of the tilts, and areas q that flow to the second ring of a pair as its
// line bends, with t of contact_curve.h, C, mixed, square, rate of ring_forces.h at fixed curvature, sigma = 1 or -1 for the
// first or second ring, and e_c = (mixed + square b_c) p = dp/df_c:
//   dQ/p = b.x + t.y - p sigma.q,   dp = p (mixed sum x + square dQ/p),   d(p Q) = E dp + p (mixed dQ/p - rate sum x) - sum x/2 pi,
//   dt_c = [(G' x)_c - (G'' y)_c - t_c dp]/p,    G'' = -G + 1/2 pi + cos/pi between different contacts,
//   da_c = (C x)_c - (G' y)_c/p + e_c (sigma.q - t.y/p).
// Left out is what flows do through the tension of an arc, of second order in its half angle.

#ifndef DEFORMABLE_CURVE_LANES_H
#define DEFORMABLE_CURVE_LANES_H

#include "kernels/correction_lanes.h"

namespace deformable::DEFORMABLE_LEVEL {

// 1 or -1
DEFORMABLE_LANE_FUNCTION Floats side_of(const int *pair_side)
{
  return each_of<Floats>([&](int w)
                             DEFORMABLE_LANE_LAMBDA { return 1.0F - 2.0F * (pair_side[w] & 1); });
}

template <int... LANE>
DEFORMABLE_LANE_FUNCTION Both<Floats> both_of_pairs(const double *x, const int *pair_side,
                                                    std::integer_sequence<int, LANE...>)
{
  const Sum::Parts bits = {x[pair_side[LANE] >> 1]...};
  const auto both = TwoVectors<Floats, TwoFloats>::load(&bits);
  return {both.first, both.second};
}

DEFORMABLE_LANE_FUNCTION Floats floats_at(const double *x, double unit)
{
  Sum::Parts parts;
  __builtin_memcpy(&parts, x, sizeof parts);
  return __builtin_convertvector(parts * unit, Floats);
}

// Numbers of a ring without units.
template <bool SOFT> struct OutlineLanes {
  Floats p, per_p, E, per_lengths, square, mixed{}, rate{};
  DEFORMABLE_LANE_LAMBDA OutlineLanes(const RingArrays &r, const OutlineArrays &o)
  {
    p = floats_at(r.pressure, r.scale);
    per_p = floats_at(r.per_pressure, 1.0 / r.scale);
    E = floats_at(o.free_radius, 1.0 / o.length) +
        (0.5F / static_cast<float>(PI)) * per_p * floats_at(r.total, r.scale / o.length);
    per_lengths = load<Floats>(o.per_lengths);
    square = load<Floats>(r.square);
    if constexpr (SOFT) {
      mixed = load<Floats>(r.mixed);
      rate = load<Floats>(r.rate);
    }
  }
};

template <int SIZE, bool SOFT>
DEFORMABLE_LANE_FUNCTION void follow_lanes(const double *answer, const float *step, int contacts,
                                           const ContactArrays &c, const CorrectionArrays &g,
                                           const RingArrays &rings, const OutlineArrays &outline)
{
  constexpr float PER_PI = static_cast<float>(1.0 / PI);
  constexpr auto EACH = std::make_integer_sequence<int, FLOATS>();
  const int n = SIZE > 0 ? SIZE : contacts;
  OfContacts<Floats, SIZE, 4> of(n, c.scratch);
  Floats *const x = of[0], *const y = of[1], *const product = of[2], *const turned = of[3];
  Floats along = Floats{}, sum = Floats{}, work = Floats{}, flow = Floats{}, pull = Floats{},
         pull_x = Floats{}, pull_y = Floats{};
  const double per_length = 1.0 / outline.length;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const int at = m * LANES, *const pair_side = c.pair_side + at;
    const Both<Floats> of_line = both_of_pairs(answer, pair_side, EACH);
    x[m] = step ? floats_of_pairs(step, pair_side) : load<Floats>(g.step + at);
    y[m] = of_line.first;
    along += load<Floats>(c.share + at) * x[m];
    sum += x[m];
    work += floats_at(c.slope + at, per_length) * y[m];
    flow += side_of(pair_side) * of_line.second;
    pull += y[m];
    pull_x += load<Floats>(outline.nx + at) * y[m];
    pull_y += load<Floats>(outline.ny + at) * y[m];
    product[m] = load<Floats>(c.own + at) * x[m];
    turned[m] = Floats{};
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      const Floats between = load<Floats>(entry(c.green, m, k));
      const Floats turn = load<Floats>(entry(outline.turn, m, k));
      product[m] += between * x[k];
      product[k] += between * x[m];
      turned[m] += turn * x[k] + between * y[k];
      turned[k] += between * y[m] - turn * x[m];
    }
  }
  const OutlineLanes<SOFT> o(rings, outline);
  const Floats all = along + (work - o.p * flow) * o.per_lengths;    // dQ/p
  const Floats dp = (o.mixed * sum + o.square * all) * o.per_lengths;
  TwoVectors<Floats, TwoFloats>::store(outline.change, dp,
                                       o.E * dp + o.mixed * all - (o.rate + 0.5F * PER_PI) * sum);
  const Floats of_share = o.square * along + o.mixed * sum,
               constant = o.rate * sum - o.mixed * along;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const int at = m * LANES;
    const Floats slope = floats_at(c.slope + at, per_length);
    const Floats others = 0.5F * (pull - y[m]) + load<Floats>(outline.nx + at) * pull_x +
                          load<Floats>(outline.ny + at) * pull_y - y[m];
    store_floats(outline.across + at, (turned[m] - PER_PI * others - slope * dp) * o.per_p);
    store_floats(g.left + at,
                 (product[m] - of_share * load<Floats>(c.share + at) + constant) * o.per_p);
  }
}

template <int SIZE, bool SOFT>
DEFORMABLE_LANE_FUNCTION void respond_lanes(const double *answer, bool begins, int contacts,
                                            const ContactArrays &c, const CorrectionArrays &g,
                                            const RingArrays &rings, const OutlineArrays &outline)
{
  constexpr auto EACH = std::make_integer_sequence<int, FLOATS>();
  const int n = SIZE > 0 ? SIZE : contacts;
  OfContacts<Floats, SIZE, 2> of(n, c.scratch);
  Floats *const y = of[0], *const turned = of[1];
  Floats work = Floats{}, flow = Floats{};
  const double per_length = 1.0 / outline.length;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const int at = m * LANES, *const pair_side = c.pair_side + at;
    const Both<Floats> of_line = both_of_pairs(answer, pair_side, EACH);
    y[m] = of_line.first;
    work += floats_at(c.slope + at, per_length) * y[m];
    flow += side_of(pair_side) * of_line.second;
    turned[m] = Floats{};
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      const Floats turn = load<Floats>(entry(outline.turn, m, k));
      turned[m] += turn * y[k];
      turned[k] -= turn * y[m];
    }
  }
  const OutlineLanes<SOFT> o(rings, outline);
  const Floats by_pressure = (flow - work * o.per_p) * o.per_lengths;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const int at = m * LANES;
    Floats product =
        (o.mixed + o.square * load<Floats>(c.share + at)) * by_pressure - turned[m] * o.per_p;
    if (begins)
      store_floats(g.step + at, Floats{});
    else
      product += load<Floats>(g.left + at);
    store_floats(g.product + at, product);
  }
}

template <class Kernel> DEFORMABLE_LANE_FUNCTION void for_outlines(const RingBatches &b,
                                                                   Kernel &&kernel)
{
  const auto act = [&](auto soft) DEFORMABLE_LANE_LAMBDA {
    for_all<FLOATS>(b, [&](auto size, int n, const ContactArrays &c,
                           const RingArrays &r) DEFORMABLE_LANE_LAMBDA {
      const int first = static_cast<int>(c.pair_side - b.contacts.pair_side);
      kernel(soft, size, n, c, corrections_of(b.corrections, first), r, outlines_of(b, c, r));
    });
  };
  if (b.soft)
    act(std::true_type());
  else
    act(std::false_type());
}

static void follow_rings(RingBatches b, LineArrays lines, const float *step)
{
  for_outlines(b, [&](auto soft, auto size, int n, const ContactArrays &c,
                      const CorrectionArrays &g, const RingArrays &r,
                      const OutlineArrays &o) DEFORMABLE_LANE_LAMBDA {
    follow_lanes<decltype(size)::value, decltype(soft)::value>(lines.answer, step, n, c, g, r, o);
  });
}

static void respond_rings(RingBatches b, LineArrays lines, bool begins)
{
  for_outlines(b,
               [&](auto soft, auto size, int n, const ContactArrays &c, const CorrectionArrays &g,
                   const RingArrays &r, const OutlineArrays &o) DEFORMABLE_LANE_LAMBDA {
                 respond_lanes<decltype(size)::value, decltype(soft)::value>(lines.answer, begins,
                                                                             n, c, g, r, o);
               });
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
