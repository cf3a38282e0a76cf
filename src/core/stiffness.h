// What a change of shape costs.

#ifndef DEFORMABLE_STIFFNESS_H
#define DEFORMABLE_STIFFNESS_H

#include <cmath>

namespace deformable {

// U = kA/2 (A - A0)^2 + kP/2 (P - P0)^2 + gamma (P - P0) - (gamma/r) (A - A0),   P0 = 2 pi r, A0 = pi r^2
// kA or kP may be infinite: kA = inf conserves the area, kP = inf the perimeter, which then has no gamma. The last
// term is the pressure gamma/r that a free ring of radius r holds against its tension, so that r is at rest.
struct Stiffness {
  double kA;               // of the area, energy/length^4
  double kP;               // of the perimeter, energy/length^2
  double tension = 0.0;    // gamma of the perimeter at rest, energy/length

  // All of a shape depends on this alone, 0 (area conserved) to infinity (perimeter conserved).
  double ratio() const { return kP / kA; }
  bool conserves_perimeter() const { return std::isinf(ratio()); }

  // Laplace's pressure of a free ring.
  double rest_pressure(double ring_radius) const { return tension / ring_radius; }
};

// Its derivative is the pressure where an area changes, the tension where a perimeter does.
struct Energy {
  double value;
  double derivative;
};

// U = k/2 change^2, for the area deficit (k = kA, p = kA S) or the perimeter excess (k = kP)
inline Energy harmonic(double stiffness, double change)
{
  return {0.5 * stiffness * change * change, stiffness * change};
}

}    // namespace deformable

#endif
