// Differences of trigonometric functions that vanish faster than their terms, to full relative accuracy.

#ifndef DEFORMABLE_TRIGONOMETRY_H
#define DEFORMABLE_TRIGONOMETRY_H

#include <cmath>

namespace deformable {

constexpr double PI = 3.14159265358979323846;

// Taylor series for |x| < 1, as polynomials in x^2 after the leading power of x is taken out. Nine terms
// leave an error below 1e-17.
namespace taylor {
constexpr int TERMS = 9;

struct Polynomial {
  double coefficient[TERMS] = {};
  constexpr double operator()(double x2) const
  {
    double sum = 0.0;
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

constexpr double one(int) { return 1.0; }
constexpr double twice_next(int k) { return 2.0 * k + 2.0; }

inline constexpr Polynomial SINE = alternating(1, one);                       // sin x / x
inline constexpr Polynomial VERSINE = alternating(2, one);                    // (1 - cos x) / x^2
inline constexpr Polynomial X_MINUS_SINE = alternating(3, one);               // (x - sin x) / x^3
inline constexpr Polynomial SINE_MINUS_X_COSINE = alternating(3, twice_next); // (sin x - x cos x) / x^3
// (2 - 2 cos x - x sin x) / x^4
inline constexpr Polynomial TWO_VERSINES_MINUS_X_SINE = alternating(4, twice_next);
}    // namespace taylor

// sin x - x cos x ~ x^3/3
inline double sine_minus_x_cosine(double x, double sine, double cosine)
{
  return x < 1.0 ? x * x * x * taylor::SINE_MINUS_X_COSINE(x * x) : sine - x * cosine;
}

}    // namespace deformable

#endif
