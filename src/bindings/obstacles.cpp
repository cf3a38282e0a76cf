#include "laws.h"

#include "obstacle.h"

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
}
