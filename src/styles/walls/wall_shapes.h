// The shapes that walls are made of, read from LAMMPS' regions.

#ifndef DEFORMABLE_WALL_SHAPES_H
#define DEFORMABLE_WALL_SHAPES_H

#include "geometry/obstacle.h"
#include "geometry/surface.h"
#include "styles/walls/wall_variable.h"

#include "region.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// A convex set of points. In the plane of the particles: half planes that intersect, or a disk. In space: half spaces, a ball,
// or a body around an axis, whose ends are half spaces too. Given in the frame of its region, before the region moves. It does
// not depend on `side`.
struct WallShape {
  std::string name;
  Region *region = nullptr;                     // nullptr: at rest
  std::vector<deformable::HalfPlane> planes;    // none: a disk
  double x = 0.0, y = 0.0, radius = 0.0;        // of the disk, or of the ball

  std::vector<deformable::HalfSpace> spaces;
  double z = 0.0;
  bool is_body = false;
  deformable::Revolution body{};

  // A side of the box: its axis, which one it is (-1 or 1), and its place. Before that is known the side is infinitely far away.
  struct {
    int axis = 0, sign = 0;    // 0: no side
    bool is_edge = false, is_loaded = false;
    WallVariable place;
  } side;
  std::string place_side(class LAMMPS *);    // returns what is wrong, or nothing
  bool moves() const
  {
    return side.is_edge || side.is_loaded || side.place.varies() ||
           (region && region->dynamic_check());
  }

  int faces() const { return static_cast<int>(planes.size() + spaces.size()); }
  bool is_round() const { return is_body || faces() == 0; }
};

// LAMMPS installs only the base class of its regions. The geometry of a plane, block, prism, cylinder or sphere is
// therefore computed from the contacts that the region reports for points near to it and far from it. Returns what
// is wrong with a region that is no such shape, or nothing. (x, y): a point of the system, for planes.
std::string read_shape(Region *, double x, double y, WallShape &);

// The same in space, where cones have a shape, too.
std::string read_solid(Region *, WallShape &);

// The present place of a moving region: of a point of it, and the angle by which it is rotated.
void move_with(Region *, double &x, double &y);
deformable::Vector3 moved_with(Region *, deformable::Vector3);
double angle_of_rotation(const Region *);

// The same as numbers, which outlive the step; also of a side.
struct Motion {
  double x = 0.0, y = 0.0, angle = 0.0;    // the place of what was at the origin, and the rotation

  // How far a point at (px, py) has come since.
  struct Way {
    double x, y;
  };
  Way way_from(const Motion &before, double px, double py) const;
};
Motion motion_of(const WallShape &);

// One wall: a face of a container, the rim of a round container, or an obstacle (round, or with faces).
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

// A center that a wall refuses: it is there at this height. Or the wall is a round container, and narrower than the particle: then
// it would have one contact where there is a ring of them, and none on the axis.
struct RefusedCenter {
  int wall;    // -1: none
  double height;
  double room = 0.0;    // if it is too narrow: its radius, where the particle is
};

struct WallSources {
  int dimension = 2;
  std::vector<WallShape> shapes;
  std::vector<WallSource> walls;
  bool slide = false;    // along themselves
  bool move() const;
  std::string place_sides(class LAMMPS *, bool goes_on);    // see WallVariable

  // The walls of a region. Returns what is wrong, or nothing.
  std::string read_region(Region *, double x, double y);

  // Walls from words: xlo place ... zhi place, of which EDGE and v_name may move. At rest, in the plane: plane x y nx ny, circle
  // x y radius, disk x y radius, segment x1 y1 x2 y2, polygon N x1 y1 ... xN yN. In space: plane x y z nx ny nz, sphere x y z
  // radius, ball x y z radius, cylinder or post x y z ax ay az radius, cone x y z ax ay az radius slope. Returns what is wrong,
  // or nothing.
  std::string read_words(int narg, char **arg, class LAMMPS *);
  static bool is_word(const std::string &);    // in the plane or in space
  static const char *known_words(int dimension);

 private:
  std::string add(Region *, bool inside, double x, double y);
  static bool is_side(const std::string &word);
  std::string add_side(const std::string &word, const std::string &place, class LAMMPS *);
  std::string add_obstacle(Region *, bool inside, double x, double y);
  std::string check_obstacle(const WallSource &) const;
};

}    // namespace LAMMPS_NS

#endif
