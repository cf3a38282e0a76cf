// Walls that are written as words of the fix, without a region.

#include "convex_polygon.h"
#include "wall_shapes.h"

#include "lammps.h"
#include "utils.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace deformable;

namespace {

// Returns what is wrong with the corners, or nothing.
std::string read_polygon(const std::vector<Point> &corners, WallShape &shape)
{
  Point wrong;
  switch (polygon_planes(corners, shape.planes, wrong)) {
    case Corners::CONVEX: return "";
    case Corners::NOT_CONVEX:
      return fmt::format("is not convex at its corner ({:.6g}, {:.6g}): divide it into convex "
                         "polygons, and leave out corners within its sides",
                         wrong.x, wrong.y);
    default: return "crosses itself: give its corners in the order around it";
  }
}

}    // namespace

/* ---------------------------------------------------------------------- */

bool WallSources::is_word(const std::string &word)
{
  return word == "plane" || word == "circle" || word == "disk" || word == "segment" ||
         word == "polygon";
}

/* ---------------------------------------------------------------------- */

std::string WallSources::read_words(int narg, char **arg, LAMMPS *lmp)
{
  for (int iarg = 0; iarg < narg;) {
    const std::string word = arg[iarg];
    if (!is_word(word))
      return "unknown word '" + word +
             "': it must be 'plane', 'circle', 'disk', 'segment' or 'polygon'";
    const bool round = word == "circle" || word == "disk";
    int first = iarg + 1, values = round ? 3 : 4;
    if (word == "polygon") {
      if (first >= narg) return "polygon: missing its number of corners";
      const int corners = utils::inumeric(FLERR, arg[first++], false, lmp);
      if (corners < 3)
        return fmt::format("polygon: {} corners are too few, give 3 or more", corners);
      values = 2 * corners;
    }
    if (first + values > narg)
      return fmt::format("{} needs {} numbers, but {} follow", word, values, narg - first);
    std::vector<double> value;
    for (int k = 0; k < values; ++k) {
      value.push_back(utils::numeric(FLERR, arg[first + k], false, lmp));
      if (!std::isfinite(value.back())) return word + ": '" + arg[first + k] + "' is not finite";
    }
    iarg = first + values;

    WallShape shape;
    shape.name = fmt::format("{} {}", word, walls.size() + 1);
    std::string problem;
    const Point a = {value[0], value[1]};
    if (round) {
      shape.x = a.x;
      shape.y = a.y;
      shape.radius = value[2];
      if (!(shape.radius > 0.0)) problem = fmt::format("has a radius of {:.6g}", shape.radius);
    } else if (word == "plane") {
      const double nx = value[2], ny = value[3];
      if (nx == 0.0 && ny == 0.0) problem = "has a normal of zero length";
      shape.planes.push_back(left_of(a, {a.x + ny, a.y - nx}));
    } else if (word == "segment") {
      const Point b = {value[2], value[3]};
      if (a.x == b.x && a.y == b.y) problem = "has no length";
      shape.planes = segment_planes(a, b);
    } else {
      std::vector<Point> corners;
      for (int k = 0; k < values; k += 2) corners.push_back({value[k], value[k + 1]});
      problem = read_polygon(corners, shape);
    }
    if (!problem.empty()) return shape.name + " " + problem;

    const int index = static_cast<int>(shapes.size()), n = static_cast<int>(shape.planes.size());
    WallSource wall = {n == 0   ? (word == "disk" ? WallSource::DISK : WallSource::RIM)
                       : n == 1 ? WallSource::FACE
                                : WallSource::POLYGON,
                       shape.name,
                       {},
                       index};
    for (int k = 0; k < n; ++k) wall.sides.push_back({index, k, false});
    walls.push_back(wall);
    shapes.push_back(shape);
  }
  return "";
}
