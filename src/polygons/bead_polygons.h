// Bead polygons: molecules whose beads have consecutive atom IDs along the polygon.

#ifndef LMP_BEAD_POLYGONS_H
#define LMP_BEAD_POLYGONS_H

#include "lmptype.h"

#include <functional>
#include <string>
#include <vector>

namespace LAMMPS_NS {

struct BeadPolygon {
  tagint molecule, first;
  int beads;
  double area;    // negative if the beads run clockwise
  double perimeter;
  int image_x, image_y;    // image flags of the first bead
  double x, y;             // mean of the beads in that image
};

// The beads of a style, and how its errors name both: "Fix area deformable/polygon", "the group of the fix".
struct BeadSelection {
  std::string style, name;
  std::function<bool(int)> has;    // this atom of the rank
};

// The polygons of the selected beads at present, by rising molecule ID; the same on every rank.
std::vector<BeadPolygon> find_bead_polygons(class LAMMPS *lmp, const BeadSelection &);

// Image flags as LAMMPS stores them, not negative.
inline int image_x(imageint image)
{
  return image & IMGMASK;
}

inline int image_y(imageint image)
{
  return image >> IMGBITS & IMGMASK;
}

// Image flags wrap around at the end of their range.
inline int boxes_between(int from, int to)
{
  return ((to - from + IMGMAX) & IMGMASK) - IMGMAX;
}

// Whether no periodic image of the vector (dx, dy) is shorter.
bool is_nearest_image(const class Domain *domain, double dx, double dy);

}    // namespace LAMMPS_NS

#endif
