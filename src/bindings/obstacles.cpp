#include "laws.h"

#include "convex_polygon.h"

#include <cmath>

using namespace deformable;

namespace {

std::vector<Edge> polygon(nb::handle nx, nb::handle ny, nb::handle offset)
{
  const std::vector<double> x = vector_of("nx", nx), y = vector_of("ny", ny),
                            o = vector_of("offset", offset);
  if (x.size() != y.size() || x.size() != o.size() || x.empty())
    refuse("nx, ny and offset must have one value for each of at least one half plane");
  std::vector<HalfPlane> planes;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double length = std::hypot(x[k], y[k]);
    if (!(length > 0.0)) refuse("nx and ny are both 0: the normal needs a direction");
    planes.push_back({x[k] / length, y[k] / length, o[k] / length});
  }
  std::vector<Edge> edges(planes.size());
  if (!intersect(planes.data(), static_cast<int>(planes.size()), edges.data()))
    refuse("the half planes have no point in common");
  return edges;
}

std::vector<HalfPlane> planes_of_corners(nb::handle px, nb::handle py)
{
  const std::vector<double> x = vector_of("x", px), y = vector_of("y", py);
  if (x.size() != y.size() || x.size() < 2)
    refuse("corners must be at least two points, with x and y of each");
  std::vector<Point> corners;
  for (std::size_t k = 0; k < x.size(); ++k) corners.push_back({x[k], y[k]});
  if (x.size() == 2) {
    if (x[0] == x[1] && y[0] == y[1]) refuse("has no length: its ends are the same point");
    return segment_planes(corners[0], corners[1]);
  }
  std::vector<HalfPlane> planes;
  Point wrong;
  const Corners kind = polygon_planes(corners, planes, wrong);
  if (kind == Corners::CROSSED)
    refuse("crosses itself: give its corners in the order around it");
  if (kind == Corners::NOT_CONVEX)
    refuse("is not convex at its corner (" + std::to_string(wrong.x) + ", " + std::to_string(wrong.y) +
           "): divide it into convex polygons, and leave out corners within its sides");
  return planes;
}

}    // namespace

void deformable::bind_obstacles(nb::module_ &m)
{
  m.def(
      "polygon_edges",
      [](nb::handle nx, nb::handle ny, nb::handle offset) {
        std::vector<double> ends;
        for (const Edge &edge : polygon(nx, ny, offset)) {
          const double missing = std::numeric_limits<double>::quiet_NaN();
          for (const double end : {edge.low, edge.high}) {
            const bool there = edge.bounds() && std::isfinite(end);
            ends.push_back(there ? edge.x(end) : missing);
            ends.push_back(there ? edge.y(end) : missing);
          }
        }
        return to_numpy<Matrix>(ends.data(), {ends.size() / 4, 4});
      },
      "nx"_a, "ny"_a, "offset"_a,
      R"(Both ends (x, y, x, y) of each side of the polygon nx x + ny y <= offset.

nan where a side has no end, or is none because other half planes enclose the polygon alone.)");
  m.def(
      "nearest_on_polygon",
      [](nb::handle nx, nb::handle ny, nb::handle offset, double x, double y) {
        const std::vector<Edge> edges = polygon(nx, ny, offset);
        NearestPoint point;
        if (!nearest_point(edges.data(), static_cast<int>(edges.size()), x, y, point))
          return nb::object(nb::none());
        return nb::object(nb::make_tuple(point.nx, point.ny, point.height, point.per_lever));
      },
      "nx"_a, "ny"_a, "offset"_a, "x"_a, "y"_a,
      R"(The contact of a particle at (x, y) with the polygon nx x + ny y <= offset, None inside.

Direction (two components), distance, and rotation of the direction per sideways step: 0 on a side,
1/distance at a corner.)");
  m.def(
      "polygon_planes",
      [](nb::handle x, nb::handle y) {
        std::vector<double> values;
        for (const HalfPlane &plane : planes_of_corners(x, y))
          values.insert(values.end(), {plane.nx, plane.ny, plane.offset});
        return to_numpy<Matrix>(values.data(), {values.size() / 3, 3});
      },
      "x"_a, "y"_a,
      R"(Half planes (nx, ny, offset) of a convex polygon with these corners, in the order around it.

Two corners are a segment.)");
  m.def(
      "nearest_points",
      [](nb::handle nx, nb::handle ny, nb::handle offset, nb::handle px, nb::handle py) {
        const std::vector<Edge> edges = polygon(nx, ny, offset);
        const std::vector<double> x = vector_of("x", px), y = vector_of("y", py);
        if (x.size() != y.size()) refuse("x and y must have one value for each point");
        std::vector<double> values;
        for (std::size_t k = 0; k < x.size(); ++k) {
          NearestPoint point = {0.0, 0.0, -std::numeric_limits<double>::infinity(), 0.0, 0};
          if (!nearest_point(edges.data(), static_cast<int>(edges.size()), x[k], y[k], point)) {
            point.height = -std::numeric_limits<double>::infinity();
            for (const Edge &edge : edges) {    // inside: by the nearest face
              const double height = edge.line.nx * x[k] + edge.line.ny * y[k] - edge.line.offset;
              if (edge.bounds() && height > point.height)
                point = {-edge.line.nx, -edge.line.ny, height, 0.0, 0};
            }
          }
          values.insert(values.end(), {point.nx, point.ny, point.height});
        }
        return to_numpy<Matrix>(values.data(), {values.size() / 3, 3});
      },
      "nx"_a, "ny"_a, "offset"_a, "x"_a, "y"_a,
      R"(Direction (two components) to the nearest point of the polygon nx x + ny y <= offset, and distance.

For each point (x, y). Inside, to the nearest side, with a negative distance.)");
}
