// Commands of LAMMPS that would make results of the deformable pair styles wrong.

#ifndef DEFORMABLE_INPUT_CHECKS_H
#define DEFORMABLE_INPUT_CHECKS_H

#include "lmptype.h"

#include "species.h"

#include <vector>

namespace LAMMPS_NS {

class LAMMPS;
class NeighList;

// Stops with an error if special_bonds removes or scales the contact of two particles of these species (by type).
void check_special_bonds(LAMMPS *, const NeighList &, const std::vector<Species> &);

// Warns if z or vz of a particle is not zero; whether one is, on any rank.
bool warn_out_of_plane(LAMMPS *, const NeighList &);

// Warns if the radius of a particle is not that of its species; whether one is not, on any rank.
bool warn_unused_radii(LAMMPS *, const NeighList &, const std::vector<Species> &);

}    // namespace LAMMPS_NS

#endif
