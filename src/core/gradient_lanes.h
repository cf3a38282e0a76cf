// Conjugate gradients for the forces of pairs, ring by ring, in single precision (GradientArrays in force_kernels.h).
//
// Sums have LANES parts on every level, so that all levels add in the same order.

#ifndef DEFORMABLE_GRADIENT_LANES_H
#define DEFORMABLE_GRADIENT_LANES_H

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
template <class Body> DEFORMABLE_LANE_FUNCTION void for_contacts_in_all(int contacts, Body &&body)
{
  for (int c = 0; c < contacts; c += LANES)
#pragma GCC unroll 2
    for (int n = 0; n < LANES; n += FLOATS) body(c + n);
}

// A wall has one contact: twice its residual and half of its weight make it a pair of two that are the same.
static GradientStart begin_gradients(const RingBatches &b, const PairArrays &pairs)
{
  const GradientArrays &g = b.gradients;
  const double per_length = 1.0 / pairs.length;
  const Floats one = Floats{} + 1.0F;
  Sum norm2, weights;
  for_contacts_in_all(b.contacts_in_all, [&](int c) DEFORMABLE_LANE_LAMBDA {
    Floats left, weight;
    for (int w = 0; w < FLOATS; ++w) {
      const int k = b.contacts.seat[c + w] >> 1;
      const float sides = g.partner[c + w] == c + w ? 2.0F : 1.0F;
      left[w] = sides * static_cast<float>(pairs.residual[k] * per_length);
      weight[w] = pairs.weight[k] > 0.0F ? pairs.weight[k] / sides : 0.0F;
    }
    store_floats(g.left + c, left);
    store_floats(g.weight + c, weight);
    weights.add(c % LANES, weight, one);
    norm2.add(c % LANES, weight * left, left);
  });
  return {0.5 * norm2.total(), 0.5 * weights.total()};
}

// d = w r + conjugation d; C d/scale of each ring, and the sum of d C d/scale.
template <int SIZE, bool SOFT, bool FIRST>
DEFORMABLE_LANE_FUNCTION void multiply_lanes(float conjugation, int contacts,
                                             const ContactArrays &c, const GradientArrays &g,
                                             const RingArrays &rings, Sum &curvature, int first)
{
  const int n = SIZE > 0 ? SIZE : contacts;
  OfContacts<Floats, SIZE, 3> of(n, c.scratch);
  Floats *const own = of[0], *const product = of[1], *const share = of[2];
  Floats along = Floats{}, sum = Floats{};
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const int at = m * LANES;
    own[m] = load<Floats>(g.weight + at) * load<Floats>(g.left + at);
    if constexpr (!FIRST) own[m] += conjugation * load<Floats>(g.direction + at);
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
    curvature.add(first, own[m], y);
  }
}

DEFORMABLE_LANE_FUNCTION GradientArrays gradients_of(GradientArrays g, int contact)
{
  g.partner += contact;
  for (float **p : {&g.weight, &g.left, &g.direction, &g.step, &g.product}) *p += contact;
  return g;
}

template <bool SOFT, bool FIRST>
static double multiply_all(const RingBatches &b, double conjugation)
{
  Sum sum;
  for_all<FLOATS>(
      b, [&](auto size, int n, const ContactArrays &c, const RingArrays &r) DEFORMABLE_LANE_LAMBDA {
        const int first = static_cast<int>(c.seat - b.contacts.seat);
        multiply_lanes<decltype(size)::value, SOFT, FIRST>(static_cast<float>(conjugation), n, c,
                                                           gradients_of(b.gradients, first), r, sum,
                                                           first % LANES);
      });
  return sum.total();
}

static double multiply_rings(const RingBatches &b, double conjugation)
{
  if (conjugation == 0.0)
    return b.soft ? multiply_all<true, true>(b, 0.0) : multiply_all<false, true>(b, 0.0);
  return b.soft ? multiply_all<true, false>(b, conjugation)
                : multiply_all<false, false>(b, conjugation);
}

template <bool FIRST> static double advance_all(const RingBatches &b, double length)
{
  const GradientArrays &g = b.gradients;
  const float along = static_cast<float>(length);
  Sum norm2;
  for_contacts_in_all(b.contacts_in_all, [&](int c) DEFORMABLE_LANE_LAMBDA {
    const Floats product = load<Floats>(g.product + c) + gather_floats(g.product, g.partner + c);
    const Floats left = load<Floats>(g.left + c) - along * product;
    store_floats(g.left + c, left);
    Floats step = along * load<Floats>(g.direction + c);
    if constexpr (!FIRST) step += load<Floats>(g.step + c);
    store_floats(g.step + c, step);
    norm2.add(c % LANES, load<Floats>(g.weight + c) * left, left);
  });
  return 0.5 * norm2.total();
}

static double advance(const RingBatches &b, double length, bool first)
{
  return first ? advance_all<true>(b, length) : advance_all<false>(b, length);
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
