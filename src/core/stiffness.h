// What a change of shape costs.

#ifndef DEFORMABLE_STIFFNESS_H
#define DEFORMABLE_STIFFNESS_H

#include <cmath>

namespace deformable {

// One of the two may be infinite: kA = inf conserves the area, kP = inf the perimeter.
struct Stiffness {
  double kA;    // of the area, energy/length^4
  double kP;    // of the perimeter, energy/length^2

  // All of a shape depends on this alone, 0 (area conserved) to infinity (perimeter conserved).
  double ratio() const { return kP / kA; }
  bool conserves_perimeter() const { return std::isinf(ratio()); }
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
