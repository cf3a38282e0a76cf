#include "python/arguments.h"
#include "python/laws.h"

#include "geometry/surface.h"
#include "laws/droplet.h"

#include <array>
#include <cmath>
#include <limits>

using namespace deformable;

namespace {

// Walls in space, with the periodic images of obstacles that are nearest to a point.
class SpaceScene {
 public:
  SpaceScene(double lx, double ly, double lz, double xy, double xz, double yz)
      : period{{{lx, 0.0, 0.0}, {xy, ly, 0.0}, {xz, yz, lz}}},
        side{lx, ly, lz}
  {
  }

  void add_plane(double x, double y, double z, double nx, double ny, double nz)
  {
    const Vector3 out = (-1.0 / length({nx, ny, nz})) * Vector3{nx, ny, nz};
    walls.push_back({PLANE, {x, y, z}, 0.0, {out, dot(out, {x, y, z})}, {}});
  }
  void add_round(double x, double y, double z, double radius, bool inside)
  {
    walls.push_back({inside ? SPHERE : BALL, {x, y, z}, radius, {}, {}});
  }
  void add_cone(double x, double y, double z, double ax, double ay, double az, double radius,
                double slope, bool inside)
  {
    const Vector3 axis = (1.0 / length({ax, ay, az})) * Vector3{ax, ay, az};
    const HalfPlane side = cone_side(radius, slope);
    walls.push_back({inside ? CONE : POST, {x, y, z}, radius, {}, {{x, y, z}, axis, side, {}, 0}});
  }

  Matrix nearest(nb::handle px, nb::handle py, nb::handle pz) const
  {
    const std::vector<double> x = vector_of("x", px), y = vector_of("y", py),
                              z = vector_of("z", pz);
    if (x.size() != y.size() || x.size() != z.size())
      refuse("x, y and z must have one value for each point");
    std::vector<double> values;
    values.reserve(5 * x.size() * walls.size());
    for (const Wall &wall : walls)
      for (std::size_t k = 0; k < x.size(); ++k) {
        const SurfacePoint point = nearest_to(wall, {x[k], y[k], z[k]});
        values.insert(values.end(),
                      {point.n.x, point.n.y, point.n.z, point.height, turn_of(point)});
      }
    return to_numpy<Matrix>(values.data(), {values.size() / 5, 5});
  }

 private:
  enum Kind { PLANE, SPHERE, BALL, CONE, POST };
  struct Wall {
    Kind kind;
    Vector3 center;
    double radius;
    HalfSpace face;
    Revolution body;
  };
  std::array<Vector3, 3> period;
  std::array<double, 3> side;
  std::vector<Wall> walls;

  SurfacePoint nearest_to(const Wall &wall, const Vector3 &x) const
  {
    constexpr double ANY = std::numeric_limits<double>::infinity();    // direction, in the middle
    if (wall.kind == PLANE) return nearest_on_plane(wall.face, x);
    const bool inside = wall.kind == SPHERE || wall.kind == CONE;
    Vector3 to = wall.center - x;
    for (int axis = 2; axis >= 0 && !inside; --axis) {
      const double along = axis == 0 ? to.x : axis == 1 ? to.y : to.z;
      if (side[axis] > 0.0) to = to - std::round(along / side[axis]) * period[axis];
    }
    if (wall.kind == CONE || wall.kind == POST) {
      SurfacePoint point;
      if (!nearest_on_side(wall.body, wall.center - to, point)) point.turn = ANY;
      if (inside) return point;
      return {-point.n, -point.height, point.turn, -point.more, point.t};
    }
    if (dot(to, to) > 0.0) return nearest_on_sphere(to, wall.radius, inside);
    return {{1.0, 0.0, 0.0}, inside ? wall.radius : -wall.radius, ANY, 0.0, {}};
  }

  static double turn_of(const SurfacePoint &point)
  {
    return point.more == 0.0 ? point.turn : std::numeric_limits<double>::quiet_NaN();
  }
};

}    // namespace

void deformable::bind_surfaces(nb::module_ &m)
{
  m.attr("largest_bulge") = LARGEST_BULGE;
  nb::class_<SpaceScene>(m, "SpaceScene",
                         R"(Walls of a box of these periods in space; 0: not periodic.)")
      .def(nb::init<double, double, double, double, double, double>(), "lx"_a, "ly"_a, "lz"_a,
           "xy"_a, "xz"_a, "yz"_a)
      .def("add_plane", &SpaceScene::add_plane, "x"_a, "y"_a, "z"_a, "nx"_a, "ny"_a, "nz"_a)
      .def("add_round", &SpaceScene::add_round, "x"_a, "y"_a, "z"_a, "radius"_a, "inside"_a,
           "A sphere with particles inside, or a ball.")
      .def("add_cone", &SpaceScene::add_cone, "x"_a, "y"_a, "z"_a, "ax"_a, "ay"_a, "az"_a,
           "radius"_a, "slope"_a, "inside"_a,
           "Around an axis, whose radius grows by the slope along it; 0: a tube, or a post.")
      .def(
          "nearest", &SpaceScene::nearest, "x"_a, "y"_a, "z"_a,
          R"(Direction (three components) to the nearest point of a wall, distance, and rotation per sideways step.

A row for each point (x, y, z), for one wall after the other. The distance is negative beyond a plane, sphere or
cone and inside of a ball or post. The rotation is nan where it differs by the direction of the step, at a cone or post.)");
}
