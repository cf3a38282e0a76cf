// Walls that are written as words of the fix, without a region.

#include "wall_shapes.h"

#include "lammps.h"
#include "utils.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace {

struct Point {
  double x, y;
};

// The half plane to the left of the line from a to b.
deformable::HalfPlane left_of(Point a, Point b)
{
  const double dx = b.x - a.x, dy = b.y - a.y, length = std::hypot(dx, dy);
  const double nx = dy / length, ny = -dx / length;
  return {nx, ny, nx * a.x + ny * a.y};
}

// Twice the area of a triangle, positive if its corners come counterclockwise.
double turn(Point a, Point b, Point c)
{
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Corners in either order. Returns what is wrong, or nothing.
std::string read_polygon(std::vector<Point> corners, WallShape &shape)
{
  const int n = static_cast<int>(corners.size());
  double area = 0.0;
  for (int k = 2; k < n; ++k) area += turn(corners[0], corners[k - 1], corners[k]);
  if (area < 0.0) std::reverse(corners.begin(), corners.end());
  double angle = 0.0;    // that the sides turn by altogether: more than once around in a star
  for (int k = 0; k < n; ++k) {
    const Point a = corners[k], b = corners[(k + 1) % n], c = corners[(k + 2) % n];
    const double sine = turn(a, b, c);
    const double cosine = (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y);
    if (!(sine > 0.0))
      return fmt::format("is not convex at its corner ({:.6g}, {:.6g}): divide it into convex "
                         "polygons, and leave out corners within its sides",
                         b.x, b.y);
    angle += std::atan2(sine, cosine);
    shape.planes.push_back(left_of(a, b));
  }
  return angle < 7.0 ? "" : "crosses itself: give its corners in the order around it";
}

}    // namespace

/* ---------------------------------------------------------------------- */

bool WallSources::is_word(const std::string &word)
{
  return word == "plane" || word == "disk" || word == "segment" || word == "polygon";
}

/* ---------------------------------------------------------------------- */

std::string WallSources::read_words(int narg, char **arg, LAMMPS *lmp)
{
  for (int iarg = 0; iarg < narg;) {
    const std::string word = arg[iarg];
    if (!is_word(word))
      return "unknown word '" + word + "': it must be 'plane', 'disk', 'segment' or 'polygon'";
    int first = iarg + 1, values = word == "disk" ? 3 : 4;
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
    if (word == "disk") {
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
      const Point up = {a.y - b.y, b.x - a.x};
      shape.planes = {left_of(a, b), left_of(b, {b.x + up.x, b.y + up.y}), left_of(b, a),
                      left_of({a.x + up.x, a.y + up.y}, a)};
      // the same line from both sides, whatever the rounding
      shape.planes[2] = {-shape.planes[0].nx, -shape.planes[0].ny, -shape.planes[0].offset};
    } else {
      std::vector<Point> corners;
      for (int k = 0; k < values; k += 2) corners.push_back({value[k], value[k + 1]});
      problem = read_polygon(corners, shape);
    }
    if (!problem.empty()) return shape.name + " " + problem;

    const int index = static_cast<int>(shapes.size()), n = static_cast<int>(shape.planes.size());
    WallSource wall = {n == 0   ? WallSource::DISK
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
