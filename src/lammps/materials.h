// The stiffness of each particle.

#ifndef DEFORMABLE_MATERIALS_H
#define DEFORMABLE_MATERIALS_H

#include "species.h"

#include "stiffness.h"

#include <cmath>

namespace LAMMPS_NS {

struct Materials {
  const Species *species = nullptr;    // by atom type
  const int *type = nullptr;           // by local index
  double yield =
      0.0;    // areas that kA = inf conserves give way beyond this times gamma/r + kP/2; 0: never

  const Species &species_of(int i) const { return species[type[i]]; }

  // ring_radius: without the skin
  deformable::Stiffness stiffness_of(int i, double ring_radius) const
  {
    deformable::Stiffness k = species_of(i).stiffness;
    if (yield > 0.0 && std::isinf(k.kA))
      k.yield = yield * (k.rest_pressure(ring_radius) + 0.5 * k.kP);
    return k;
  }
};

}    // namespace LAMMPS_NS

#endif
