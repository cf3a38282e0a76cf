#include "styles/walls/walls.h"

#include "geometry/mesh_files.h"
#include "styles/all_ranks.h"

#include "domain.h"
#include "info.h"
#include "input.h"
#include "lammps.h"
#include "utils.h"
#include "variable.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>

namespace deformable {

/* ----------------------------------------------------------------------
   Adds the walls of the points that match a region, or of those that do not.
   De Morgan: points in none of several regions are outside of each of them.
------------------------------------------------------------------------- */

std::string Walls::add(Region *region, bool matching, double x, double y)
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
  const std::string problem = read_shape(region, dimension, x, y, shape);
  if (!problem.empty()) return "region '" + name + "' " + problem;
  const int index = static_cast<int>(shapes.size()), n = static_cast<int>(shape.planes.size());
  const bool is_round = shape.is_round();
  if (is_round) walls.push_back({inside ? Wall::RIM : Wall::DISK, name, index, {}});
  if (inside || (n == 1 && !is_round)) {
    for (int k = 0; k < n; ++k) walls.push_back({Wall::FACE, name, index, {{index, k, !inside}}});
  } else if (!is_round) {
    Wall obstacle = {Wall::POLYGON, name, index, {}};
    for (int k = 0; k < n; ++k) obstacle.sides.push_back({index, k, false});
    walls.push_back(obstacle);
  }
  shapes.push_back(shape);
  sources.push_back({name, region, shape});
  return "";
}

/* ----------------------------------------------------------------------
   Particles may be in any of several regions. That is the outside of an
   obstacle if the outsides of these regions intersect in a convex polygon, as
   those of planes that face away from it do.
------------------------------------------------------------------------- */

std::string Walls::add_obstacle(Region *region, bool inside, double x, double y)
{
  const std::string name = region->id;
  const std::size_t first = walls.size();
  for (int n = 0; n < region->nregion; ++n) {
    const std::string problem = add(region->reglist[n], !inside, x, y);
    if (!problem.empty()) return problem;
  }
  Wall obstacle = {Wall::POLYGON, name, 0, {}};
  for (std::size_t w = first; w < walls.size(); ++w) {
    if (walls[w].kind != Wall::FACE)
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
  walls.push_back(obstacle);
  return check_obstacle(obstacle);
}

std::string Walls::check_obstacle(const Wall &obstacle) const
{
  for (const Wall::Side &side : obstacle.sides)
    if (sources[side.shape].region->dynamic_check()) return "";
  if (has_surface(obstacle)) return "";
  return "region '" + obstacle.name + "' has no surface: its parts cover " +
         (dimension == 2 ? "the whole plane" : "all of space") +
         ". An obstacle is a union of planes that face away from it, a container an intersect of "
         "planes";
}

/* ----------------------------------------------------------------------
   Sides of the box.
------------------------------------------------------------------------- */

static bool is_side(const std::string &word)
{
  return word.size() == 3 && word[0] >= 'x' && word[0] <= 'z' &&
         (word.substr(1) == "lo" || word.substr(1) == "hi");
}

std::string Walls::add_side(const std::string &word, const std::string &place, LAMMPS *lmp)
{
  WallSource source = {word};
  const int axis = source.side.axis = word[0] - 'x';
  const double sign = source.side.sign = word[1] == 'l' ? -1 : 1;
  source.side.is_edge = place == "EDGE";
  if (!source.side.is_edge) {
    const std::string problem = source.side.place.read(word, place, lmp);
    if (!problem.empty()) return problem;
  }
  WallShape shape;
  shape.planes = {{{axis == 0 ? sign : 0.0, axis == 1 ? sign : 0.0, axis == 2 ? sign : 0.0}, 0.0}};
  Scene::add(Wall::FACE, word, shape);
  sources.push_back(source);
  return place_side(static_cast<int>(sources.size()) - 1, lmp);
}

std::string Walls::place_side(int shape, LAMMPS *lmp)
{
  auto &side = sources[shape].side;
  if (side.is_edge) {
    if (lmp->domain->triclinic)
      return sources[shape].name +
             " EDGE: a side of a tilted box is no plane across an axis, use 'plane'";
    side.place.now = side.sign < 0 ? lmp->domain->boxlo[side.axis] : lmp->domain->boxhi[side.axis];
  }
  shapes[shape].planes[0].offset =
      side.place.is_known() ? side.sign * side.place.now : std::numeric_limits<double>::infinity();
  return "";
}

std::string Walls::place_sides(LAMMPS *lmp, bool goes_on)
{
  for (std::size_t k = 0; k < sources.size(); ++k) {
    if (sources[k].side.sign == 0) continue;
    std::string problem = sources[k].side.place.begin_step(lmp, goes_on);
    if (problem.empty()) problem = place_side(static_cast<int>(k), lmp);
    if (!problem.empty()) return problem;
  }
  return "";
}

std::string Walls::follow()
{
  motions.resize(shapes.size());
  for (std::size_t k = 0; k < sources.size(); ++k) {
    WallSource &source = sources[k];
    Region *const region = source.region;
    if (shapes[k].mesh) motions[k] = ride;
    if (source.side.sign != 0) component(motions[k].step, source.side.axis) = source.side.place.now;
    if (!region) continue;
    if (dimension == 2 && region->dz != 0.0 && region->moveflag)
      return "region '" + source.name + "' leaves the xy plane: it must not move along z";
    if (region->varshape) {
      const std::string problem = read_shape(region, dimension, 0.0, 0.0, source.at_rest);
      if (!problem.empty()) return "region '" + source.name + "' " + problem;
      if (source.at_rest.planes.size() != shapes[k].planes.size())
        return "region '" + source.name + "' gains or loses a face";
    }
    shapes[k] = moved_with(region, source.at_rest);
    motions[k] = motion_of(region);
  }
  return update();
}

/* ----------------------------------------------------------------------
   Shapes in words.
------------------------------------------------------------------------- */

namespace {

void read_plane_shape(const std::string &word, const std::vector<double> &value, WallShape &shape,
                      std::string &problem)
{
  const Point a = {value[0], value[1]};
  if (word == "circle" || word == "disk") {
    shape.center = {a.x, a.y, 0.0};
    shape.radius = value[2];
    if (!(shape.radius > 0.0)) problem = fmt::format("has a radius of {:.6g}", shape.radius);
  } else if (word == "plane") {
    const double nx = value[2], ny = value[3];
    if (nx == 0.0 && ny == 0.0) problem = "has a normal of zero length";
    shape.set_planes({left_of(a, {a.x + ny, a.y - nx})});
  } else if (word == "segment") {
    const Point b = {value[2], value[3]};
    if (a.x == b.x && a.y == b.y) problem = "has no length";
    shape.set_planes(segment_planes(a, b));
  } else {
    std::vector<Point> corners;
    for (std::size_t k = 0; k < value.size(); k += 2) corners.push_back({value[k], value[k + 1]});
    std::vector<HalfPlane> sides;
    problem = polygon_planes(corners, sides);
    shape.set_planes(sides);
  }
}

void read_space_shape(const std::string &word, const std::vector<double> &value, WallShape &shape,
                      std::string &problem)
{
  const Vector3 a = {value[0], value[1], value[2]};
  if (word == "sphere" || word == "ball") {
    shape.center = a;
    shape.radius = value[3];
  } else {
    const Vector3 given = {value[3], value[4], value[5]};
    const double size = length(given);
    if (!(size > 0.0)) problem = "has a direction of zero length";
    const Vector3 direction = (1.0 / size) * given;
    if (word == "plane") {
      shape.planes.push_back({-direction, -dot(direction, a)});
      return;
    }
    shape.radius = value[6];
    const double slope = word == "cone" ? value[7] : 0.0;
    if (word == "cone" && slope == 0.0) problem = "has a slope of 0: use 'cylinder'";
    shape.set_body({a, direction, cone_side(shape.radius, slope), {}});
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

static bool is_mesh(const std::string &word)
{
  return word == "surface" || word == "room";
}

bool Walls::is_word(const std::string &word)
{
  return find_word(word) || is_side(word) || is_mesh(word);
}

const char *Walls::known_words(int dimension)
{
  return dimension == 2
             ? "'plane', 'circle', 'disk', 'segment', 'polygon', 'surface', 'room', or a side "
               "'xlo' to 'yhi'"
             : "'plane', 'sphere', 'cylinder', 'cone', 'ball', 'post', 'surface', 'room', or a "
               "side "
               "'xlo' to 'zhi'";
}

// A chain of points in the plane, triangles in space: from a file, or as many numbers as follow.
std::string Walls::read_mesh(const std::string &label, const std::string &file,
                             const std::vector<double> &value, bool is_room, LAMMPS *lmp)
{
  std::vector<Vector3> points;
  std::string bytes, problem;
  const std::string name = file.empty() ? label : label + ", file '" + file + "',";
  if (file.empty()) {
    for (std::size_t k = 0; k < value.size(); k += dimension)
      points.push_back({value[k], value[k + 1], dimension == 3 ? value[k + 2] : 0.0});
  } else if (!read_file(lmp, file, bytes)) {
    return name + " cannot be opened: " + utils::getsyserror();
  } else {
    problem = dimension == 2 ? read_chain(bytes, points) : read_stl(bytes, points);
  }
  if (dimension == 2) points = segments_of(points, is_room);
  const auto mesh = std::make_shared<Mesh>();
  if (problem.empty())
    problem = mesh->build(dimension, points, is_room, dimension == 2 ? "segment" : "triangle");
  if (!problem.empty()) return name + " " + problem;
  WallShape shape;
  shape.mesh = mesh;
  Scene::add(is_room ? Wall::ROOM : Wall::SURFACE, label, shape);
  sources.push_back({label});
  return "";
}

std::string Walls::read_words(int narg, char **arg, LAMMPS *lmp)
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
    std::string file;
    if (is_mesh(name)) {
      const std::string what = dimension == 2 ? "points" : "triangles";
      if (first == narg) return name + " needs a file, or a number of " + what;
      if (utils::is_integer(arg[first])) {
        const int rows = utils::inumeric(FLERR, arg[first++], false, lmp), least = 4 - dimension;
        if (rows < least)
          return fmt::format("{}: {} {} are too few, give {} or more", name, rows, what, least);
        values = std::min(rows, narg) * (dimension == 2 ? 2 : 9);
      } else {
        file = arg[first++];
      }
    } else if (values == 0)
      return (is_word(name) ? fmt::format("'{}' is no wall in {} dimensions", name, dimension)
                            : "unknown word '" + name + "'") +
             ": it must be " + known_words(dimension) + ", and after them 'shear', 'load'" +
             (dimension == 2 ? " or 'adhesion'" : "");
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
    const std::string label = fmt::format("{} {}", name, walls.size() + 1);
    std::string problem;
    if (is_mesh(name)) {
      problem = read_mesh(label, file, value, name == "room", lmp);
      if (!problem.empty()) return problem;
      continue;
    }
    (dimension == 2 ? read_plane_shape : read_space_shape)(name, value, shape, problem);
    if (!problem.empty()) return label + " " + problem;
    Scene::add(shape.is_round()           ? (word->is_obstacle ? Wall::DISK : Wall::RIM)
               : shape.planes.size() == 1 ? Wall::FACE
                                          : Wall::POLYGON,
               label, shape);
    sources.push_back({label});
  }
  return "";
}

namespace {

// Thermo keywords, functions and vectors that need forces, energies or temperatures.
const char *const STATE[] = {
    "temp",    "press",     "pe",     "ke",   "etotal", "evdwl", "ecoul", "epair",
    "ebond",   "eangle",    "edihed", "eimp", "emol",   "elong", "etail", "enthalpy",
    "ecouple", "econserve", "pxx",    "pyy",  "pzz",    "pxy",   "pxz",   "pyz",
    "fmax",    "fnorm",     "fx",     "fy",   "fz",     "fcm",   "torque"};

// Whether a variable, or one that it names, uses any of them, a compute or a fix.
bool uses_state(const std::string &name, LAMMPS *lmp, std::set<std::string> &seen)
{
  const int found = lmp->input->variable->find(name.c_str());
  if (found < 0 || !seen.insert(name).second) return false;
  const std::string text = Info(lmp).get_variable_info(found);
  const auto in_word = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
  auto at = text.begin() + static_cast<std::ptrdiff_t>(std::min(text.find("def ="), text.size()));
  while (at != text.end()) {
    const auto end = std::find_if_not(at, text.end(), in_word);
    const std::string word(at, end), kind = word.substr(0, 2);
    if (kind == "c_" || kind == "C_" || kind == "f_" || kind == "F_" ||
        std::find(std::begin(STATE), std::end(STATE), word) != std::end(STATE))
      return true;
    if (kind == "v_" && uses_state(word.substr(2), lmp, seen)) return true;
    at = std::find_if(end, text.end(), in_word);
  }
  return false;
}

}    // namespace

std::string WallVariable::read(const std::string &its_name, const std::string &word, LAMMPS *lmp)
{
  what = its_name;
  if (utils::strmatch(word, "^v_.")) {
    name = word.substr(2);
    return init(lmp);
  }
  now = utils::numeric(FLERR, word, false, lmp);
  return is_known() ? "" : what + ": '" + word + "' is not finite";
}

std::string WallVariable::init(LAMMPS *lmp)
{
  if (!varies()) return "";
  Variable &variables = *lmp->input->variable;
  const int found = variables.find(name.c_str());
  if (found < 0) return what + ": variable '" + name + "' does not exist";
  if (!variables.equalstyle(found)) return what + ": variable '" + name + "' must be equal-style";
  std::set<std::string> seen;
  of_state = uses_state(name, lmp, seen);
  return "";
}

std::string WallVariable::evaluate(LAMMPS *lmp, double &value) const
{
  Variable &variables = *lmp->input->variable;
  const int found = variables.find(name.c_str());
  if (found < 0) return what + ": variable '" + name + "' does not exist";
  value = variables.compute_equal(found);
  return std::isfinite(value) ? "" : fmt::format("{}: its value 'v_{}' is {}", what, name, value);
}

std::string WallVariable::begin_step(LAMMPS *lmp, bool goes_on)
{
  if (!varies()) return "";
  if (!of_state) return evaluate(lmp, now);
  if (goes_on || !is_known()) now = next;
  return "";
}

std::string WallVariable::end_step(LAMMPS *lmp)
{
  return of_state ? evaluate(lmp, next) : "";
}

}    // namespace deformable
