// Contact lines that tilt: the slope of an outline at its contacts, and the energy that curved lines would save.

#ifndef DEFORMABLE_TILT_H
#define DEFORMABLE_TILT_H

#include "ring_forces.h"

#include <algorithm>

namespace deformable {

// No line tilts by more than 0.3 rad.
constexpr double LARGEST_SINE = 0.29552020666133957;

// The line of a pair at distance d is at rest at the tilt tau with d sin tau = t_i + t_j, where
//   t_c = sum over k of L_k G'(theta_c - theta_k)
// is the slope -dH/dtheta of an outline at the contact, and -p L_c t_c = dU/dtheta_c. While the lengths L stay,
//   dt_c/dtheta_c = sum over k != c of L_k G''(theta_c - theta_k) = (sum L/2 + along)/pi - (GL)_c - G(0) L_c,
//   along = n_c . sum over k of L_k n_k,
// because G'' = -G + 1/2pi + cos(t)/pi for t != 0. `along` vanishes in a ring at rest. T is double, or a vector of
// doubles.
template <class T> DEFORMABLE_INLINE T slope_rate(T lengths, T along, T green_lengths, T length)
{
  return (0.5 * lengths + along) * (1.0 / PI) - green_lengths - GREEN_AT_ZERO * length;
}

// The tension of the outline, T = p q with its mean radius of curvature q; kP (P - P0) where the perimeter changes.
inline double tension(double radius, const LoadedRing &ring, double total)
{
  return ring.pressure * (radius + ring.expansion) - total / (2.0 * PI);
}

// What a contact line between unequal pressures would still save if it were curved, and not straight:
//   (p_i - p_j)^2 L^3 / (24 (T_i + T_j)),   L = F (1/p_i + 1/p_j)/2
// to first order in its curvature. It is infinite where the outlines have no tension.
inline double curvature_energy(double force, double pressure_i, double pressure_j, double tension_i,
                               double tension_j)
{
  if (!(force > 0.0)) return 0.0;
  const double length = 0.5 * force * (1.0 / pressure_i + 1.0 / pressure_j);
  const double push = pressure_i - pressure_j, hold = std::max(tension_i + tension_j, 0.0);
  return push == 0.0 ? 0.0 : push * push * length * length * length / (24.0 * hold);
}

}    // namespace deformable

#endif
