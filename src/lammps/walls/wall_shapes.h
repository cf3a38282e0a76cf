// The shapes that walls are made of, read from LAMMPS' regions.

#ifndef DEFORMABLE_WALL_SHAPES_H
#define DEFORMABLE_WALL_SHAPES_H

#include "obstacle.h"

#include "region.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// A convex set of points of the plane of the particles: half planes that intersect, or a disk. Given in the frame
// of its region, before the region moves. It does not depend on `side`.
struct WallShape {
  std::string name;
  Region *region = nullptr;                     // nullptr: at rest
  std::vector<deformable::HalfPlane> planes;    // none: a disk
  double x = 0.0, y = 0.0, radius = 0.0;        // of the disk

  bool is_disk() const { return planes.empty(); }
};

// LAMMPS installs only the base class of its regions. The geometry of a plane, block, prism, cylinder or sphere is
// therefore computed from the contacts that the region reports for points near to it and far from it. Returns what
// is wrong with a region that is no such shape, or nothing. (x, y): a point of the system, for planes.
std::string read_shape(Region *, double x, double y, WallShape &);

// The present place of a moving region: of a point of it, and the angle by which it is rotated.
void move_with(Region *, double &x, double &y);
double angle_of_rotation(const Region *);

// The same as numbers, which outlive the step.
struct Motion {
  double x = 0.0, y = 0.0, angle = 0.0;    // the place of what was at the origin, and the rotation

  // How far a point at (px, py) has come since.
  struct Way {
    double x, y;
  };
  Way way_from(const Motion &before, double px, double py) const;
};
Motion motion_of(Region *);

// One wall: a face of a container, the rim of a round container, or an obstacle.
struct WallSource {
  enum Kind { FACE, RIM, DISK, POLYGON } kind;
  std::string name;    // of the region, for messages
  // half planes of shapes; those that face the other way are the outside of a region
  struct Side {
    int shape, plane;
    bool reversed;
  };
  std::vector<Side> sides;    // of a face and of a polygon
  int shape;                  // of a rim and of a disk
};

struct WallSources {
  std::vector<WallShape> shapes;
  std::vector<WallSource> walls;

  // The walls of a region. Returns what is wrong, or nothing.
  std::string read_region(Region *, double x, double y);

  // Walls from words, at rest: plane x y nx ny, circle x y radius, disk x y radius, segment x1 y1 x2 y2,
  // polygon N x1 y1 ... xN yN.
  // Returns what is wrong, or nothing.
  std::string read_words(int narg, char **arg, class LAMMPS *);
  static bool is_word(const std::string &);

 private:
  std::string add(Region *, bool inside, double x, double y);
  std::string add_obstacle(Region *, bool inside, double x, double y);
};

}    // namespace LAMMPS_NS

#endif
