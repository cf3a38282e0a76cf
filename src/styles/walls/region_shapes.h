// The shapes of LAMMPS' regions, and where they are now.

#ifndef DEFORMABLE_REGION_SHAPES_H
#define DEFORMABLE_REGION_SHAPES_H

#include "geometry/scene.h"

#include "region.h"

#include <string>

namespace LAMMPS_NS {

// LAMMPS installs only the base class of its regions. The geometry of a plane, block, prism, cylinder, cone (in space) or sphere
// is therefore computed from the contacts that the region reports for points near to it and far from it, before it moves, and
// whatever its `side` is. Returns what is wrong with a region that is no such shape, or nothing. (x, y): a point of the system, for
// planes.
std::string read_shape(Region *, int dimension, double x, double y, deformable::WallShape &);

// A shape that moves with its region. LAMMPS rotates it about a point first, then it moves it.
deformable::WallShape moved_with(Region *, const deformable::WallShape &);
deformable::Motion motion_of(Region *);

}    // namespace LAMMPS_NS

#endif
