// The walls of a fix: a scene whose shapes are LAMMPS' regions, words, and sides of the box.

#ifndef DEFORMABLE_WALLS_H
#define DEFORMABLE_WALLS_H

#include "geometry/scene.h"
#include "styles/lammps_names.h"

#include "region.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace deformable {

// LAMMPS installs only the base class of its regions. The geometry of a plane, block, prism, cylinder, cone (in space) or sphere
// is therefore computed from the contacts that the region reports for points near to it and far from it, before it moves, and
// whatever its `side` is. Returns what is wrong with a region that is no such shape, or nothing. (x, y): a point of the system, for
// planes.
std::string read_shape(Region *, int dimension, double x, double y, WallShape &);

// A shape that moves with its region. LAMMPS rotates it about a point first, then it moves it.
WallShape moved_with(Region *, const WallShape &);
Motion motion_of(Region *);

// A number of a wall, or an equal-style variable: its place, its speed, its load.
//
// Walls are placed before the forces of a step are computed. A variable of the time is evaluated there. What computes, fixes
// and thermo keywords tell is complete at the end of a step only: a variable that uses them is evaluated there, and holds in
// the next step. Before the first run it has no value.
class WallVariable {
 public:
  // A number or v_name, for `what` in messages. Each of these functions returns what is wrong, or nothing.
  std::string read(const std::string &what, const std::string &word, LAMMPS *);
  std::string init(LAMMPS *);
  // `goes_on`: a step of a run, not its setup or a minimization, which keep what was known at the end of the step before.
  std::string begin_step(LAMMPS *, bool goes_on);
  std::string end_step(LAMMPS *);    // between clearstep_compute and addstep_compute

  bool varies() const { return !name.empty(); }
  bool waits() const { return of_state; }    // for the end of a step
  bool is_known() const { return std::isfinite(now); }

  double now = std::numeric_limits<double>::quiet_NaN();

 private:
  std::string what, name;
  bool of_state = false;
  double next = std::numeric_limits<double>::quiet_NaN();

  std::string evaluate(LAMMPS *, double &value) const;
};

// Where a shape of the scene comes from.
struct WallSource {
  std::string name;
  Region *region = nullptr;    // nullptr: words
  WallShape at_rest{};         // before the region moves

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
class Walls : public Scene {
 public:
  explicit Walls(int dimension) : Scene(dimension) {}

  std::vector<WallSource> sources;    // of the shapes

  // The walls of a region: a container, that is an intersection of half spaces, balls and bodies, each of them a wall of its own,
  // and convex obstacles. (x, y): a point of the system.
  std::string read_region(Region *region, double x, double y) { return add(region, true, x, y); }

  // Walls from words: xlo place ... zhi place, where the place is a number, EDGE or v_name. At rest, in the plane: plane x y nx ny,
  // circle x y radius, disk x y radius, segment x1 y1 x2 y2, polygon N x1 y1 ... xN yN. In space: plane x y z nx ny nz, sphere
  // x y z radius, ball x y z radius, cylinder or post x y z ax ay az radius, cone x y z ax ay az radius slope. Outlines that move
  // as `ride` says: surface or room, and a file, or N and the numbers of so many points or triangles.
  std::string read_words(int narg, char **arg, LAMMPS *);
  static bool is_word(const std::string &);    // in the plane or in space
  static const char *known_words(int dimension);

  Motion ride;    // of all meshes

  // Sides go where their variables are now; see WallVariable.
  std::string place_sides(LAMMPS *, bool goes_on);
  // Shapes go where their regions are now; then the scene is computed.
  std::string follow();

 private:
  std::string add(Region *, bool matching, double x, double y);
  std::string add_obstacle(Region *, bool inside, double x, double y);
  std::string check_obstacle(const Wall &) const;
  std::string read_mesh(const std::string &label, const std::string &file,
                        const std::vector<double> &value, bool is_room, LAMMPS *);
  std::string add_side(const std::string &word, const std::string &place, LAMMPS *);
  std::string place_side(int shape, LAMMPS *);
};

}    // namespace deformable

#endif
