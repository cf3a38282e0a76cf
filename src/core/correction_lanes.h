// Corrections of the forces of pairs, ring by ring, in single precision (CorrectionArrays in force_kernels.h).
//
// Sums have LANES parts on every level, so that all levels add in the same order.

#ifndef DEFORMABLE_CORRECTION_LANES_H
#define DEFORMABLE_CORRECTION_LANES_H

#include "force_lanes.h"

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

// A wall has one contact: twice its residual and half of its weight make it a pair of two that are the same.
static void begin_corrections(const RingBatches &b, const PairArrays &pairs)
{
  const CorrectionArrays &g = b.corrections;
  const double per_length = 1.0 / pairs.length;
  for_contacts_in_all(b, [&](int c) DEFORMABLE_LANE_LAMBDA {
    Floats left, weight;
    for (int w = 0; w < FLOATS; ++w) {
      const int k = b.contacts.seat[c + w] >> 1;
      const float sides = g.partner[c + w] == c + w ? 2.0F : 1.0F;
      left[w] = sides * static_cast<float>(pairs.residual[k] * per_length);
      weight[w] = pairs.weight[k] > 0.0F ? pairs.weight[k] / sides : 0.0F;
    }
    store_floats(g.left + c, left);
    store_floats(g.weight + c, weight);
    store_floats(g.step + c, Floats{});
  });
}

// A step of this length along the direction of a contact; r after it.
DEFORMABLE_LANE_FUNCTION Floats advance_at(const CorrectionArrays &g, int c, float length,
                                           const float *products)
{
  const Floats product = load<Floats>(g.last_product + c) + gather_floats(products, g.partner + c);
  store_floats(g.step + c, load<Floats>(g.step + c) + length * load<Floats>(g.direction + c));
  return load<Floats>(g.left + c) - length * product;
}

// What a kernel does to a direction d before it finds C d.
enum class Turn {
  FIRST,      // d = w r
  ANOTHER,    // d = w r + conjugation d
  ADVANCE     // the same after a step along the last d
};
struct TurnBy {
  float conjugation, length;
  const float *products;    // the last ones of all contacts
};

// C d/scale of each ring; the sum of d C d/scale is wanted where no step was taken.
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
    Floats left;
    if constexpr (TURN == Turn::ADVANCE) {
      left = advance_at(g, at, by.length, by.products);
      store_floats(g.left + at, left);
    } else {
      left = load<Floats>(g.left + at);
    }
    own[m] = load<Floats>(g.weight + at) * left;
    if constexpr (TURN != Turn::FIRST) own[m] += by.conjugation * load<Floats>(g.direction + at);
    store_floats(g.direction + at, own[m]);
    share[m] = load<Floats>(c.share + at);
    product[m] = static_cast<float>(GREEN_AT_ZERO) * own[m];
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
    per_p[w] = static_cast<float>(rings.per_pressure[w] / rings.scale);
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    Floats y = product[m] - of_share * share[m];
    if constexpr (SOFT) y += constant;
    y *= per_p;
    store_floats(g.product + m * LANES, y);
    if constexpr (TURN != Turn::ADVANCE) curvature.add(first, own[m], y);
  }
}

DEFORMABLE_LANE_FUNCTION CorrectionArrays corrections_of(CorrectionArrays g, int contact)
{
  g.partner += contact;
  for (float **p : {&g.weight, &g.left, &g.direction, &g.step, &g.product, &g.last_product})
    *p += contact;
  return g;
}

template <bool SOFT, Turn TURN>
static double multiply_all(const RingBatches &b, double conjugation, double length)
{
  const TurnBy by = {static_cast<float>(conjugation), static_cast<float>(length),
                     b.corrections.last_product};
  Sum sum;
  for_all<FLOATS>(
      b, [&](auto size, int n, const ContactArrays &c, const RingArrays &r) DEFORMABLE_LANE_LAMBDA {
        const int first = static_cast<int>(c.seat - b.contacts.seat);
        multiply_lanes<decltype(size)::value, SOFT, TURN>(
            by, n, c, corrections_of(b.corrections, first), r, sum, first % LANES);
      });
  return sum.total();
}

static double multiply_rings(const RingBatches &b, double conjugation)
{
  if (conjugation == 0.0)
    return b.soft ? multiply_all<true, Turn::FIRST>(b, 0.0, 0.0)
                  : multiply_all<false, Turn::FIRST>(b, 0.0, 0.0);
  return b.soft ? multiply_all<true, Turn::ANOTHER>(b, conjugation, 0.0)
                : multiply_all<false, Turn::ANOTHER>(b, conjugation, 0.0);
}

static void advance_and_multiply(const RingBatches &b, double length, double conjugation)
{
  if (b.soft)
    multiply_all<true, Turn::ADVANCE>(b, conjugation, length);
  else
    multiply_all<false, Turn::ADVANCE>(b, conjugation, length);
}

static double advance(const RingBatches &b, double length)
{
  const CorrectionArrays &g = b.corrections;
  const float along = static_cast<float>(length);
  Sum norm2;
  for_contacts_in_all(b, [&](int c) DEFORMABLE_LANE_LAMBDA {
    const Floats left = advance_at(g, c, along, g.last_product);
    store_floats(g.left + c, left);
    norm2.add(c % LANES, load<Floats>(g.weight + c) * left, left);
  });
  return 0.5 * norm2.total();
}

// Nobody asks for r after the last one.
static void advance_twice(const RingBatches &b, double length, double conjugation, double last)
{
  const CorrectionArrays &g = b.corrections;
  const float along = static_cast<float>(length), part = static_cast<float>(conjugation),
              further = static_cast<float>(last);
  for_contacts_in_all(b, [&](int c) DEFORMABLE_LANE_LAMBDA {
    const Floats left = advance_at(g, c, along, g.last_product);
    const Floats next = load<Floats>(g.weight + c) * left + part * load<Floats>(g.direction + c);
    store_floats(g.step + c, load<Floats>(g.step + c) + further * next);
  });
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
