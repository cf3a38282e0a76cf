// Directions that are drawn about another one, n, by the angle theta to it; 0: any direction. In the plane by von Mises' density,
//   p(theta) = exp(kappa cos(theta))/(2 pi I0(kappa)),   <cos(m theta)> = I_m(kappa)/I0(kappa),
// in space by Fisher's, toward any side,
//   p(cos(theta)) = kappa exp(kappa cos(theta))/(2 sinh(kappa)),   <cos(theta)> = coth(kappa) - 1/kappa
// Source: R. A. Fisher, Proc. R. Soc. Lond. A 217, 295 (1953); Mardia and Jupp, Directional Statistics (Wiley, 2000).

#ifndef DEFORMABLE_DRAWN_DIRECTIONS_H
#define DEFORMABLE_DRAWN_DIRECTIONS_H

#include "laws/trigonometry.h"
#include "laws/vector3.h"
#include "styles/motion/counted_random.h"

#include <algorithm>
#include <cmath>

namespace deformable {

// By rejection: 1 - cos(theta) >= 2 (theta/pi)^2, so that a normal deviate is drawn too often nowhere.
inline double drawn_angle(double kappa, CountedRandom &random)
{
  while (true) {
    const bool wide = kappa < 1.0;
    const double angle = wide ? PI * (2.0 * random.uniform() - 1.0)
                              : 0.5 * PI / std::sqrt(kappa) * random.gaussian();
    const double half = std::sin(0.5 * angle), part = angle / PI;
    const double excess = 2.0 * kappa * (half * half - (wide ? 0.0 : part * part));
    if (std::fabs(angle) <= PI && std::log(random.uniform()) < -excess) return angle;
  }
}

inline Vector3 drawn_in_plane(const Vector3 &n, double kappa, CountedRandom &random)
{
  const double angle = drawn_angle(kappa, random), c = std::cos(angle), s = std::sin(angle);
  return {c * n.x - s * n.y, s * n.x + c * n.y, 0.0};
}

inline Vector3 drawn_in_space(const Vector3 &n, double kappa, CountedRandom &random)
{
  kappa = std::max(kappa, 1e-8);
  const double less = -std::log1p(std::expm1(-2.0 * kappa) * random.uniform()) / kappa,
               angle = 2.0 * PI * random.uniform();
  const Vector3 axis = std::fabs(n.x) < 0.5 ? Vector3{1, 0, 0} : Vector3{0, 1, 0};
  const Vector3 out = across(axis, n), beside = cross(n, out);
  const double sine = std::sqrt(std::max(less * (2.0 - less), 0.0)) / length(out);
  const Vector3 turned =
      (1.0 - less) * n + sine * (std::cos(angle) * out + std::sin(angle) * beside);
  return (1.0 / length(turned)) * turned;
}

}    // namespace deformable

#endif
