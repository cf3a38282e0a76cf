// The geometry of walls: half planes, disks, and the convex polygons that half planes enclose.
//
// A convex obstacle touches a particle by its point nearest to the center: a foot on one of its faces, or a
// corner. This point moves continuously when the particle does.

#ifndef DEFORMABLE_OBSTACLE_H
#define DEFORMABLE_OBSTACLE_H

#include <algorithm>
#include <cmath>
#include <limits>

namespace deformable {

// The points with n.x <= offset. n is a unit vector.
struct HalfPlane {
  double nx, ny, offset;
};

// The part of the line n.x = offset that bounds a polygon: from low to high along the tangent (-ny, nx). An
// edge that bounds nothing has low > high; an edge without end has infinite values.
struct Edge {
  HalfPlane line;
  double low, high;

  bool bounds() const { return low <= high; }
  bool ends() const { return std::isfinite(low) && std::isfinite(high); }
  double x(double along) const { return line.offset * line.nx - along * line.ny; }
  double y(double along) const { return line.offset * line.ny + along * line.nx; }
};

// The point of a wall that is nearest to a center: the direction to it, its distance, and the rotation of the
// direction per sideways step of the wall. With the radius of curvature rho of the wall this is 1/(rho + height):
// 0 on a face, 1/height at a corner.
struct NearestPoint {
  double nx, ny, height, per_lever;
  int feature;    // of edge k: 3 k the face, 3 k + 1 its low end, 3 k + 2 its high end
};

// Edges of the intersection of half planes, edges[k] of planes[k]. Returns false if they have no point in common.
// Edges may have no length, and opposite edges may coincide (a segment).
inline bool intersect(const HalfPlane *planes, int n, Edge *edges)
{
  constexpr double INFINITE = std::numeric_limits<double>::infinity();
  double scale = 0.0;
  for (int k = 0; k < n; ++k) scale = std::max(scale, std::fabs(planes[k].offset));
  const double rounding = 1e-13 * scale;
  bool any = false;
  for (int k = 0; k < n; ++k) {
    const HalfPlane &a = planes[k];
    double low = -INFINITE, high = INFINITE;
    for (int m = 0; m < n; ++m) {
      if (m == k) continue;
      const HalfPlane &b = planes[m];
      const double sine = a.nx * b.ny - a.ny * b.nx, cosine = a.nx * b.nx + a.ny * b.ny;
      const double room = b.offset - a.offset * cosine;    // of line a inside of b
      if (std::fabs(sine) > 1e-13)
        (sine > 0.0 ? high : low) =
            sine > 0.0 ? std::min(high, room / sine) : std::max(low, room / sine);
      else if (room < -rounding || (cosine > 0.0 && room <= rounding && m < k)) {
        low = INFINITE;    // outside of b, or the same line again
        high = -INFINITE;
      }
    }
    if (low > high && low - high <= rounding) low = high = 0.5 * (low + high);
    edges[k] = {a, low, high};
    any = any || edges[k].bounds();
  }
  return any;
}

// The point of the polygon nearest to (x, y). Returns false if (x, y) is not outside of the polygon.
inline bool nearest_point(const Edge *edges, int n, double x, double y, NearestPoint &point)
{
  double nearest = std::numeric_limits<double>::infinity(), to_x = 0.0, to_y = 0.0;
  for (int k = 0; k < n; ++k) {
    const Edge &edge = edges[k];
    const HalfPlane &line = edge.line;
    const double height = line.nx * x + line.ny * y - line.offset;
    if (height <= 0.0 || !edge.bounds()) continue;
    const double along = line.nx * y - line.ny * x;
    if (edge.low < along && along < edge.high) {
      point = {-line.nx, -line.ny, height, 0.0, 3 * k};
      return true;
    }
    const bool at_low = along <= edge.low;
    const double end = at_low ? edge.low : edge.high;
    const double dx = edge.x(end) - x, dy = edge.y(end) - y, square = dx * dx + dy * dy;
    if (square >= nearest) continue;
    nearest = square;
    to_x = dx;
    to_y = dy;
    point.feature = 3 * k + (at_low ? 1 : 2);
  }
  if (!(nearest > 0.0) || std::isinf(nearest)) return false;
  point.height = std::sqrt(nearest);
  point.nx = to_x / point.height;
  point.ny = to_y / point.height;
  point.per_lever = 1.0 / point.height;
  return true;
}

// The point of a disk nearest to a center outside of it, or of its rim nearest to a center inside. (x, y) is the
// position of the disk's center relative to the particle's.
inline NearestPoint nearest_on_disk(double x, double y, double radius, bool inside)
{
  const double distance = std::sqrt(x * x + y * y), sign = inside ? -1.0 : 1.0;
  return {sign * x / distance, sign * y / distance, sign * (distance - radius), sign / distance, 0};
}

}    // namespace deformable

#endif
