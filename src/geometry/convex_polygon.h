// Half planes of convex obstacles that are given by their corners.

#ifndef DEFORMABLE_CONVEX_POLYGON_H
#define DEFORMABLE_CONVEX_POLYGON_H

#include "geometry/obstacle.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace deformable {

struct Point {
  double x, y;
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

// Twice the area of a triangle, positive if its corners come counterclockwise.
inline double turn(Point a, Point b, Point c)
{
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

enum class Corners { CONVEX, NOT_CONVEX, CROSSED };

// Half planes of a polygon whose corners come in the order around it, in either direction. `wrong` is the corner at
// which it is not convex.
inline Corners polygon_planes(std::vector<Point> corners, std::vector<HalfPlane> &planes,
                              Point &wrong)
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
    wrong = b;
    if (!(sine > 0.0)) return Corners::NOT_CONVEX;
    angle += std::atan2(sine, cosine);
    planes.push_back(left_of(a, b));
  }
  return angle < 7.0 ? Corners::CONVEX : Corners::CROSSED;
}

}    // namespace deformable

#endif
