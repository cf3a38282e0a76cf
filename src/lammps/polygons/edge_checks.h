// What would make contacts of rings with edges wrong or incomplete.

#ifndef LMP_EDGE_CHECKS_H
#define LMP_EDGE_CHECKS_H

#include "ring_edges.h"

#include <string>

namespace LAMMPS_NS {

// Stops with an error if special_bonds removes or scales contacts of different rings, or if neigh_modify removes
// contacts of a part of a ring. To be called with new rings, when they are linked.
void check_removed_contacts(class LAMMPS *, const RingEdges &, const std::string &style);

}    // namespace LAMMPS_NS

#endif
