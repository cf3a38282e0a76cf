// Commands of LAMMPS that would make results of the deformable pair styles wrong.

#ifndef DEFORMABLE_INPUT_CHECKS_H
#define DEFORMABLE_INPUT_CHECKS_H

#include "lmptype.h"

#include "styles/species.h"

#include <vector>

namespace LAMMPS_NS {

class LAMMPS;
class NeighList;

// Refuses (refusals.h) if special_bonds or comm_modify removes contacts of particles of these species (by type).
void check_contacts(LAMMPS *, const NeighList &, const std::vector<Species> &);

// The same for comm_modify only, which removes the ghosts of particles outside of a group.
void check_ghosts(LAMMPS *, const NeighList &);

// Refuses coefficients in a data file, which are of another pair style.
void refuse_data_coefficients(LAMMPS *);

// Warns if z or vz of a particle is not zero; whether one is, on any rank.
bool warn_out_of_plane(LAMMPS *, const NeighList &);

// Warns if the radius of a particle is not that of its species; whether one is not, on any rank.
bool warn_unused_radii(LAMMPS *, const NeighList &, const std::vector<Species> &);

}    // namespace LAMMPS_NS

#endif
