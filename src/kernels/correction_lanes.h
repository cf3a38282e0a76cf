// Corrections of the forces of pairs, ring by ring, in single precision (CorrectionArrays in force_kernels.h).
//
// Sums have LANES parts on every level, so that all levels add in the same order.

#ifndef DEFORMABLE_CORRECTION_LANES_H
#define DEFORMABLE_CORRECTION_LANES_H

#include "kernels/force_lanes.h"

namespace deformable::DEFORMABLE_LEVEL {

// A sum of products of many numbers in single precision. Near the onset of jamming products are beyond its range, and its
// rounding would depend on how ranks share the contacts.
struct Sum {
  typedef double Parts __attribute__((vector_size(8 * FLOATS)));
  Parts part[LANES / FLOATS] = {};
  DEFORMABLE_LANE_LAMBDA void add(int first, Floats a, Floats b)
  {
    part[first / FLOATS] += __builtin_convertvector(a, Parts) * __builtin_convertvector(b, Parts);
  }
  DEFORMABLE_LANE_LAMBDA double total() const
  {
    double sum = 0.0;
    for (const Parts &p : part)
      for (int w = 0; w < FLOATS; ++w) sum += p[w];
    return sum;
  }
};

// body(c) for all contacts, vector by vector.
template <class Body> DEFORMABLE_LANE_FUNCTION void for_contacts_in_all(const RingBatches &b,
                                                                        Body &&body)
{
  for (int c = b.first[b.begin]; c < b.first[b.end]; c += LANES)
#pragma GCC unroll 2
    for (int n = 0; n < LANES; n += FLOATS) body(c + n);
}

DEFORMABLE_LANE_FUNCTION Floats floats_of_pairs(const float *x, const int *pair_side)
{
  return each_of<Floats>([&](int w) DEFORMABLE_LANE_LAMBDA { return x[pair_side[w] >> 1]; });
}

// A step of this length, or `gain` times as long, along the direction of a contact; r after it.
DEFORMABLE_LANE_FUNCTION Floats advance_at(const CorrectionArrays &g, int c, float length,
                                           const float *products, float gain = 1.0F)
{
  const Floats product = load<Floats>(g.last_product + c) + gather_floats(products, g.partner + c);
  store_floats(g.step + c,
               load<Floats>(g.step + c) + gain * length * load<Floats>(g.direction + c));
  return load<Floats>(g.left + c) - length * product;
}

// What a kernel does to a direction d before it finds C d.
enum class Turn {
  FIRST,      // d = w r
  GO_ON,      // the same, r after the step so far, whose products are the last ones
  ANOTHER,    // d = w r + conjugation d
  ADVANCE     // the same after a step along the last d
};
struct TurnBy {
  float conjugation, length;
  const float *products;                                 // the last ones of all contacts
  const float *residual = nullptr, *weight = nullptr;    // of pairs
  double per_scale = 1.0;                                // exact: scales are powers of two
  float gain = 1.0F;
};

// C d/scale of each ring. Conjugate gradients also need the sum of d C d/scale, Chebyshev's iteration (ADVANCE) does not.
template <int SIZE, bool SOFT, Turn TURN>
DEFORMABLE_LANE_FUNCTION void multiply_lanes(const TurnBy &by, int contacts, const ContactArrays &c,
                                             const CorrectionArrays &g, const RingArrays &rings,
                                             Sum &curvature, int first)
{
  const int n = SIZE > 0 ? SIZE : contacts;
  OfContacts<Floats, SIZE, 3> of(n, c.scratch);
  Floats *const own = of[0], *const product = of[1], *const share = of[2];
  Floats along = Floats{}, sum = Floats{};
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const int at = m * LANES;
    Floats left, weight;
    if constexpr (TURN == Turn::FIRST || TURN == Turn::GO_ON) {
      left = floats_of_pairs(by.residual, c.pair_side + at);
      weight = floats_of_pairs(by.weight, c.pair_side + at);
      weight = weight > 0.0F ? weight : Floats{};
      store_floats(g.weight + at, weight);
      if constexpr (TURN == Turn::FIRST)
        store_floats(g.step + at, Floats{});
      else
        left -= load<Floats>(g.last_product + at) + gather_floats(by.products, g.partner + at);
    } else {
      weight = load<Floats>(g.weight + at);
      left = TURN == Turn::ADVANCE ? advance_at(g, at, by.length, by.products, by.gain)
                                   : load<Floats>(g.left + at);
    }
    if constexpr (TURN != Turn::ANOTHER) store_floats(g.left + at, left);
    own[m] = weight * left;
    if constexpr (TURN == Turn::ANOTHER || TURN == Turn::ADVANCE)
      own[m] += by.conjugation * load<Floats>(g.direction + at);
    store_floats(g.direction + at, own[m]);
    share[m] = load<Floats>(c.share + at);
    product[m] =
        c.own ? load<Floats>(c.own + at) * own[m] : static_cast<float>(GREEN_AT_ZERO) * own[m];
    along += share[m] * own[m];
    if constexpr (SOFT) sum += own[m];
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      const Floats between = load<Floats>(entry(c.green, m, k));
      product[m] += between * own[k];
      product[k] += between * own[m];
    }
  }
  Floats of_share = load<Floats>(rings.square) * along, constant = Floats{}, per_p;
  if constexpr (SOFT) {
    const Floats mixed = load<Floats>(rings.mixed);
    of_share += mixed * sum;
    constant = load<Floats>(rings.rate) * sum - mixed * along;
  }
  for (int w = 0; w < FLOATS; ++w)
    per_p[w] = static_cast<float>(rings.per_pressure[w] * by.per_scale);
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    Floats y = product[m] - of_share * share[m];
    if constexpr (SOFT) y += constant;
    y *= per_p;
    store_floats(g.product + m * LANES, y);
    if constexpr (TURN == Turn::FIRST || TURN == Turn::ANOTHER) curvature.add(first, own[m], y);
  }
}

DEFORMABLE_LANE_FUNCTION CorrectionArrays corrections_of(CorrectionArrays g, int contact)
{
  g.partner += contact;
  for (float **p : {&g.weight, &g.left, &g.direction, &g.step, &g.product, &g.last_product})
    *p += contact;
  return g;
}

template <bool SOFT, Turn TURN> static double multiply_all(RingBatches b, TurnBy by)
{
  Sum sum;
  by.per_scale = 1.0 / b.rings.scale;
  for_all<FLOATS>(
      b, [&](auto size, int n, const ContactArrays &c, const RingArrays &r) DEFORMABLE_LANE_LAMBDA {
        const int first = static_cast<int>(c.pair_side - b.contacts.pair_side);
        multiply_lanes<decltype(size)::value, SOFT, TURN>(
            by, n, c, corrections_of(b.corrections, first), r, sum, first % LANES);
      });
  return sum.total();
}

template <Turn TURN> static double multiply_rings(RingBatches b, TurnBy by)
{
  return b.soft ? multiply_all<true, TURN>(b, by) : multiply_all<false, TURN>(b, by);
}

static double begin_corrections(RingBatches b, PairArrays pairs)
{
  return multiply_rings<Turn::FIRST>(b, {0.0F, 0.0F, nullptr, pairs.residual, pairs.weight});
}

static double multiply(RingBatches b, double conjugation)
{
  return multiply_rings<Turn::ANOTHER>(b, {static_cast<float>(conjugation), 0.0F, nullptr});
}

static void go_on(RingBatches b, PairArrays pairs, const float *residual)
{
  multiply_rings<Turn::GO_ON>(b, {0.0F, 0.0F, b.corrections.last_product, residual, pairs.weight});
}

static void advance_and_multiply(RingBatches b, double length, double conjugation, double gain)
{
  TurnBy by = {static_cast<float>(conjugation), static_cast<float>(length),
               b.corrections.last_product};
  by.gain = static_cast<float>(gain);
  multiply_rings<Turn::ADVANCE>(b, by);
}

static double advance(RingBatches b, double length)
{
  const CorrectionArrays &g = b.corrections;
  const float along = static_cast<float>(length);
  Sum norm2;
  for_contacts_in_all(b, [&](int c) DEFORMABLE_LANE_LAMBDA {
    const Floats left = advance_at(g, c, along, g.last_product);
    Floats part;    // of a pair: half at both contacts, or all at the only one
    for (int w = 0; w < FLOATS; ++w) part[w] = g.partner[c + w] == g.none ? 1.0F : 0.5F;
    store_floats(g.left + c, left);
    norm2.add(c % LANES, part * load<Floats>(g.weight + c) * left, left);
  });
  return norm2.total();
}

// Nobody asks for r after the last one.
static void advance_twice(RingBatches b, double length, double conjugation, double last,
                          double gain)
{
  const CorrectionArrays &g = b.corrections;
  const float along = static_cast<float>(length), part = static_cast<float>(conjugation),
              further = static_cast<float>(last * gain), times = static_cast<float>(gain);
  for_contacts_in_all(b, [&](int c) DEFORMABLE_LANE_LAMBDA {
    const Floats left = advance_at(g, c, along, g.last_product, times);
    const Floats next = load<Floats>(g.weight + c) * left + part * load<Floats>(g.direction + c);
    store_floats(g.step + c, load<Floats>(g.step + c) + further * next);
  });
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
