// What a change of shape costs.

#ifndef DEFORMABLE_STIFFNESS_H
#define DEFORMABLE_STIFFNESS_H

#include "laws/trigonometry.h"

#include <cmath>
#include <limits>

namespace deformable {

// U = kA/2 (A - A0)^2 + kP/2 (P - P0)^2 + gamma (P - P0) - (gamma/r) (A - A0),   P0 = 2 pi r, A0 = pi r^2
// kA or kP may be infinite: kA = inf conserves the area, kP = inf the perimeter, which then has no gamma. The last
// term is the pressure gamma/r that a free ring of radius r holds against its tension, so that r is at rest.
//
// A minimization may start where contacts leave a ring of kA = inf no room. So that there are forces then, its area gives
// way beyond a pressure y, as that of an ideal gas:  p A = y A0,  with y A0 ln(A0/A) in place of kA/2 (A - A0)^2. That is
// continuous with its first derivatives, and the ring is the incompressible one as long as p <= y. A gas does not collapse
// under any forces if y > gamma/r.
struct Stiffness {
  static constexpr double INF = std::numeric_limits<double>::infinity();
  double kA = 0.0;         // of the area, energy/length^4
  double kP = INF;         // of the perimeter, energy/length^2
  double tension = 0.0;    // gamma of the perimeter at rest, energy/length
  double yield = INF;      // y, beyond which the area gives way, energy/length^2

  // All of a shape depends on this alone, 0 (area conserved) to infinity (perimeter conserved).
  double ratio() const { return kP / kA; }
  bool conserves_perimeter() const { return std::isinf(ratio()); }

  // Laplace's pressure of a free ring.
  double rest_pressure(double ring_radius) const { return tension / ring_radius; }

  // T = gamma + kP (P - P0) of the outline of a ring that has expanded by delta, and dT/dP
  template <class Number> Number line_tension(const Number &delta) const
  {
    return line_tension_of<Number>(tension, kP, delta);
  }
  template <class Number>
  static Number line_tension_of(const Number &gamma, const Number &stiffness, const Number &delta)
  {
    return gamma + 2.0 * PI * stiffness * delta;
  }
  double perimeter_stiffness(double /* delta */) const { return kP; }

  bool gives_way(double pressure) const { return pressure > yield; }
  // dp/dD of a ring that gives way
  double yielding_kA(double ring_radius, double pressure) const
  {
    return pressure * pressure / (PI * ring_radius * ring_radius * yield);
  }
};

// The same of many rings: an array of each member, null where all rings have its default.
struct StiffnessArrays {
  const double *kA, *kP, *tension, *yield;
};

// All members in their order. Those with a name are the parameters of a species: species files, fix adapt, restarts and Python
// go through this table, and so do batches of rings.
struct Parameter {
  const char *name;
  double Stiffness::*of_ring;
  const double *StiffnessArrays::*of_rings;
};
constexpr Parameter PARAMETERS[] = {
    {"kA", &Stiffness::kA, &StiffnessArrays::kA},
    {"kP", &Stiffness::kP, &StiffnessArrays::kP},
    {"tension", &Stiffness::tension, &StiffnessArrays::tension},
    {nullptr, &Stiffness::yield, &StiffnessArrays::yield},
};
constexpr int MEMBERS = sizeof PARAMETERS / sizeof *PARAMETERS;
constexpr int FIRST_KEYWORD = 2;    // kA and kP must be given, those from here on have defaults

DEFORMABLE_INLINE Stiffness stiffness_at(const StiffnessArrays &arrays, int ring)
{
  Stiffness k;
#pragma GCC unroll 8
  for (const Parameter &p : PARAMETERS)
    if (arrays.*p.of_rings) k.*p.of_ring = (arrays.*p.of_rings)[ring];
  return k;
}

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
