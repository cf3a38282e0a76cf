// The logarithm of vectors of doubles, the same on every level of SIMD instructions.

#ifndef DEFORMABLE_LANE_LOGARITHM_H
#define DEFORMABLE_LANE_LOGARITHM_H

#include "kernels/lanes.h"

namespace deformable::DEFORMABLE_LEVEL {

struct Logarithm {
  Lanes value, over;    // ln x, 1/x
};

// artanh(t)/t by powers of t^2: interpolated at Chebyshev's points of t^2 < 0.0295, with an error below 2e-18.
constexpr int TERMS = 8;
constexpr double ARTANH[TERMS] = {1.0,
                                  0.33333333333333826,
                                  0.1999999999965117,
                                  0.1428571438032084,
                                  0.11111098528362971,
                                  0.09091815840117472,
                                  0.07656264074106932,
                                  0.07404855181113693};

// For positive, finite x that are not denormal. x = 2^e a, sqrt(1/2) <= a < sqrt(2):
//   ln a = 2 artanh t,   t = (a - 1)/(a + 1)
DEFORMABLE_LANE_FUNCTION Logarithm logarithm(Lanes x)
{
  typedef unsigned long long Bits __attribute__((vector_size(8 * W)));
  constexpr unsigned long long ONE = 0x3ff0000000000000ULL, FRACTION = 0x000fffffffffffffULL,
                               TO_52 = 0x4330000000000000ULL;    // 2^52
  constexpr double BIAS = 4503599627370496.0 + 1023.0, LN_2 = 0.69314718055994530942;
  const Bits bits = (Bits)x;
  // the exponent as the low bits of a number of the size of 2^52: conversions of integers are slow on older processors
  Lanes exponent = (Lanes)((bits >> 52) | TO_52) - BIAS;
  Lanes a = (Lanes)((bits & FRACTION) | ONE);
  const Mask high = a > 1.41421356237309504880;
  a = select(high, 0.5 * a, a);
  exponent = select(high, exponent + 1.0, exponent);
  const Lanes sum = a + 1.0, quotient = 1.0 / (x * sum);    // one division for both
  const Lanes t = (a - 1.0) * (x * quotient), t2 = t * t;
  Lanes series = all(ARTANH[TERMS - 1]);
  for (int n = TERMS - 2; n >= 0; --n) series = series * t2 + ARTANH[n];
  return {exponent * LN_2 + 2.0 * t * series, sum * quotient};
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
