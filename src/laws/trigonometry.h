// Differences of trigonometric functions that vanish faster than their terms, to full relative accuracy.

#ifndef DEFORMABLE_TRIGONOMETRY_H
#define DEFORMABLE_TRIGONOMETRY_H

#include "laws/numbers.h"

#include <cmath>

namespace deformable {

constexpr double PI = 3.14159265358979323846;

// Taylor series for |x| < 1, as polynomials in x^2 after the leading power of x is taken out. Nine terms
// leave an error below 1e-17.
namespace taylor {
constexpr int TERMS = 9;

struct Polynomial {
  double coefficient[TERMS] = {};
  template <class T> constexpr DEFORMABLE_INLINE T operator()(T x2) const
  {
    T sum{};
    for (int k = TERMS - 1; k >= 0; --k) sum = sum * x2 + coefficient[k];
    return sum;
  }
};

// sum over k of (-1)^k multiplier(k) x^2k / (2k + first)!
template <class Multiplier> constexpr Polynomial alternating(int first, Multiplier multiplier)
{
  Polynomial p;
  double factorial = 1.0;
  for (int m = 2; m <= first; ++m) factorial *= m;
  for (int k = 0; k < TERMS; ++k) {
    p.coefficient[k] = (k % 2 ? -1.0 : 1.0) * multiplier(k) / factorial;
    factorial *= (2.0 * k + first + 1) * (2.0 * k + first + 2);
  }
  return p;
}

struct One {
  constexpr double operator()(int) const { return 1.0; }
};
struct TwiceNext {
  constexpr double operator()(int k) const { return 2.0 * k + 2.0; }
};

// (1 - cos x) / x^2, (x - sin x) / x^3
inline constexpr Polynomial VERSINE = alternating(2, One());
inline constexpr Polynomial X_MINUS_SINE = alternating(3, One());
// (sin x - x cos x) / x^3, (2 - 2 cos x - x sin x) / x^4
inline constexpr Polynomial SINE_MINUS_X_COSINE = alternating(3, TwiceNext());
inline constexpr Polynomial TWO_VERSINES_MINUS_X_SINE = alternating(4, TwiceNext());

// (atan(sqrt s)/sqrt s - 1)/s on 0 <= s <= tan(pi/8)^2, from s, s^2 and s^4: Chebyshev fit, error of the angle
// 5e-18
template <class T> DEFORMABLE_INLINE T arctangent(T s, T s2, T s4)
{
  const T low = (-0.3333333333333333016 + 0.19999999999995520678 * s) +
                (-0.14285714284666542922 + 0.11111111015256361727 * s) * s2;
  const T middle = (-0.090909045781239018905 + 0.076921831908260865637 * s) +
                   (-0.066645114473819480001 + 0.058581489128022098816 * s) * s2;
  const T high =
      (-0.050854497379402598613 + 0.039231658295587191303 * s) + -0.019176887119062258989 * s2;
  return low + s4 * (middle + s4 * high);
}
}    // namespace taylor

// sin x - x cos x ~ x^3/3
inline double sine_minus_x_cosine(double x, double sine, double cosine)
{
  return x < 1.0 ? x * x * x * taylor::SINE_MINUS_X_COSINE(x * x) : sine - x * cosine;
}

// atan2(y, x) to 4e-16, for (x, y) other than the origin. Above tan(pi/8), atan(small/large) is computed as a difference from pi/4.
template <class T> DEFORMABLE_INLINE T angle_of(T x, T y)
{
  const T ax = magnitude(x), ay = magnitude(y), large = larger(ax, ay), small = smaller(ax, ay);
  const auto upper = small > 0.41421356237309503 * large;
  const T z = select(upper, small - large, small) / select(upper, large + small, large);

  const T s = z * z, s2 = s * s, s4 = s2 * s2;
  const T octant = z + z * s * taylor::arctangent(s, s2, s4);

  const T eighth = select(upper, 0.25 * PI + octant, octant);
  const T quarter = select(ay > ax, 0.5 * PI - eighth, eighth);
  return with_sign_of(select(x < 0.0, PI - quarter, quarter), y);
}

}    // namespace deformable

#endif
