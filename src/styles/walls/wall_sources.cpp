// Which walls a region is: a container, that is an intersection of half planes and disks, each of them a wall of
// its own, and convex obstacles.

#include "styles/walls/wall_shapes.h"

#include "lammps.h"
#include "utils.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace deformable;

/* ---------------------------------------------------------------------- */

std::string WallSources::read_region(Region *region, double x, double y)
{
  shapes.clear();
  walls.clear();
  return add(region, true, x, y);
}

/* ----------------------------------------------------------------------
   Adds the walls of the points that match a region, or of those that do not.
   De Morgan: points in none of several regions are outside of each of them.
------------------------------------------------------------------------- */

std::string WallSources::add(Region *region, bool matching, double x, double y)
{
  const bool inside = matching == (region->interior != 0);
  const std::string name = region->id;
  if (region->reglist) {
    const bool is_union = std::string(region->style) == "union";
    if (is_union == inside) return add_obstacle(region, inside, x, y);
    for (int n = 0; n < region->nregion; ++n) {
      std::string problem = add(region->reglist[n], inside, x, y);
      if (!problem.empty()) return problem;
    }
    return "";
  }

  WallShape shape;
  shape.name = name;
  const std::string problem =
      dimension == 2 ? read_shape(region, x, y, shape) : read_solid(region, shape);
  if (!problem.empty()) return "region '" + name + "' " + problem;
  const int index = static_cast<int>(shapes.size()), n = shape.faces();
  const bool is_round = shape.is_round();
  if (is_round) walls.push_back({inside ? WallSource::RIM : WallSource::DISK, name, {}, index});
  if (inside || (n == 1 && !is_round)) {
    for (int k = 0; k < n; ++k)
      walls.push_back({WallSource::FACE, name, {{index, k, !inside}}, index});
  } else if (!is_round) {
    WallSource obstacle = {WallSource::POLYGON, name, {}, index};
    for (int k = 0; k < n; ++k) obstacle.sides.push_back({index, k, false});
    walls.push_back(obstacle);
  }
  shapes.push_back(shape);
  return "";
}

/* ----------------------------------------------------------------------
   Particles may be in any of several regions. That is the outside of an
   obstacle if the outsides of these regions intersect in a convex polygon, as
   those of planes that face away from it do.
------------------------------------------------------------------------- */

std::string WallSources::add_obstacle(Region *region, bool inside, double x, double y)
{
  const std::string name = region->id;
  const std::size_t first = walls.size();
  for (int n = 0; n < region->nregion; ++n) {
    const std::string problem = add(region->reglist[n], !inside, x, y);
    if (!problem.empty()) return problem;
  }
  WallSource obstacle = {WallSource::POLYGON, name, {}, 0};
  for (std::size_t w = first; w < walls.size(); ++w) {
    if (walls[w].kind != WallSource::FACE)
      return "region '" + name +
             "' is neither a container nor a convex obstacle: particles could be in part '" +
             walls[w].name +
             "' or in another part of it. Write a container as an intersect of planes, blocks and "
             "prisms, an obstacle as a union of planes that face away from it or as a block, "
             "prism, cylinder or sphere with 'side out', and several of these as an intersect, or "
             "each in a fix of its own";
    obstacle.sides.push_back(walls[w].sides[0]);
  }
  walls.erase(walls.begin() + first, walls.end());
  const std::string problem = check_obstacle(obstacle);
  walls.push_back(obstacle);
  return problem;
}

/* ---------------------------------------------------------------------- */

std::string WallSources::check_obstacle(const WallSource &obstacle) const
{
  std::vector<HalfPlane> planes;
  std::vector<HalfSpace> spaces;
  for (const WallSource::Side &side : obstacle.sides) {
    const WallShape &shape = shapes[side.shape];
    if (shape.region->dynamic_check()) return "";
    const double sign = side.reversed ? -1.0 : 1.0;
    if (dimension == 2) {
      const HalfPlane &plane = shape.planes[side.plane];
      planes.push_back({sign * plane.nx, sign * plane.ny, sign * plane.offset});
    } else {
      const HalfSpace &space = shape.spaces[side.plane];
      spaces.push_back({sign * space.n, sign * space.offset});
    }
  }
  std::vector<Edge> edges(planes.size());
  const int n = static_cast<int>(obstacle.sides.size());
  if (dimension == 2 ? intersect(planes.data(), n, edges.data()) : meet(spaces.data(), n))
    return "";
  return "region '" + obstacle.name + "' has no surface: its parts cover " +
         (dimension == 2 ? "the whole plane" : "all of space") +
         ". An obstacle is a union of planes that face away from it, a container an intersect of "
         "planes";
}
