// Convex polygons in the plane: half planes that intersect, their edges and corners, and the nearest point.
//
// A convex obstacle touches a particle by its point nearest to the center: a foot on one of its faces, or a
// corner. This point moves continuously when the particle does.

#ifndef DEFORMABLE_POLYGON_H
#define DEFORMABLE_POLYGON_H

#include "laws/parameter_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace deformable {

struct Point {
  double x, y;
};

// The points with n.x <= offset. n is a unit vector.
struct HalfPlane {
  double nx, ny, offset;
};

// The half plane to the left of the line from a to b.
inline HalfPlane left_of(Point a, Point b)
{
  const double dx = b.x - a.x, dy = b.y - a.y, length = std::hypot(dx, dy);
  const double nx = dy / length, ny = -dx / length;
  return {nx, ny, nx * a.x + ny * a.y};
}

// A segment has the same line on both sides, whatever the rounding, and an end across it at each corner.
inline std::vector<HalfPlane> segment_planes(Point a, Point b)
{
  const Point up = {a.y - b.y, b.x - a.x};
  const HalfPlane line = left_of(a, b);
  return {line,
          left_of(b, {b.x + up.x, b.y + up.y}),
          {-line.nx, -line.ny, -line.offset},
          left_of({a.x + up.x, a.y + up.y}, a)};
}

// Half planes of a polygon whose corners come in the order around it, in either direction. Returns what is wrong with them, or
// nothing.
inline std::string polygon_planes(std::vector<Point> corners, std::vector<HalfPlane> &planes)
{
  const auto twice_area = [](Point a, Point b, Point c) {    // counterclockwise: positive
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  };
  const int n = static_cast<int>(corners.size());
  double area = 0.0;
  for (int k = 2; k < n; ++k) area += twice_area(corners[0], corners[k - 1], corners[k]);
  if (area < 0.0) std::reverse(corners.begin(), corners.end());
  double angle = 0.0;    // between the first side and the last one: more than once around in a star
  for (int k = 0; k < n; ++k) {
    const Point a = corners[k], b = corners[(k + 1) % n], c = corners[(k + 2) % n];
    const double sine = twice_area(a, b, c);
    const double cosine = (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y);
    if (!(sine > 0.0))
      return "is not convex at its corner (" + shown_number(b.x) + ", " + shown_number(b.y) +
             "): use a surface, or convex polygons without corners within their sides";
    angle += std::atan2(sine, cosine);
    planes.push_back(left_of(a, b));
  }
  return angle < 7.0 ? "" : "crosses itself: give its corners in the order around it";
}

// The part of the line n.x = offset that bounds a polygon: from low to high along the tangent (-ny, nx). An
// edge that bounds nothing has low > high; an edge without end has infinite values.
struct Edge {
  HalfPlane line;
  double low, high;

  bool bounds() const { return low <= high; }
  bool ends() const { return std::isfinite(low) && std::isfinite(high); }
  Point at(double along) const
  {
    return {line.offset * line.nx - along * line.ny, line.offset * line.ny + along * line.nx};
  }
};

// Edges of the intersection of half planes, edges[k] of planes[k]. Returns false if they have no point in common.
// Edges may have no length, and opposite edges may coincide (a segment).
inline bool intersect(const std::vector<HalfPlane> &planes, std::vector<Edge> &edges)
{
  constexpr double INFINITE = std::numeric_limits<double>::infinity();
  double scale = 0.0;
  for (const HalfPlane &plane : planes) scale = std::max(scale, std::fabs(plane.offset));
  const double rounding = 1e-13 * scale;
  bool any = false;
  edges.clear();
  for (const HalfPlane &a : planes) {
    double low = -INFINITE, high = INFINITE;
    for (const HalfPlane &b : planes) {
      if (&a == &b) continue;
      const double sine = a.nx * b.ny - a.ny * b.nx, cosine = a.nx * b.nx + a.ny * b.ny;
      const double room = b.offset - a.offset * cosine;    // of line a inside of b
      if (std::fabs(sine) > 1e-13)
        (sine > 0.0 ? high : low) =
            sine > 0.0 ? std::min(high, room / sine) : std::max(low, room / sine);
      else if (room < -rounding || (cosine > 0.0 && room <= rounding && &b < &a)) {
        low = INFINITE;    // outside of b, or the same line again
        high = -INFINITE;
      }
    }
    if (low > high && low - high <= rounding) low = high = 0.5 * (low + high);
    edges.push_back({a, low, high});
    any = any || edges.back().bounds();
  }
  return any;
}

// The nearest point as seen from a center: the direction to it, its distance, and the angle by which the direction turns for each
// sideways step: 0 on a face, 1/height at a corner.
struct NearestPoint {
  double nx = 0.0, ny = 0.0, height = -std::numeric_limits<double>::infinity(), turn = 0.0;
  int feature = 0;    // of edge k: 3 k the face, 3 k + 1 its low end, 3 k + 2 its high end
};

// The point of the polygon nearest to (x, y). Inside of it, the height is negative, to the nearest face.
inline NearestPoint nearest_on_polygon(const std::vector<Edge> &edges, double x, double y)
{
  NearestPoint deepest, corner;
  double nearest = std::numeric_limits<double>::infinity(), to_x = 0.0, to_y = 0.0;
  int k = -1;
  for (const Edge &edge : edges) {
    ++k;
    const HalfPlane &line = edge.line;
    const double height = line.nx * x + line.ny * y - line.offset;
    if (!edge.bounds()) continue;
    if (height > deepest.height) deepest = {-line.nx, -line.ny, height, 0.0, 3 * k};
    if (height <= 0.0) continue;
    const double along = line.nx * y - line.ny * x;
    if (edge.low < along && along < edge.high) return {-line.nx, -line.ny, height, 0.0, 3 * k};
    const bool at_low = along <= edge.low;
    const Point end = edge.at(at_low ? edge.low : edge.high);
    const double dx = end.x - x, dy = end.y - y, square = dx * dx + dy * dy;
    if (square >= nearest) continue;
    nearest = square;
    to_x = dx;
    to_y = dy;
    corner.feature = 3 * k + (at_low ? 1 : 2);
  }
  if (!(nearest > 0.0) || std::isinf(nearest)) return deepest;
  corner.height = std::sqrt(nearest);
  corner.nx = to_x / corner.height;
  corner.ny = to_y / corner.height;
  corner.turn = 1.0 / corner.height;
  return corner;
}

}    // namespace deformable

#endif
