// The nearest points of walls: half spaces, convex polyhedra, balls, and bodies of revolution. In the plane of the particles
// z = 0.
//
// As in polygon.h, an obstacle touches a particle by its point nearest to the center, which moves continuously when the
// particle does; each face of a container is a surface of its own, which does not end. Inside of an obstacle, and beyond a
// container, the height is negative.

#ifndef DEFORMABLE_SURFACE_H
#define DEFORMABLE_SURFACE_H

#include "geometry/polygon.h"
#include "laws/vector3.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace deformable {

// The points with n.x <= offset. n is a unit vector.
struct HalfSpace {
  Vector3 n;
  double offset;
};

// The point of a surface that is nearest to a center: the direction n to it, and its distance. A small step s of the center
// turns n by
//   dn = -(turn s' + more (t.s) t),   s' = s - (n.s) n,
// with the unit vector t across n: 0 on a plane, turn = 1/(rho + height) outside of a sphere, -1/(rho - height) inside of it.
// In the middle of a round surface, where all of its points are as near, n is any direction and turn is infinite.
struct SurfacePoint {
  Vector3 n;
  double height;
  double turn, more;
  Vector3 t;

  // minus dn for this step. It is symmetric: also the force, if a torque of the contact is the derivative by n.
  Vector3 turned(const Vector3 &step) const
  {
    return turn * across(step, n) + (more * dot(t, step)) * t;
  }
};

inline SurfacePoint nearest_on_plane(const HalfSpace &wall, const Vector3 &x)
{
  const Vector3 &n = wall.n;
  return {n, wall.offset - n.x * x.x - n.y * x.y - n.z * x.z, 0.0, 0.0, {}};
}

// Of a disk or sphere, outside or inside. `to_center`: from x to its center.
inline SurfacePoint nearest_on_sphere(const Vector3 &to_center, double radius, bool inside)
{
  const double distance = length(to_center), sign = inside ? -1.0 : 1.0;
  const double height = sign * (distance - radius), turn = sign / distance;
  if (distance == 0.0) return {{1.0, 0.0, 0.0}, height, turn, 0.0, {}};
  const Vector3 n = {sign * to_center.x / distance, sign * to_center.y / distance,
                     sign * to_center.z / distance};
  return {n, height, turn, 0.0, {}};
}

// A body around an axis: edges of its section, in (distance from the axis, height above the center). The first one is its side,
// of a cylinder or cone; the others are its ends.
struct Revolution {
  Vector3 center, axis;
  HalfPlane side;
  std::vector<Edge> section;
};

// The side of a cone: s <= radius + slope z. Of a cylinder the slope is 0.
inline HalfPlane cone_side(double radius, double slope)
{
  const double slant = std::hypot(1.0, slope);
  return {1.0 / slant, -slope / slant, radius / slant};
}

// A point seen from the axis of a body: its distance s from the axis, its height z, and the direction away from the axis.
struct AxialPoint {
  double s, z;
  Vector3 away;

  AxialPoint(const Revolution &body, const Vector3 &x)
  {
    const Vector3 from = x - body.center, out = across(from, body.axis);
    s = length(out);
    z = dot(from, body.axis);
    away = (1.0 / s) * out;
    if (s > 0.0) return;
    const Vector3 any = std::fabs(body.axis.x) < 0.5 ? Vector3{1, 0, 0} : Vector3{0, 1, 0};
    const Vector3 beside = across(any, body.axis);
    away = (1.0 / length(beside)) * beside;
  }

  // From (ns, nz), the direction in the half plane of x. Around the axis it turns with x, by ns/s.
  SurfacePoint surface_point(const Revolution &body, double ns, double nz, double height,
                             double turn) const
  {
    const Vector3 n = ns * away + nz * body.axis;
    if (s == 0.0 && ns != 0.0) return {n, height, std::numeric_limits<double>::infinity(), 0.0, {}};
    const double around = s > 0.0 ? -ns / s : turn;
    return {n, height, turn, around - turn, cross(body.axis, away)};
  }
};

// The side, from inside.
inline SurfacePoint nearest_on_side(const Revolution &body, const Vector3 &x)
{
  const AxialPoint from(body, x);
  const HalfPlane &side = body.side;
  const double height = side.offset - side.nx * from.s - side.ny * from.z;
  return from.surface_point(body, side.nx, side.ny, height, 0.0);
}

inline SurfacePoint nearest_on_revolution(const Revolution &body, const Vector3 &x)
{
  const AxialPoint from(body, x);
  const NearestPoint found = nearest_on_polygon(body.section, from.s, from.z);
  return from.surface_point(body, found.nx, found.ny, found.height, found.turn);
}

// The point of the intersection of half spaces nearest to x: on a face, an edge or a corner.
//
// It is the farthest of the points nearest to x in one, two or three of the half spaces, on all of their faces: that is the dual
// problem, and it has no tolerance.
inline SurfacePoint nearest_on_polyhedron(const std::vector<HalfSpace> &planes, const Vector3 &x)
{
  constexpr double PARALLEL = 1e-12;
  const std::size_t n = planes.size();
  SurfacePoint point = {{}, -std::numeric_limits<double>::infinity(), 0.0, 0.0, {}};
  double farthest = 0.0;
  const auto above = [&](std::size_t k) { return dot(planes[k].n, x) - planes[k].offset; };
  const auto compare = [&](double square, const Vector3 &to, int faces, const Vector3 &t) {
    if (!(square > farthest)) return;
    farthest = square;
    const double height = std::sqrt(square), turn = faces > 1 ? 1.0 / height : 0.0;
    point = {(1.0 / height) * to, height, turn, faces == 2 ? -turn : 0.0, t};
  };
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3 &a = planes[i].n;
    const double da = above(i);
    if (da > 0.0)
      compare(da * da, -da * a, 1, {});
    else if (da > point.height)    // as long as x is inside
      point = {-a, da, 0.0, 0.0, {}};
    for (std::size_t j = i + 1; j < n; ++j) {
      const Vector3 &b = planes[j].n, edge = cross(a, b);
      const double db = above(j), square = dot(edge, edge);
      if (square < PARALLEL) continue;
      const double ab = dot(a, b), la = (da - ab * db) / square, lb = (db - ab * da) / square;
      if (la > 0.0 && lb > 0.0)
        compare(la * da + lb * db, -la * a - lb * b, 2, (1.0 / std::sqrt(square)) * edge);
      for (std::size_t k = j + 1; k < n; ++k) {
        const Vector3 &c = planes[k].n;
        const double dc = above(k), volume = dot(edge, c);
        if (volume * volume < PARALLEL) continue;
        // the corner, from x, and its parts along the normals
        const Vector3 bc = cross(b, c), ca = cross(c, a);
        const Vector3 to = (-1.0 / volume) * (da * bc + db * ca + dc * edge);
        const double over = -1.0 / volume;
        if (over * dot(to, bc) > 0.0 && over * dot(to, ca) > 0.0 && over * dot(to, edge) > 0.0)
          compare(dot(to, to), to, 3, {});
      }
    }
  }
  return point;
}

// Whether half spaces have a point in common.
inline bool meet(const std::vector<HalfSpace> &planes)
{
  constexpr double ROUNDING = 1e-9;
  double scale = 0.0;
  for (const HalfSpace &plane : planes) scale = std::max(scale, std::fabs(plane.offset));
  const Vector3 x = {0.37 * scale, 0.61 * scale, 0.23 * scale};
  const SurfacePoint point = nearest_on_polyhedron(planes, x);
  if (point.height <= 0.0) return true;
  const Vector3 nearest = x + point.height * point.n;    // or no such point, else
  return std::all_of(planes.begin(), planes.end(), [&](const HalfSpace &plane) {
    return dot(plane.n, nearest) - plane.offset <= ROUNDING * scale;
  });
}

}    // namespace deformable

#endif
