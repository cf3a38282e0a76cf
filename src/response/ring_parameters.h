// How the energy of a ring depends on its parameters.

#ifndef DEFORMABLE_RING_PARAMETERS_H
#define DEFORMABLE_RING_PARAMETERS_H

#include "laws/stiffness.h"
#include "response/dual.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace deformable {

// The radius r without the skin, for given indentations, and the area A0.
enum RingParameter { OF_RADIUS, OF_KA, OF_KP, OF_TENSION, OF_AREA, RING_PARAMETERS };

// With the pressure p and the expansion delta of the outline as variables,
//   U = p S - (p - gamma/r)^2/(2 kA) + kP/2 (2 pi delta)^2 + 2 pi gamma delta,   dS/dr = -2 pi delta,   dS/dA0 = 1,
// is stationary in both: S = A0 - A = D = (p - gamma/r)/kA. So
//   U_r = -2 pi delta p - D gamma/r^2,   U_kA = D^2/2,   U_kP = (2 pi delta)^2/2,   U_gamma = 2 pi delta + D/r,   U_A0 = p,
// of numbers with derivatives.
inline std::array<Dual, RING_PARAMETERS>
by_parameters(const Dual &r, const Dual &kA, const Dual &gamma, const Dual &delta, const Dual &p)
{
  const Dual D = (p - gamma / r) / kA, longer = 2.0 * PI * delta;
  return {-(longer * p) - D * gamma / (r * r), 0.5 * D * D, 0.5 * longer * longer, longer + D / r,
          p};
}

// Of these values, in the order of the parameters, delta, p.
inline std::array<Dual, RING_PARAMETERS> by_parameters(double radius, const Stiffness &k,
                                                       double expansion, double pressure)
{
  constexpr std::size_t all = RING_PARAMETERS + 2;
  return by_parameters(Dual::variable(radius, OF_RADIUS, all), Dual::variable(k.kA, OF_KA, all),
                       Dual::variable(k.tension, OF_TENSION, all),
                       Dual::variable(expansion, RING_PARAMETERS, all),
                       Dual::variable(pressure, RING_PARAMETERS + 1, all));
}

}    // namespace deformable

#endif
