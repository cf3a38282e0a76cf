// The geometry of walls in space: half spaces, convex polyhedra, spheres, and bodies of revolution.
//
// As in the plane (obstacle.h), an obstacle touches a droplet by its point nearest to the center, which moves continuously when
// the droplet does; each face of a container is a surface of its own, which does not end.

#ifndef DEFORMABLE_SURFACE_H
#define DEFORMABLE_SURFACE_H

#include "geometry/obstacle.h"
#include "laws/vector3.h"

#include <algorithm>
#include <cmath>

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
  return {wall.n, wall.offset - dot(wall.n, x), 0.0, 0.0, {}};
}

// Of a sphere, outside or inside. `to_center`: from x to its center.
inline SurfacePoint nearest_on_sphere(const Vector3 &to_center, double radius, bool inside)
{
  const double distance = length(to_center), sign = inside ? -1.0 : 1.0;
  return {(sign / distance) * to_center, sign * (distance - radius), sign / distance, 0.0, {}};
}

// A body around an axis: half planes of (distance from the axis, height above the center). The first one is its side, of a
// cylinder or cone; the others are its ends.
struct Revolution {
  Vector3 center, axis;
  HalfPlane side;
  Edge edges[3];
  int count;
};

// The side of a cone: s <= radius + slope z. Of a cylinder the slope is 0.
inline HalfPlane cone_side(double radius, double slope)
{
  const double slant = std::hypot(1.0, slope);
  return {1.0 / slant, -slope / slant, radius / slant};
}

// Where x is: distance from the axis, height along it, and the direction away from the axis.
struct AxialPlace {
  double s, z;
  Vector3 away;
};
inline AxialPlace axial_place(const Revolution &body, const Vector3 &x)
{
  const Vector3 from = x - body.center, out = across(from, body.axis);
  const double s = length(out);
  if (s > 0.0) return {s, dot(from, body.axis), (1.0 / s) * out};
  const Vector3 any = std::fabs(body.axis.x) < 0.5 ? Vector3{1, 0, 0} : Vector3{0, 1, 0};
  const Vector3 beside = across(any, body.axis);
  return {s, dot(from, body.axis), (1.0 / length(beside)) * beside};
}

// (ns, nz): the direction in the half plane of x. Around the axis it turns with x, by ns/s.
inline SurfacePoint around_axis(const Revolution &body, const AxialPlace &at, double ns, double nz,
                                double height, double per_lever)
{
  const double around = at.s > 0.0 ? -ns / at.s : per_lever;
  return {ns * at.away + nz * body.axis, height, per_lever, around - per_lever,
          cross(body.axis, at.away)};
}

// The side, from inside. Returns false on the axis, which has no nearest point.
inline bool nearest_on_side(const Revolution &body, const Vector3 &x, SurfacePoint &point)
{
  const AxialPlace at = axial_place(body, x);
  const HalfPlane &side = body.side;
  const double height = side.offset - side.nx * at.s - side.ny * at.z;
  point = around_axis(body, at, side.nx, side.ny, height, 0.0);
  return at.s > 0.0;
}

// Returns false if x is not outside of the body.
inline bool nearest_on_revolution(const Revolution &body, const Vector3 &x, SurfacePoint &point)
{
  const AxialPlace at = axial_place(body, x);
  NearestPoint in_plane;
  if (!nearest_point(body.edges, body.count, at.s, at.z, in_plane)) return false;
  point = around_axis(body, at, in_plane.nx, in_plane.ny, in_plane.height, in_plane.per_lever);
  return true;
}

// The point of the intersection of half spaces nearest to x: on a face, an edge or a corner. Returns false if x is not outside.
//
// It is the farthest of the points nearest to x in one, two or three of the half spaces, on all of their faces: that is the dual
// problem, and it has no tolerance.
inline bool nearest_on_polyhedron(const HalfSpace *planes, int n, const Vector3 &x,
                                  SurfacePoint &point)
{
  constexpr double PARALLEL = 1e-12;
  double farthest = 0.0;
  const auto above = [&](int k) { return dot(planes[k].n, x) - planes[k].offset; };
  const auto take = [&](double square, const Vector3 &to, int faces, const Vector3 &t) {
    if (!(square > farthest)) return;
    farthest = square;
    const double height = std::sqrt(square), turn = faces > 1 ? 1.0 / height : 0.0;
    point = {(1.0 / height) * to, height, turn, faces == 2 ? -turn : 0.0, t};
  };
  for (int i = 0; i < n; ++i) {
    const Vector3 &a = planes[i].n;
    const double da = above(i);
    if (da > 0.0) take(da * da, -da * a, 1, {});
    for (int j = i + 1; j < n; ++j) {
      const Vector3 &b = planes[j].n, edge = cross(a, b);
      const double db = above(j), square = dot(edge, edge);
      if (square < PARALLEL) continue;
      const double ab = dot(a, b), la = (da - ab * db) / square, lb = (db - ab * da) / square;
      if (la > 0.0 && lb > 0.0)
        take(la * da + lb * db, -la * a - lb * b, 2, (1.0 / std::sqrt(square)) * edge);
      for (int k = j + 1; k < n; ++k) {
        const Vector3 &c = planes[k].n;
        const double dc = above(k), volume = dot(edge, c);
        if (volume * volume < PARALLEL) continue;
        // the corner, from x, and its parts along the normals
        const Vector3 bc = cross(b, c), ca = cross(c, a);
        const Vector3 to = (-1.0 / volume) * (da * bc + db * ca + dc * edge);
        const double over = -1.0 / volume;
        if (over * dot(to, bc) > 0.0 && over * dot(to, ca) > 0.0 && over * dot(to, edge) > 0.0)
          take(dot(to, to), to, 3, {});
      }
    }
  }
  return farthest > 0.0;
}

// Whether half spaces have a point in common.
inline bool meet(const HalfSpace *planes, int n)
{
  constexpr double ROUNDING = 1e-9;
  double scale = 0.0;
  for (int k = 0; k < n; ++k) scale = std::max(scale, std::fabs(planes[k].offset));
  const Vector3 x = {0.37 * scale, 0.61 * scale, 0.23 * scale};
  SurfacePoint point;
  if (!nearest_on_polyhedron(planes, n, x, point)) return true;
  const Vector3 nearest = x + point.height * point.n;    // or no such point, else
  for (int k = 0; k < n; ++k)
    if (dot(planes[k].n, nearest) - planes[k].offset > ROUNDING * scale) return false;
  return true;
}

}    // namespace deformable

#endif
