// The walls of a fix: a scene whose shapes are LAMMPS' regions, words, and sides of the box.

#ifndef DEFORMABLE_WALLS_H
#define DEFORMABLE_WALLS_H

#include "geometry/scene.h"
#include "styles/walls/region_shapes.h"
#include "styles/walls/wall_variable.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

// Where a shape of the scene comes from.
struct WallSource {
  std::string name;
  Region *region = nullptr;           // nullptr: words
  deformable::WallShape at_rest{};    // before the region moves

  // A side of the box: its axis, which one it is (-1 or 1), and its place. Before that is known the side is infinitely far away.
  struct {
    int axis = 0, sign = 0;    // 0: no side
    bool is_edge = false, is_loaded = false;
    WallVariable place{};
  } side{};

  bool moves() const
  {
    return side.is_edge || side.is_loaded || side.place.varies() ||
           (region && region->dynamic_check());
  }
};

// Functions that return a string tell what is wrong, or nothing.
class Walls : public deformable::Scene {
 public:
  explicit Walls(int dimension) : Scene(dimension) {}

  std::vector<WallSource> sources;    // of the shapes

  // The walls of a region: a container, that is an intersection of half spaces, balls and bodies, each of them a wall of its own,
  // and convex obstacles. (x, y): a point of the system.
  std::string read_region(Region *region, double x, double y) { return add(region, true, x, y); }

  // Walls from words: xlo place ... zhi place, where the place is a number, EDGE or v_name. At rest, in the plane: plane x y nx ny,
  // circle x y radius, disk x y radius, segment x1 y1 x2 y2, polygon N x1 y1 ... xN yN. In space: plane x y z nx ny nz, sphere
  // x y z radius, ball x y z radius, cylinder or post x y z ax ay az radius, cone x y z ax ay az radius slope.
  std::string read_words(int narg, char **arg, class LAMMPS *);
  static bool is_word(const std::string &);    // in the plane or in space
  static const char *known_words(int dimension);

  // Sides go where their variables are now; see WallVariable.
  std::string place_sides(class LAMMPS *, bool goes_on);
  // Shapes go where their regions are now; then the scene is computed.
  std::string follow();

 private:
  std::string add(Region *, bool matching, double x, double y);
  std::string add_obstacle(Region *, bool inside, double x, double y);
  std::string check_obstacle(const deformable::Wall &) const;
  std::string add_side(const std::string &word, const std::string &place, class LAMMPS *);
  std::string place_side(int shape, class LAMMPS *);
};

}    // namespace LAMMPS_NS

#endif
