// Particles that grow, the slower the more others press on them, and divide in two.
//
// The size V of a particle without contacts, pi R^2, in space 4 pi R^3/3, follows
//   dV/dt = rate V max(0, 1 - p/P)
// with the mean pressure p of its contacts, and the pressure P at which growth ceases.
// Source: Shraiman, PNAS 102, 3318 (2005); Basan et al., HFSP J. 3, 265 (2009).
//
// Two daughters have the sizes s V and (1 - s) V. They lie side by side on an axis n, at x + (1 - s) D n and x - s D n, where D is
// their distance: the center of mass x stays. The axis is that of least pressure, or the long one of the outline (Hertwig's rule).

#ifndef DEFORMABLE_PROLIFERATION_H
#define DEFORMABLE_PROLIFERATION_H

#include "laws/trigonometry.h"
#include "laws/vector3.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace deformable {

// V of a radius.
inline double size_of(double radius, int dimension)
{
  return dimension == 2 ? PI * radius * radius : 4.0 / 3.0 * PI * radius * radius * radius;
}

// rate max(0, 1 - p/P), with P = `most`
inline double growth_rate(double rate, double pressure, double most)
{
  return rate * std::max(0.0, 1.0 - pressure / most);
}

// s = (1 + asymmetry u)/2, with u drawn between -1 and 1
inline double first_share(double asymmetry, double u)
{
  return 0.5 * (1.0 + asymmetry * u);
}

// Their contact line is h = c r from the center of the smaller one:
//   R_1 = s^(1/d) R,  R_2 = (1 - s)^(1/d) R,  distance = h + sqrt(h^2 + R^2 - r^2)
// with the smaller radius r and the larger one R of the two. In the plane c is 1/2. In space it is 4/5, for which the law of
// droplets still holds; nearer to each other they overlap so far that forces may not balance where neighbors press, too.
struct Daughters {
  double first, second, distance;
};
inline Daughters daughters(double radius, double share, int dimension)
{
  const auto root = [&](double x) { return dimension == 2 ? std::sqrt(x) : std::cbrt(x); };
  const double first = radius * root(share), second = radius * root(1.0 - share);
  const double small = std::min(first, second), large = std::max(first, second);
  const double line = (dimension == 2 ? 0.5 : 0.8) * small;
  return {first, second, line + std::sqrt(line * line + large * large - small * small)};
}

struct SymmetricTensor {
  double xx = 0.0, yy = 0.0, zz = 0.0, yz = 0.0, xz = 0.0, xy = 0.0;
};

// sum += weight n n
inline void add(SymmetricTensor &sum, double weight, const Vector3 &n)
{
  sum.xx += weight * n.x * n.x;
  sum.yy += weight * n.y * n.y;
  sum.zz += weight * n.z * n.z;
  sum.yz += weight * n.y * n.z;
  sum.xz += weight * n.x * n.z;
  sum.xy += weight * n.x * n.y;
}

// Twelve times the second moments of the triangle of the center and the line from a to b of an outline:
// (a x b) (a a + b b + (a + b)(a + b))
inline void add_triangle(SymmetricTensor &moments, const Vector3 &a, const Vector3 &b)
{
  const double area = cross(a, b).z;
  for (const Vector3 &corner : {a, b, a + b}) add(moments, area, corner);
}

// p = tr S/(d V) of S = sum over contacts of f h n n, with the force f and the distance h of the contact.
inline double mean_pressure(const SymmetricTensor &s, double size, int dimension)
{
  return (s.xx + s.yy + s.zz) / (dimension * size);
}

// The axis of the largest eigenvalue of a positive matrix, by squaring it until nothing else is left.
inline Vector3 main_axis(SymmetricTensor m)
{
  for (int k = 0; k < 40; ++k) {
    const double per_trace = 1.0 / (m.xx + m.yy + m.zz);
    const Vector3 x = per_trace * Vector3{m.xx, m.xy, m.xz},
                  y = per_trace * Vector3{m.xy, m.yy, m.yz},
                  z = per_trace * Vector3{m.xz, m.yz, m.zz};
    m = {dot(x, x), dot(y, y), dot(z, z), dot(y, z), dot(x, z), dot(x, y)};
  }
  const Vector3 column = m.xx >= m.yy && m.xx >= m.zz ? Vector3{m.xx, m.xy, m.xz}
                         : m.yy >= m.zz               ? Vector3{m.xy, m.yy, m.yz}
                                                      : Vector3{m.xz, m.yz, m.zz};
  return column / length(column);
}

// Whether all directions are alike, up to the error of forces: |S - tr S/d 1| <= 1e-6 |S|.
inline bool is_isotropic(const SymmetricTensor &s, int dimension)
{
  constexpr double ALIKE = 1e-6;
  const double mean = (s.xx + s.yy + s.zz) / dimension, z = dimension == 3 ? s.zz - mean : 0.0;
  const auto square = [&](double x, double y, double z) {
    return x * x + y * y + z * z + 2.0 * (s.yz * s.yz + s.xz * s.xz + s.xy * s.xy);
  };
  return square(s.xx - mean, s.yy - mean, z) <= ALIKE * ALIKE * square(s.xx, s.yy, s.zz);
}

// Along which a particle is pressed least, or pulled most; none without contacts, or if all directions are alike. S as above:
// the largest eigenvalue of sum - S, where no eigenvalue of S is larger than the sum of all components.
inline std::optional<Vector3> stretched_axis(const SymmetricTensor &s, int dimension)
{
  if (is_isotropic(s, dimension)) return {};
  const double sum = std::fabs(s.xx) + std::fabs(s.yy) + std::fabs(s.zz) +
                     2.0 * (std::fabs(s.yz) + std::fabs(s.xz) + std::fabs(s.xy));
  return main_axis(
      {sum - s.xx, sum - s.yy, dimension == 3 ? sum - s.zz : 0.0, -s.yz, -s.xz, -s.xy});
}

// Of the second moments of an outline in the plane; none if it is round.
inline std::optional<Vector3> long_axis(const SymmetricTensor &moments)
{
  if (is_isotropic(moments, 2)) return {};
  return main_axis(moments);
}

}    // namespace deformable

#endif
