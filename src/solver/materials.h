// The stiffness of each particle.

#ifndef DEFORMABLE_MATERIALS_H
#define DEFORMABLE_MATERIALS_H

#include "styles/species.h"

#include "laws/stiffness.h"

#include <cmath>

namespace LAMMPS_NS {

struct Materials {
  const Species *species = nullptr;    // by atom type
  const int *type = nullptr;           // by local index
  // of single particles, in place of those of their species; or null
  const double *kA = nullptr, *tension = nullptr;
  // areas that kA = inf conserves give way beyond this times gamma/r + kP/2; 0: never
  double yield = 0.0;

  bool vary() const { return kA || tension; }    // from particle to particle and from call to call
  const Species &species_of(int i) const { return species[type[i]]; }

  // ring_radius: without the skin
  deformable::Stiffness stiffness_of(int i, double ring_radius) const
  {
    deformable::Stiffness k = species_of(i).stiffness;
    if (kA) k.kA = kA[i];
    if (tension) k.tension = tension[i];
    if (yield > 0.0 && std::isinf(k.kA))
      k.yield = yield * (k.rest_pressure(ring_radius) + 0.5 * k.kP);
    return k;
  }
};

}    // namespace LAMMPS_NS

#endif
