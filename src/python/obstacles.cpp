#include "python/laws.h"

#include "geometry/convex_polygon.h"

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
  if (kind == Corners::CROSSED) refuse("crosses itself: give its corners in the order around it");
  if (kind == Corners::NOT_CONVEX)
    refuse("is not convex at its corner (" + std::to_string(wrong.x) + ", " +
           std::to_string(wrong.y) +
           "): divide it into convex polygons, and leave out corners within its sides");
  return planes;
}

// Walls with the periodic images of obstacles that are nearest to a point.
class Scene {
 public:
  Scene(double lx, double ly, double xy) : lx(lx), ly(ly), xy(xy) {}

  void add_plane(double x, double y, double nx, double ny)
  {
    const HalfPlane line = left_of({x, y}, {x + ny, y - nx});
    walls.push_back({PLANE, x, y, 0.0, {{line, 0.0, 0.0}}});
  }
  void add_round(double x, double y, double radius, bool inside)
  {
    walls.push_back({inside ? CIRCLE : DISK, x, y, radius, {}});
  }
  void add_polygon(nb::handle px, nb::handle py)
  {
    const std::vector<HalfPlane> planes = planes_of_corners(px, py);
    const std::vector<double> x = vector_of("x", px), y = vector_of("y", py);
    Wall wall = {POLYGON, mean(x), mean(y), 0.0, std::vector<Edge>(planes.size())};
    intersect(planes.data(), static_cast<int>(planes.size()), wall.edges.data());
    walls.push_back(wall);
  }

  Matrix nearest(nb::handle px, nb::handle py) const
  {
    const std::vector<double> x = vector_of("x", px), y = vector_of("y", py);
    if (x.size() != y.size()) refuse("x and y must have one value for each point");
    std::vector<double> values;
    values.reserve(4 * x.size() * walls.size());
    for (const Wall &wall : walls)
      for (std::size_t k = 0; k < x.size(); ++k) {
        const NearestPoint point = nearest_to(wall, x[k] - wall.x, y[k] - wall.y);
        values.insert(values.end(), {point.nx, point.ny, point.height, point.per_lever});
      }
    return to_numpy<Matrix>(values.data(), {values.size() / 4, 4});
  }

 private:
  enum Kind { PLANE, CIRCLE, DISK, POLYGON };
  struct Wall {
    Kind kind;
    double x, y, radius;    // a point of a plane; of others the middle
    std::vector<Edge> edges;
  };
  double lx, ly, xy;
  std::vector<Wall> walls;

  static double mean(const std::vector<double> &values)
  {
    double sum = 0.0;
    for (double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }

  // (dx, dy): from the middle of the wall.
  NearestPoint nearest_to(const Wall &wall, double dx, double dy) const
  {
    if (wall.kind == PLANE) {
      const HalfPlane &line = wall.edges[0].line;
      return {line.nx, line.ny, -line.nx * dx - line.ny * dy, 0.0, 0};
    }
    if (wall.kind != CIRCLE) {
      const double rows = ly > 0.0 ? std::round(dy / ly) : 0.0;
      dx -= rows * xy;
      dy -= rows * ly;
      if (lx > 0.0) dx -= lx * std::round(dx / lx);
    }
    if (wall.kind != POLYGON) {
      if (dx == 0.0 && dy == 0.0) dx = std::numeric_limits<double>::min();    // any direction
      return nearest_on_disk(-dx, -dy, wall.radius, wall.kind == CIRCLE);
    }
    const double x = wall.x + dx, y = wall.y + dy;
    NearestPoint point;
    if (nearest_point(wall.edges.data(), static_cast<int>(wall.edges.size()), x, y, point))
      return point;
    point.height = -std::numeric_limits<double>::infinity();
    for (const Edge &edge : wall.edges) {
      const HalfPlane &line = edge.line;
      const double height = line.nx * x + line.ny * y - line.offset;
      if (edge.bounds() && height > point.height) point = {-line.nx, -line.ny, height, 0.0, 0};
    }
    return point;
  }
};

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
  nb::class_<Scene>(m, "Scene", R"(Walls of a box of these periods; 0: not periodic.)")
      .def(nb::init<double, double, double>(), "lx"_a, "ly"_a, "xy"_a)
      .def("add_plane", &Scene::add_plane, "x"_a, "y"_a, "nx"_a, "ny"_a)
      .def("add_round", &Scene::add_round, "x"_a, "y"_a, "radius"_a, "inside"_a,
           "A circle with particles inside, or a disk.")
      .def("add_polygon", &Scene::add_polygon, "x"_a, "y"_a, "See polygon_planes.")
      .def(
          "nearest", &Scene::nearest, "x"_a, "y"_a,
          R"(Direction (two components) to the nearest point of a wall, distance, and rotation per sideways step.

A row for each point (x, y), for one wall after the other. Beyond a plane or circle and inside of an
obstacle the distance is negative, there to the nearest side.)");
}
