#include "geometry/scene.h"

#include <algorithm>
#include <limits>
#include <map>

namespace deformable {

static constexpr int MOST_FEATURES = 1 << 23;    // see wall_code
static constexpr double INFINITE = std::numeric_limits<double>::infinity();

void WallShape::set_planes(const std::vector<HalfPlane> &given)
{
  for (const HalfPlane &plane : given) planes.push_back({{plane.nx, plane.ny, 0.0}, plane.offset});
}

static bool section(const std::vector<HalfSpace> &planes, std::vector<Edge> &edges)
{
  std::vector<HalfPlane> lines;
  for (const HalfSpace &plane : planes) lines.push_back({plane.n.x, plane.n.y, plane.offset});
  return intersect(lines, edges);
}

void WallShape::set_body(const Revolution &given)
{
  is_body = true;
  body = given;
  std::vector<HalfPlane> lines = {body.side};
  for (const HalfSpace &end : planes)
    lines.push_back({0.0, dot(end.n, body.axis), end.offset - dot(end.n, body.center)});
  intersect(lines, body.section);
}

void Scene::add(Wall::Kind kind, const std::string &name, const WallShape &shape)
{
  const int index = static_cast<int>(shapes.size()), sides = static_cast<int>(shape.planes.size());
  Wall wall = {kind, name, index, {}};
  for (int k = 0; k < sides && !shape.is_round(); ++k) wall.sides.push_back({index, k, false});
  walls.push_back(wall);
  shapes.push_back(shape);
}

std::string Scene::update()
{
  const bool is_first = present.size() != walls.size();
  motions.resize(shapes.size());
  present.resize(walls.size());
  int features = 0;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const Wall &wall = walls[w];
    Present &now = present[w];
    now.kind = wall.kind;
    now.first_feature = features;
    now.features = 1;
    if (wall.kind == Wall::FACE) {
      now.face = side_of(wall.sides[0]);
    } else if (wall.kind == Wall::POLYGON) {
      now.planes = sides_of(wall);
      if (dimension == 2) now.features = 3 * static_cast<int>(wall.sides.size());
      if (dimension == 2 ? !find_corners(now) : !meet(now.planes))
        return "obstacle '" + wall.name + "' has no surface: its planes leave nothing of it";
      if (dimension == 3) find_ends(now);
    } else if (shapes[wall.shape].mesh) {
      place_mesh(shapes[wall.shape], motions[wall.shape], now);
    } else {
      place_body(shapes[wall.shape], now);
    }
    features += now.features;
  }
  if (features > MOST_FEATURES)
    return "walls with " + std::to_string(features) + " faces, edges and corners are too many, " +
           std::to_string(MOST_FEATURES) +
           " can be told apart: use coarser meshes, or several fixes";
  if (is_first) {
    before = present;
    motions_before = motions;
  }
  return "";
}

HalfSpace Scene::side_of(const Wall::Side &side) const
{
  const HalfSpace &plane = shapes[side.shape].planes[side.plane];
  return side.reversed ? HalfSpace{-plane.n, -plane.offset} : plane;
}

std::vector<HalfSpace> Scene::sides_of(const Wall &wall) const
{
  std::vector<HalfSpace> sides;
  for (const Wall::Side &side : wall.sides) sides.push_back(side_of(side));
  return sides;
}

bool Scene::has_surface(const Wall &obstacle) const
{
  std::vector<Edge> edges;
  return dimension == 2 ? section(sides_of(obstacle), edges) : meet(sides_of(obstacle));
}

// A disk, a ball, or a body around an axis.
void Scene::place_body(const WallShape &shape, Present &now)
{
  now.is_body = shape.is_body;
  if (now.is_body) {
    now.body = shape.body;
    now.middle = {};
    if (now.kind == Wall::DISK) find_ends(now);
  } else {
    now.middle = shape.center;
    now.radius = shape.radius;
    now.half = {shape.radius, shape.radius, shape.radius};
  }
}

// A mesh, and a box around it.
void Scene::place_mesh(const WallShape &shape, const Motion &place, Present &now)
{
  now.mesh = shape.mesh;
  now.place = place;
  now.features = shape.mesh->features();
  const Vector3 half = 0.5 * (shape.mesh->high - shape.mesh->low);
  now.middle = place.moved(shape.mesh->low + half);
  now.half = {};
  for (int axis = 0; axis < 3; ++axis) {
    Vector3 edge = {};
    component(edge, axis) = component(half, axis);
    edge = place.turned(edge);
    now.half = now.half + Vector3{std::fabs(edge.x), std::fabs(edge.y), std::fabs(edge.z)};
  }
}

// The circle around a polygon, about the middle of its corners. Returns false if nothing is left of it.
bool Scene::find_corners(Present &now)
{
  if (!section(now.planes, now.edges)) return false;
  now.middle = {};
  now.half = {INFINITE, INFINITE, INFINITE};
  double x = 0.0, y = 0.0, square = 0.0;
  int n = 0;
  for (const Edge &edge : now.edges) {
    if (!edge.bounds()) continue;
    if (!edge.ends()) return true;
    x += edge.at(edge.high).x;
    y += edge.at(edge.high).y;
    ++n;
  }
  now.middle = {x / n, y / n, 0.0};
  for (const Edge &edge : now.edges)
    for (const double end : {edge.low, edge.high}) {
      const Vector3 to = Vector3{edge.at(end).x, edge.at(end).y, 0.0} - now.middle;
      if (edge.bounds()) square = std::max(square, dot(to, to));
    }
  const double radius = std::sqrt(square);
  now.half = {radius, radius, radius};
  return true;
}

// How far a convex body in space reaches: where it is nearest to a point far away, then to points in front of that, where
// less is lost to rounding. So bodies may have any size.
void Scene::find_ends(Present &now)
{
  now.middle = {};
  const auto end_along = [&now](const Vector3 &axis) {
    constexpr double AWAY[] = {1e9, 1.0, 1e-6}, ENDLESS = 1e6;
    Vector3 foot = {};
    for (const double distance : AWAY) {
      const Vector3 x = foot + distance * axis;
      int feature = 0;
      const SurfacePoint point = nearest_point(now, x, feature);
      if (!(point.height > 0.0)) return INFINITE;
      foot = x + point.height * point.n;
    }
    const double end = dot(axis, foot);
    return std::fabs(end) < ENDLESS ? end : INFINITE;
  };
  const auto find = [&](const Vector3 &axis, double &middle, double &half) {
    const double high = end_along(axis), low = -end_along(-axis);
    half = 0.5 * (high - low);
    middle = std::isfinite(half) ? 0.5 * (low + high) : 0.0;
  };
  Vector3 middle = {};
  find({1, 0, 0}, middle.x, now.half.x);
  find({0, 1, 0}, middle.y, now.half.y);
  find({0, 0, 1}, middle.z, now.half.z);
  now.middle = middle;
}

int Scene::first_outside(int axis, double low, double high) const
{
  const bool any_face = std::any_of(walls.begin(), walls.end(),
                                    [](const Wall &wall) { return wall.kind == Wall::FACE; });
  for (const Present &wall : present) {
    const double n = component(wall.face.n, axis), offset = wall.face.offset;
    if (wall.kind == Wall::FACE && std::fabs(n) == 1.0 && std::isfinite(offset) &&
        (n > 0.0 ? offset > high : -offset < low))
      return index_of(wall);
    const double middle = component(wall.middle, axis);
    if (any_face || wall.is_body || (wall.kind != Wall::RIM && wall.kind != Wall::ROOM)) continue;
    const double half = wall.mesh ? component(wall.half, axis) : wall.radius;
    if (middle - half < low || middle + half > high) return index_of(wall);
  }
  return -1;
}

SurfacePoint Scene::nearest_point(const Present &wall, const Vector3 &from, int &feature)
{
  const Vector3 x = wall.middle + from;
  if (wall.kind == Wall::FACE) return nearest_on_plane(wall.face, x);
  if (wall.mesh) return wall.place.moved(wall.mesh->nearest(wall.place.moved_back(x)).point);
  if (wall.kind == Wall::POLYGON) {
    if (wall.edges.empty()) return nearest_on_polyhedron(wall.planes, x);
    const NearestPoint found = nearest_on_polygon(wall.edges, x.x, x.y);
    feature += found.feature;
    return {{found.nx, found.ny, 0.0}, found.height, found.turn, 0.0, {}};
  }
  const bool inside = wall.kind == Wall::RIM;
  if (!wall.is_body) return nearest_on_sphere(-from, wall.radius, inside);
  return inside ? nearest_on_side(wall.body, x) : nearest_on_revolution(wall.body, x);
}

SurfacePoint Scene::nearest_point(int wall, const Vector3 &x) const
{
  const Present &now = present[wall];
  Vector3 from = x - now.middle;
  for (int axis = 2; axis >= 0 && now.is_obstacle(); --axis) {
    const double length = component(period[axis], axis);
    if (length > 0.0 && std::isfinite(component(now.half, axis)))
      from = from - std::rint(component(from, axis) / length) * period[axis];
  }
  int feature = 0;
  return nearest_point(now, from, feature);
}

void Scene::add_force(int feature, const Vector3 &x, double force, const Vector3 &torque,
                      double cutoff)
{
  const int index = wall_of(feature);
  const Present &wall = present[index];
  Vector3 from = x - wall.middle;
  approach(wall, cutoff, from);
  int part = -1;
  if (wall.mesh)
    for (const Mesh::Contact &contact : wall.contacts_at(wall.middle + from, cutoff))
      if (wall.first_feature + contact.feature == feature) part = contact.part;
  loads.push_back({index, part, wall.middle + from, force, torque});
}

// Its change, as walls move, is that of the energy of the particles.
double Scene::potential(const std::vector<Present> &at) const
{
  double sum = 0.0;
  for (const Load &load : loads) {
    int feature = 0;
    const Present &wall = at[load.wall];
    const SurfacePoint point =
        load.part >= 0
            ? wall.place.moved(wall.mesh->point_of(load.part, wall.place.moved_back(load.x)))
            : nearest_point(wall, load.x - wall.middle, feature);
    sum -= load.force * point.height + dot(load.torque, point.n);
  }
  return sum;
}

void Scene::begin_step(bool counts)
{
  counting = counts;
  for (std::size_t w = 0; w < present.size(); ++w)
    if (present[w].kind == Wall::FACE && !std::isfinite(before[w].face.offset))
      before[w] = present[w];
  for (std::size_t s = 0; s < motions.size(); ++s)
    if (!std::isfinite(length(motions_before[s].step))) motions_before[s] = motions[s];
  if (counting) given -= 0.5 * (potential(present) - potential_then);
  loads.clear();
}

void Scene::end_step()
{
  potential_then = potential(present);
  if (counting) given -= 0.5 * (potential_then - potential(before));
  before = present;
  motions_before = motions;
}

/* ----------------------------------------------------------------------
   The middle of the step counts: the mean over both of its ends is right to
   second order.
------------------------------------------------------------------------- */

Vector3 Scene::way(int feature, const Vector3 &x) const
{
  if (!moves || feature >= present.back().first_feature + present.back().features) return {};
  const int w = wall_of(feature);
  const Wall &wall = walls[w];
  const bool has_corners = dimension == 2 && wall.kind == Wall::POLYGON;
  const int side = has_corners ? (feature - present[w].first_feature) / 3 : 0;
  const int shape = wall.sides.empty() ? wall.shape : wall.sides[side].shape;
  const Motion &now = motions[shape], &then = motions_before[shape];
  const Vector3 step = now.step - then.step, from = x - 0.5 * (now.step + then.step);
  return step + (now.angle - then.angle) * cross(now.axis, from) + slide;
}

// The last one that begins at this feature or before it.
int Scene::wall_of(int feature) const
{
  const auto after =
      std::upper_bound(present.begin(), present.end(), feature,
                       [](int f, const Present &wall) { return f < wall.first_feature; });
  return static_cast<int>(after - present.begin()) - 1;
}

std::vector<Scene::Features> Scene::feature_names() const
{
  std::vector<Features> names;
  std::map<std::string, int> next;
  for (const Present &wall : present) {
    int &first = next.insert({walls[index_of(wall)].name, 1}).first->second;
    names.push_back({walls[index_of(wall)].name, first, wall.features});
    first += wall.features;
  }
  return names;
}

double Scene::memory_usage() const
{
  double bytes = static_cast<double>(loads.capacity() * sizeof(Load));
  for (const std::vector<Present> *const list : {&present, &before})
    for (const Present &wall : *list)
      bytes += static_cast<double>(sizeof(Present) + wall.planes.capacity() * sizeof(HalfSpace) +
                                   wall.edges.capacity() * sizeof(Edge));
  for (const WallShape &shape : shapes)
    if (shape.mesh) bytes += shape.mesh->bytes();
  return bytes;
}

}    // namespace deformable
