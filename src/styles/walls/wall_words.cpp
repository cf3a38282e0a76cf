// Walls that are written as words of the fix, without a region.

#include "geometry/convex_polygon.h"
#include "laws/vector3.h"
#include "styles/walls/wall_shapes.h"

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

void read_plane_shape(const std::string &word, const std::vector<double> &value, WallShape &shape,
                      std::string &problem)
{
  const Point a = {value[0], value[1]};
  if (word == "circle" || word == "disk") {
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
    for (std::size_t k = 0; k < value.size(); k += 2) corners.push_back({value[k], value[k + 1]});
    problem = read_polygon(corners, shape);
  }
}

void read_space_shape(const std::string &word, const std::vector<double> &value, WallShape &shape,
                      std::string &problem)
{
  const Vector3 a = {value[0], value[1], value[2]};
  if (word == "sphere" || word == "ball") {
    shape.x = a.x;
    shape.y = a.y;
    shape.z = a.z;
    shape.radius = value[3];
  } else {
    const Vector3 given = {value[3], value[4], value[5]};
    const double size = length(given);
    if (!(size > 0.0)) problem = "has a direction of zero length";
    const Vector3 direction = (1.0 / size) * given;
    if (word == "plane") {
      shape.spaces.push_back({-direction, -dot(direction, a)});
      return;
    }
    shape.is_body = true;
    shape.radius = value[6];
    shape.body.center = a;
    shape.body.axis = direction;
    const double slope = word == "cone" ? value[7] : 0.0;
    if (word == "cone" && slope == 0.0) problem = "has a slope of 0: use 'cylinder'";
    shape.body.side = cone_side(shape.radius, slope);
  }
  if (!(shape.radius > 0.0)) problem = fmt::format("has a radius of {:.6g}", shape.radius);
}

// The words of walls, and how many numbers follow: in the plane, and in space.
struct Word {
  const char *name;
  int numbers[2];
  bool is_obstacle;
};
constexpr Word WORDS[] = {
    {"plane", {4, 6}, false},  {"circle", {3, 0}, false}, {"disk", {3, 0}, true},
    {"segment", {4, 0}, true}, {"polygon", {1, 0}, true},    // and as many corners
    {"sphere", {0, 4}, false}, {"ball", {0, 4}, true},    {"cylinder", {0, 7}, false},
    {"cone", {0, 8}, false},   {"post", {0, 7}, true}};

const Word *find_word(const std::string &name)
{
  for (const Word &word : WORDS)
    if (name == word.name) return &word;
  return nullptr;
}

}    // namespace

/* ---------------------------------------------------------------------- */

bool WallSources::is_word(const std::string &word)
{
  return find_word(word) || is_side(word);
}

const char *WallSources::known_words(int dimension)
{
  return dimension == 2
             ? "'plane', 'circle', 'disk', 'segment', 'polygon', or a side 'xlo' to 'yhi'"
             : "'plane', 'sphere', 'cylinder', 'cone', 'ball', 'post', or a side 'xlo' to 'zhi'";
}

/* ---------------------------------------------------------------------- */

std::string WallSources::read_words(int narg, char **arg, LAMMPS *lmp)
{
  for (int iarg = 0; iarg < narg;) {
    const std::string name = arg[iarg];
    const Word *const word = find_word(name);
    if (is_side(name) && (dimension == 3 || name[0] != 'z')) {
      if (iarg + 1 == narg) return name + " needs its place: a number, EDGE or v_name";
      const std::string problem = add_side(name, arg[iarg + 1], lmp);
      if (!problem.empty()) return problem;
      iarg += 2;
      continue;
    }
    int first = iarg + 1, values = word ? word->numbers[dimension - 2] : 0;
    if (values == 0)
      return (is_word(name) ? fmt::format("'{}' is no wall in {} dimensions", name, dimension)
                            : "unknown word '" + name + "'") +
             ": it must be " + known_words(dimension);
    if (name == "polygon") {
      if (first >= narg) return "polygon: missing its number of corners";
      const int corners = utils::inumeric(FLERR, arg[first++], false, lmp);
      if (corners < 3)
        return fmt::format("polygon: {} corners are too few, give 3 or more", corners);
      values = 2 * corners;
    }
    if (first + values > narg)
      return fmt::format("{} needs {} numbers, but {} follow", name, values, narg - first);
    std::vector<double> value;
    for (int k = 0; k < values; ++k) {
      value.push_back(utils::numeric(FLERR, arg[first + k], false, lmp));
      if (!std::isfinite(value.back())) return name + ": '" + arg[first + k] + "' is not finite";
    }
    iarg = first + values;

    WallShape shape;
    shape.name = fmt::format("{} {}", name, walls.size() + 1);
    std::string problem;
    (dimension == 2 ? read_plane_shape : read_space_shape)(name, value, shape, problem);
    if (!problem.empty()) return shape.name + " " + problem;

    const int index = static_cast<int>(shapes.size()), n = shape.faces();
    WallSource wall = {n == 0   ? (word->is_obstacle ? WallSource::DISK : WallSource::RIM)
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
