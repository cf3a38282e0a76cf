// Rings of beads: molecules whose beads follow one another in tag order.

#ifndef LMP_BEAD_RINGS_H
#define LMP_BEAD_RINGS_H

#include "lmptype.h"

#include <vector>

namespace LAMMPS_NS {

struct BeadRing {
  tagint molecule, first;
  int beads;
  double area;    // negative where the beads run clockwise
  double perimeter;
  int image_x, image_y;    // image flags of the first bead, from which those of the others count
  double x, y;             // mean of the beads in that image
};

// The rings of a fix' group, by rising molecule ID, as the beads are now; the same on every rank.
std::vector<BeadRing> find_bead_rings(class LAMMPS *lmp, int groupbit, const char *fix_id);

// Image flags as LAMMPS packs them, not negative.
inline int image_x(imageint image)
{
  return image & IMGMASK;
}

inline int image_y(imageint image)
{
  return image >> IMGBITS & IMGMASK;
}

// They count boxes modulo their range: a ring that crosses so many is still whole.
inline int boxes_between(int from, int to)
{
  return ((to - from + IMGMAX) & IMGMASK) - IMGMAX;
}

// Whether no periodic image of what lies at (dx, dy) is nearer.
bool is_nearest_image(const class Domain *domain, double dx, double dy);

}    // namespace LAMMPS_NS

#endif
