// Numbers with derivatives.

#ifndef DEFORMABLE_DUAL_H
#define DEFORMABLE_DUAL_H

#include <cmath>
#include <cstddef>
#include <vector>

namespace deformable {

// A number with its derivatives by several variables: formulas that are templates give both at once.
struct Dual {
  double value = 0.0;
  std::vector<double> by;    // empty: a constant

  Dual() = default;
  Dual(double constant) : value(constant) {}
  static Dual variable(double value, std::size_t index, std::size_t count)
  {
    Dual x(value);
    x.by.assign(count, 0.0);
    x.by[index] = 1.0;
    return x;
  }

  // f of this number, with f'
  Dual chained(double f, double slope) const
  {
    Dual result(f);
    result.by = by;
    for (double &d : result.by) d *= slope;
    return result;
  }

  Dual &operator+=(const Dual &y) { return *this = *this + y; }
  Dual &operator-=(const Dual &y) { return *this = *this - y; }
  Dual &operator*=(const Dual &y) { return *this = *this * y; }
  Dual operator-() const { return chained(-value, -1.0); }
  friend Dual operator+(const Dual &x, const Dual &y)
  {
    return sum(x.value + y.value, x, 1.0, y, 1.0);
  }
  friend Dual operator-(const Dual &x, const Dual &y)
  {
    return sum(x.value - y.value, x, 1.0, y, -1.0);
  }
  friend Dual operator*(const Dual &x, const Dual &y)
  {
    return sum(x.value * y.value, x, y.value, y, x.value);
  }
  friend Dual operator/(const Dual &x, const Dual &y)
  {
    const double ratio = x.value / y.value;
    return sum(ratio, x, 1.0 / y.value, y, -ratio / y.value);
  }

 private:
  static Dual sum(double value, const Dual &x, double of_x, const Dual &y, double of_y)
  {
    if (y.by.empty()) return x.chained(value, of_x);
    Dual result = y.chained(value, of_y);
    for (std::size_t k = 0; k < x.by.size(); ++k) result.by[k] += of_x * x.by[k];
    return result;
  }
};

inline double value_of(double x)
{
  return x;
}

inline double value_of(const Dual &x)
{
  return x.value;
}

inline Dual sin(const Dual &x)
{
  return x.chained(std::sin(x.value), std::cos(x.value));
}

inline Dual cos(const Dual &x)
{
  return x.chained(std::cos(x.value), -std::sin(x.value));
}

inline double log(double x)
{
  return std::log(x);
}

inline Dual log(const Dual &x)
{
  return x.chained(std::log(x.value), 1.0 / x.value);
}

inline double exp(double x)
{
  return std::exp(x);
}

inline Dual exp(const Dual &x)
{
  const double e = std::exp(x.value);
  return x.chained(e, e);
}

inline Dual sqrt(const Dual &x)
{
  const double root = std::sqrt(x.value);
  return x.chained(root, 0.5 / root);
}

inline Dual root(const Dual &x)
{
  return sqrt(x);
}

inline Dual magnitude(const Dual &x)
{
  return x.value < 0.0 ? -x : x;
}

inline Dual with_sign_of(const Dual &x, const Dual &sign)
{
  return std::signbit(x.value) == std::signbit(sign.value) ? x : -x;
}

inline Dual larger(const Dual &a, const Dual &b)
{
  return a.value < b.value ? b : a;
}

inline bool operator>(const Dual &x, double y)
{
  return x.value > y;
}

inline bool operator!=(const Dual &x, double y)
{
  return x.value != y;
}

}    // namespace deformable

#endif
