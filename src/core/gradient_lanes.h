// Conjugate gradients for the forces of pairs, ring by ring, in single precision (GradientArrays in force_kernels.h).
//
// Sums have LANES parts on every level, so that all levels add in the same order.

#ifndef DEFORMABLE_GRADIENT_LANES_H
#define DEFORMABLE_GRADIENT_LANES_H

#include "force_lanes.h"

namespace deformable::DEFORMABLE_LEVEL {

// A sum of many numbers in single precision: each term is itself a sum of few.
struct PartialSums {
  double part[LANES] = {};
  DEFORMABLE_LANE_LAMBDA void add(int first, Floats term)
  {
    for (int w = 0; w < FLOATS; ++w) part[first + w] += static_cast<double>(term[w]);
  }
  double total() const
  {
    double sum = 0.0;
    for (const double p : part) sum += p;
    return sum;
  }
};

// term(c) over all contacts, vector by vector.
template <class Term> DEFORMABLE_LANE_FUNCTION double sum_of_contacts(int contacts, Term &&term)
{
  constexpr int BLOCK = 16 * LANES, PARTS = LANES / FLOATS;
  PartialSums sums;
  for (int begin = 0; begin < contacts; begin += BLOCK) {
    const int end = begin + BLOCK < contacts ? begin + BLOCK : contacts;
    Floats part[PARTS] = {};
    for (int c = begin; c < end; c += LANES)
      for (int n = 0; n < PARTS; ++n) part[n] += term(c + n * FLOATS);
    for (int n = 0; n < PARTS; ++n) sums.add(n * FLOATS, part[n]);
  }
  return sums.total();
}

// A wall has one contact: twice its residual and half of its weight make it a pair of two that are the same.
static GradientStart begin_gradients(const RingBatches &b, const PairArrays &pairs)
{
  const GradientArrays &g = b.gradients;
  PartialSums weights;
  const double norm2 = sum_of_contacts(b.contacts_in_all, [&](int c) DEFORMABLE_LANE_LAMBDA {
    Floats left, weight;
    for (int w = 0; w < FLOATS; ++w) {
      const int k = b.contacts.seat[c + w] >> 1;
      const float sides = g.partner[c + w] == c + w ? 2.0F : 1.0F;
      left[w] = sides * static_cast<float>(pairs.residual[k]);
      weight[w] = pairs.weight[k] / sides;
    }
    store_floats(g.left + c, left);
    store_floats(g.weight + c, weight);
    store_floats(g.direction + c, Floats{});
    store_floats(g.step + c, Floats{});
    weights.add(c % LANES, weight);
    return weight * left * left;
  });
  return {0.5 * norm2, 0.5 * weights.total()};
}

// d = w r + conjugation d; C d/scale of each ring. Returns the parts of d C d/scale.
template <int SIZE, bool SOFT>
DEFORMABLE_LANE_FUNCTION Floats multiply_lanes(float conjugation, double scale, int contacts,
                                               const ContactArrays &c, const GradientArrays &g,
                                               const RingArrays &rings)
{
  const int n = SIZE > 0 ? SIZE : contacts;
  OfContacts<Floats, SIZE, 3> of(n, c.scratch);
  Floats *const own = of[0], *const product = of[1], *const share = of[2];
  Floats along = Floats{}, sum = Floats{};
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const int at = m * LANES;
    own[m] = load<Floats>(g.weight + at) * load<Floats>(g.left + at) +
             conjugation * load<Floats>(g.direction + at);
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
  for (int w = 0; w < FLOATS; ++w) per_p[w] = static_cast<float>(rings.per_pressure[w] / scale);
  Floats curvature = Floats{};
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    Floats y = product[m] - of_share * share[m];
    if constexpr (SOFT) y += constant;
    y *= per_p;
    store_floats(g.product + m * LANES, y);
    curvature += own[m] * y;
  }
  return curvature;
}

DEFORMABLE_LANE_FUNCTION GradientArrays gradients_of(GradientArrays g, int contact)
{
  g.partner += contact;
  for (float **p : {&g.weight, &g.left, &g.direction, &g.step, &g.product}) *p += contact;
  return g;
}

template <bool SOFT>
static double multiply_all(const RingBatches &b, double conjugation, double scale)
{
  PartialSums sums;
  for_all<FLOATS>(b, [&](auto size, int n, const ContactArrays &c, const RingArrays &r)
                         DEFORMABLE_LANE_LAMBDA {
                           const int first = static_cast<int>(c.seat - b.contacts.seat);
                           const Floats curvature = multiply_lanes<decltype(size)::value, SOFT>(
                               static_cast<float>(conjugation), scale, n, c,
                               gradients_of(b.gradients, first), r);
                           sums.add(first % LANES, curvature);
                         });
  return sums.total();
}

static double multiply_rings(const RingBatches &b, double conjugation, double scale)
{
  return b.soft ? multiply_all<true>(b, conjugation, scale)
                : multiply_all<false>(b, conjugation, scale);
}

static double advance(const RingBatches &b, double length)
{
  const GradientArrays &g = b.gradients;
  const float along = static_cast<float>(length);
  return 0.5 * sum_of_contacts(b.contacts_in_all, [&](int c) DEFORMABLE_LANE_LAMBDA {
           const Floats product =
               load<Floats>(g.product + c) + gather_floats(g.product, g.partner + c);
           const Floats left = load<Floats>(g.left + c) - along * product;
           store_floats(g.left + c, left);
           store_floats(g.step + c, load<Floats>(g.step + c) + along * load<Floats>(g.direction + c));
           return load<Floats>(g.weight + c) * left * left;
         });
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
