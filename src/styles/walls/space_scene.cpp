#include "styles/walls/space_scene.h"

#include "solver/vector_bytes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

using namespace LAMMPS_NS;
using namespace deformable;

/* ---------------------------------------------------------------------- */

std::string SpaceScene::assign(WallSources &&given_sources)
{
  sources = std::move(given_sources);
  walls.clear();
  for (std::size_t w = 0; w < sources.walls.size(); ++w) {
    const WallSource &source = sources.walls[w];
    Wall wall{};
    wall.kind = source.kind;
    wall.source = static_cast<int>(w);
    wall.is_ball = source.sides.empty() && !sources.shapes[source.shape].is_body;
    walls.push_back(wall);
  }
  moving = sources.move();
  const std::string problem = update();
  before = walls;
  return problem;
}

/* ----------------------------------------------------------------------
   Directions move with a region as the difference of two of its points.
------------------------------------------------------------------------- */

static Vector3 turned_with(Region *region, const Vector3 &direction)
{
  return moved_with(region, direction) - moved_with(region, {});
}

static bool is_moved(const WallShape &shape)
{
  return shape.region && shape.region->dynamic;
}

HalfSpace SpaceScene::present(const WallSource::Side &side) const
{
  const WallShape &shape = sources.shapes[side.shape];
  HalfSpace face = shape.spaces[side.plane];
  if (is_moved(shape)) {
    const Vector3 x = moved_with(shape.region, face.offset * face.n),
                  n = turned_with(shape.region, face.n);
    face.n = (1.0 / length(n)) * n;
    face.offset = dot(face.n, x);
  }
  if (side.reversed) face = {-face.n, -face.offset};
  return face;
}

// A ball, or a body around an axis.
void SpaceScene::place_body(const WallShape &shape, Wall &wall) const
{
  wall.center = wall.is_ball ? Vector3{shape.x, shape.y, shape.z} : shape.body.center;
  wall.radius = shape.radius;
  wall.body = shape.body;
  if (!wall.is_ball) {    // its section
    HalfPlane planes[3] = {shape.body.side};
    int n = 1;
    for (const HalfSpace &end : shape.spaces)
      planes[n++] = {0.0, dot(end.n, shape.body.axis), end.offset - dot(end.n, wall.center)};
    intersect(planes, n, wall.body.edges);
    wall.body.count = n;
  }
  if (!is_moved(shape)) return;
  wall.center = wall.body.center = moved_with(shape.region, wall.center);
  const Vector3 axis = turned_with(shape.region, shape.body.axis);
  if (!wall.is_ball) wall.body.axis = (1.0 / length(axis)) * axis;
}

/* ---------------------------------------------------------------------- */

std::string SpaceScene::update()
{
  for (WallShape &shape : sources.shapes) {
    if (!shape.region || !shape.region->varshape) continue;
    const int faces = shape.faces();
    const std::string problem = read_solid(shape.region, shape);
    if (!problem.empty()) return "region '" + shape.name + "' " + problem;
    if (shape.faces() != faces) return "region '" + shape.name + "' gains or loses a face";
  }
  for (Wall &wall : walls) {
    const WallSource &source = sources.walls[wall.source];
    if (wall.kind == WallSource::FACE) {
      wall.face = present(source.sides[0]);
    } else if (wall.kind == WallSource::POLYGON) {
      wall.spaces.clear();
      for (const WallSource::Side &side : source.sides) wall.spaces.push_back(present(side));
      if (!meet(wall.spaces.data(), static_cast<int>(wall.spaces.size())))
        return "obstacle '" + source.name + "' has no surface: its planes leave nothing of it";
    } else {
      place_body(sources.shapes[source.shape], wall);
    }
    if (wall.kind == WallSource::POLYGON || wall.kind == WallSource::DISK) find_ends(wall);
  }
  return "";
}

// Of a convex body: where it is nearest to a point far away, then to points in front of that, where less is lost to rounding. So
// bodies may have any size.
void SpaceScene::find_ends(Wall &wall) const
{
  constexpr double AWAY[] = {1e9, 1.0, 1e-6}, ENDLESS = 1e6;
  const Vector3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      Vector3 foot = {};
      bool ends = true;
      for (const double distance : AWAY) {
        const Vector3 x = foot + (sign * distance) * axes[axis];
        SurfacePoint point;
        ends = ends && nearest_point(wall, x, point);
        if (ends) foot = x + point.height * point.n;
      }
      const double end = dot(axes[axis], foot);
      ends = ends && std::fabs(end) < ENDLESS;
      (sign < 0.0 ? wall.low : wall.high)[axis] =
          ends ? end : sign * std::numeric_limits<double>::infinity();
    }
}

int SpaceScene::first_outside(int axis, double low, double high) const
{
  bool any_face = false;
  for (const Wall &wall : walls) any_face |= wall.kind == WallSource::FACE;
  const auto part = [axis](const Vector3 &v) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; };
  for (const Wall &wall : walls) {
    const double n = part(wall.face.n), center = part(wall.center);
    if (wall.kind == WallSource::FACE && std::fabs(n) == 1.0 && std::isfinite(wall.face.offset) &&
        (n > 0.0 ? wall.face.offset > high : -wall.face.offset < low))
      return wall.source;
    if (wall.kind == WallSource::RIM && wall.is_ball && !any_face &&
        (center - wall.radius < low || center + wall.radius > high))
      return wall.source;
  }
  return -1;
}

/* ---------------------------------------------------------------------- */

bool SpaceScene::nearest_point(const Wall &wall, const Vector3 &x, SurfacePoint &point)
{
  const bool inside = wall.kind == WallSource::RIM;
  if (wall.kind == WallSource::FACE) {
    point = nearest_on_plane(wall.face, x);
  } else if (wall.kind == WallSource::POLYGON) {
    return nearest_on_polyhedron(wall.spaces.data(), static_cast<int>(wall.spaces.size()), x,
                                 point);
  } else if (wall.is_ball) {
    const Vector3 to = wall.center - x;
    if (dot(to, to) == 0.0) return false;
    point = nearest_on_sphere(to, wall.radius, inside);
  } else if (inside) {
    return nearest_on_side(wall.body, x, point);
  } else {
    return nearest_on_revolution(wall.body, x, point);
  }
  return true;
}

// An obstacle that fits, with the cutoff on both sides, into a period has its images with the box.
bool SpaceScene::locate(const Wall &wall, Vector3 x, double cutoff, SurfacePoint &point) const
{
  if (wall.kind == WallSource::RIM) return nearest_point(wall, x, point);
  for (int axis = 2; axis >= 0; --axis) {
    const auto part = [axis](const Vector3 &v) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; };
    const double length = part(period[axis]), half = 0.5 * (wall.high[axis] - wall.low[axis]);
    if (0.5 * length >= half + cutoff) {
      const double from = part(x) - 0.5 * (wall.low[axis] + wall.high[axis]);
      x = x - std::rint(from / length) * period[axis];
    }
    if (part(x) <= wall.low[axis] - cutoff || part(x) >= wall.high[axis] + cutoff) return false;
  }
  if (!nearest_point(wall, x, point)) point.height = 0.0;    // inside of it
  return true;
}

/* ----------------------------------------------------------------------
   Its change, as walls move, is that of the energy of the droplets.
------------------------------------------------------------------------- */

double SpaceScene::potential() const
{
  double sum = 0.0;
  for (const Load &load : loads) {
    SurfacePoint point;
    const Wall &wall = walls[load.wall];
    if (wall.kind == WallSource::FACE)
      point = nearest_on_plane(wall.face, load.x);
    else if (!locate(wall, load.x, load.cutoff, point))
      continue;
    sum -= load.force * point.height + dot(load.torque, point.n);
  }
  return sum;
}

void SpaceScene::begin_step(bool counts)
{
  counting = counts;
  for (std::size_t w = 0; w < walls.size(); ++w)
    if (walls[w].kind == WallSource::FACE && !std::isfinite(before[w].face.offset))
      before[w] = walls[w];
  if (counting) given -= 0.5 * (potential() - potential_then);
  loads.clear();
}

void SpaceScene::end_step()
{
  potential_then = potential();
  if (counting) {
    walls.swap(before);
    given -= 0.5 * (potential_then - potential());
    walls.swap(before);
  }
  before = walls;
}

/* ---------------------------------------------------------------------- */

double SpaceScene::memory_usage() const
{
  return bytes_of(walls, before, loads);
}
