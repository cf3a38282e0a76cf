// What would make contacts of polygons with edges wrong or incomplete.

#ifndef LMP_EDGE_CHECKS_H
#define LMP_EDGE_CHECKS_H

#include "polygons/polygon_edges.h"

#include <string>

namespace LAMMPS_NS {

// Stops with an error if special_bonds removes or scales contacts of different polygons, or if neigh_modify removes
// contacts of a part of a polygon. To be called with new polygons, when they are linked.
void check_removed_contacts(class LAMMPS *, const PolygonEdges &, const std::string &style);

}    // namespace LAMMPS_NS

#endif
