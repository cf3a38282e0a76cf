// Names of LAMMPS within ours: only styles are in LAMMPS_NS, where LAMMPS and its packages look for them.

#ifndef DEFORMABLE_LAMMPS_NAMES_H
#define DEFORMABLE_LAMMPS_NAMES_H

#include "pointers.h"

namespace LAMMPS_NS {

class Compute;
class Fix;
class LAMMPS;
class NeighList;
class Region;

}    // namespace LAMMPS_NS

namespace deformable {

using namespace LAMMPS_NS;

}    // namespace deformable

#endif
