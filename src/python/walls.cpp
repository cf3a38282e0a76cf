#include "python/laws.h"

#include "geometry/mesh_files.h"
#include "geometry/scene.h"

#include <cmath>
#include <limits>

using namespace deformable;

namespace {

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
  const std::string problem = polygon_planes(corners, planes);
  if (!problem.empty()) refuse(problem);
  return planes;
}

// Python has a class for each dimension, whose functions take two coordinates of a point or three.
struct PlaneScene : Scene {
  PlaneScene(double lx, double ly, double xy) : Scene(2)
  {
    period = {{{lx, 0.0, 0.0}, {xy, ly, 0.0}, {}}};
  }
};
struct SpaceScene : Scene {
  SpaceScene(double lx, double ly, double lz, double xy, double xz, double yz) : Scene(3)
  {
    period = {{{lx, 0.0, 0.0}, {xy, ly, 0.0}, {xz, yz, lz}}};
  }
};

void add_half_plane(PlaneScene &scene, double x, double y, double nx, double ny)
{
  WallShape shape;
  shape.set_planes({left_of({x, y}, {x + ny, y - nx})});
  scene.add(Wall::FACE, "", shape);
}

void add_half_space(SpaceScene &scene, double x, double y, double z, double nx, double ny,
                    double nz)
{
  const Vector3 out = (-1.0 / length({nx, ny, nz})) * Vector3{nx, ny, nz};
  WallShape shape;
  shape.planes = {{out, dot(out, {x, y, z})}};
  scene.add(Wall::FACE, "", shape);
}

void add_round(Scene &scene, const Vector3 &center, double radius, bool inside)
{
  WallShape shape;
  shape.center = center;
  shape.radius = radius;
  scene.add(inside ? Wall::RIM : Wall::DISK, "", shape);
}

void add_polygon(PlaneScene &scene, nb::handle x, nb::handle y)
{
  WallShape shape;
  shape.set_planes(planes_of_corners(x, y));
  scene.add(Wall::POLYGON, "", shape);
}

void add_cone(SpaceScene &scene, double x, double y, double z, double ax, double ay, double az,
              double radius, double slope, bool inside)
{
  const Vector3 axis = (1.0 / length({ax, ay, az})) * Vector3{ax, ay, az};
  WallShape shape;
  shape.set_body({{x, y, z}, axis, cone_side(radius, slope), {}});
  scene.add(inside ? Wall::RIM : Wall::DISK, "", shape);
}

// A chain of points in the plane, or three corners of each triangle in space, as rows.
Mesh mesh_of(int dimension, nb::handle given, bool inside)
{
  const Table rows = table_of("corners", given, dimension);
  std::vector<Vector3> corners;
  for (std::size_t k = 0; k < rows.shape(0); ++k)
    corners.push_back({rows(k, 0), rows(k, 1), dimension == 3 ? rows(k, 2) : 0.0});
  if (dimension == 2) corners = segments_of(corners, inside);
  if (corners.size() % dimension != 0) refuse("corners must be three of each triangle");
  Mesh mesh;
  const std::string problem =
      mesh.build(dimension, corners, inside, dimension == 2 ? "segment" : "triangle");
  if (!problem.empty()) refuse(problem);
  return mesh;
}

template <class Where> void add_mesh(Where &scene, nb::handle corners, bool inside)
{
  WallShape shape;
  shape.mesh = std::make_shared<Mesh>(mesh_of(scene.dimension, corners, inside));
  scene.add(inside ? Wall::ROOM : Wall::SURFACE, "", shape);
}

Matrix rows_of_points(int dimension, const std::vector<Vector3> &points)
{
  std::vector<double> values;
  for (const Vector3 &x : points)
    for (int axis = 0; axis < dimension; ++axis) values.push_back(component(x, axis));
  return to_numpy<Matrix>(values.data(), {points.size(), static_cast<std::size_t>(dimension)});
}

Matrix read_mesh(int dimension, const nb::bytes &given)
{
  const std::string bytes(given.c_str(), given.size());
  std::vector<Vector3> points;
  const std::string problem = dimension == 2 ? read_chain(bytes, points) : read_stl(bytes, points);
  if (!problem.empty()) refuse(problem);
  return rows_of_points(dimension, points);
}

// A row for each contact of each center within the cutoff: its number, that of the wall, n, height and turn.
template <class Where> Matrix contacts(Where &scene, nb::handle given, double cutoff)
{
  scene.update();
  const int dimension = scene.dimension;
  const Table x = table_of("x", given, dimension);
  constexpr double ANY = -std::numeric_limits<double>::infinity();
  std::vector<double> values;
  for (std::size_t k = 0; k < x.shape(0); ++k)
    scene.visit({x(k, 0), x(k, 1), dimension == 3 ? x(k, 2) : 0.0}, 0.0, ANY, cutoff,
                [&](int feature, const SurfacePoint &point) {
                  values.insert(values.end(), {static_cast<double>(k),
                                               static_cast<double>(scene.wall_of(feature))});
                  for (int axis = 0; axis < dimension; ++axis)
                    values.push_back(component(point.n, axis));
                  values.insert(values.end(), {point.height, point.turn + point.more,
                                               static_cast<double>(feature)});
                });
  const std::size_t columns = dimension + 5;
  return to_numpy<Matrix>(values.data(), {values.size() / columns, columns});
}

Matrix nearest(Scene &scene, const std::vector<double> &x, const std::vector<double> &y,
               const std::vector<double> &z)
{
  scene.update();
  std::vector<double> values;
  for (std::size_t w = 0; w < scene.walls.size(); ++w)
    for (std::size_t k = 0; k < x.size(); ++k) {
      const SurfacePoint point = scene.nearest_point(static_cast<int>(w), {x[k], y[k], z[k]});
      values.insert(values.end(), {point.n.x, point.n.y});
      if (scene.dimension == 3) values.push_back(point.n.z);
      values.insert(values.end(), {point.height, point.turn + point.more});
    }
  const std::size_t columns = scene.dimension + 2;
  return to_numpy<Matrix>(values.data(), {values.size() / columns, columns});
}

const char *const MESH =
    R"(A chain of points (n, 2) or triangles (3 n, 3), as rows; a container, or an obstacle or open.)";
const char *const CONTACTS =
    R"(All contacts of the centers x (N, d): rows of their number, that of the wall, direction, distance, rotation per
sideways step, and a number of what is touched.)";

}    // namespace

void deformable::bind_walls(nb::module_ &m)
{
  m.def(
      "polygon_edges",
      [](nb::handle nx, nb::handle ny, nb::handle offset) {
        std::vector<double> ends;
        for (const Edge &edge : polygon_of(nx, ny, offset)) {
          const double missing = std::numeric_limits<double>::quiet_NaN();
          for (const double end : {edge.low, edge.high}) {
            const bool there = edge.bounds() && std::isfinite(end);
            ends.push_back(there ? edge.at(end).x : missing);
            ends.push_back(there ? edge.at(end).y : missing);
          }
        }
        return to_numpy<Matrix>(ends.data(), {ends.size() / 4, 4});
      },
      "nx"_a, "ny"_a, "offset"_a,
      R"(Both ends (x, y, x, y) of each side of the polygon nx x + ny y <= offset.

nan where a side has no end, or is none because other half planes enclose the polygon alone.)");
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
      "read_mesh", &read_mesh, "dimension"_a, "bytes"_a,
      R"(Points of a chain, or three corners of each triangle of an STL file, from the bytes of a file, as rows.)");
  m.def(
      "mesh",
      [](int dimension, nb::handle corners, bool inside) {
        const Mesh mesh = mesh_of(dimension, corners, inside);
        return nb::make_tuple(mesh.volume(), rows_of_points(dimension, mesh.edges()));
      },
      "dimension"_a, "corners"_a, "inside"_a,
      R"(What a mesh encloses, 0 if it is open, and in space both ends of each edge that is not flat, as rows.)");
  nb::class_<PlaneScene>(m, "Scene", R"(Walls of a box of these periods; 0: not periodic.)")
      .def(nb::init<double, double, double>(), "lx"_a, "ly"_a, "xy"_a)
      .def("add_plane", &add_half_plane, "x"_a, "y"_a, "nx"_a, "ny"_a)
      .def(
          "add_round",
          [](PlaneScene &scene, double x, double y, double radius, bool inside) {
            add_round(scene, {x, y, 0.0}, radius, inside);
          },
          "x"_a, "y"_a, "radius"_a, "inside"_a, "A circle with particles inside, or a disk.")
      .def("add_polygon", &add_polygon, "x"_a, "y"_a, "See polygon_planes.")
      .def("add_mesh", &add_mesh<PlaneScene>, "corners"_a, "inside"_a, MESH)
      .def("contacts", &contacts<PlaneScene>, "x"_a, "cutoff"_a, CONTACTS)
      .def(
          "nearest",
          [](PlaneScene &scene, nb::handle px, nb::handle py) {
            const std::vector<double> x = vector_of("x", px), y = vector_of("y", py);
            if (x.size() != y.size()) refuse("x and y must have one value for each point");
            return nearest(scene, x, y, std::vector<double>(x.size()));
          },
          "x"_a, "y"_a,
          R"(Direction (two components) to the nearest point of a wall, distance, and rotation per sideways step.

A row for each point (x, y), for one wall after the other. Beyond a plane or circle and inside of an
obstacle the distance is negative, there to the nearest side.)");
  nb::class_<SpaceScene>(m, "SpaceScene",
                         R"(Walls of a box of these periods in space; 0: not periodic.)")
      .def(nb::init<double, double, double, double, double, double>(), "lx"_a, "ly"_a, "lz"_a,
           "xy"_a, "xz"_a, "yz"_a)
      .def("add_plane", &add_half_space, "x"_a, "y"_a, "z"_a, "nx"_a, "ny"_a, "nz"_a)
      .def(
          "add_round",
          [](SpaceScene &scene, double x, double y, double z, double radius, bool inside) {
            add_round(scene, {x, y, z}, radius, inside);
          },
          "x"_a, "y"_a, "z"_a, "radius"_a, "inside"_a, "A sphere with particles inside, or a ball.")
      .def("add_cone", &add_cone, "x"_a, "y"_a, "z"_a, "ax"_a, "ay"_a, "az"_a, "radius"_a,
           "slope"_a, "inside"_a,
           "Around an axis, whose radius grows by the slope along it; 0: a tube, or a post.")
      .def("add_mesh", &add_mesh<SpaceScene>, "corners"_a, "inside"_a, MESH)
      .def("contacts", &contacts<SpaceScene>, "x"_a, "cutoff"_a, CONTACTS)
      .def(
          "nearest",
          [](SpaceScene &scene, nb::handle px, nb::handle py, nb::handle pz) {
            const std::vector<double> x = vector_of("x", px), y = vector_of("y", py),
                                      z = vector_of("z", pz);
            if (x.size() != y.size() || x.size() != z.size())
              refuse("x, y and z must have one value for each point");
            return nearest(scene, x, y, z);
          },
          "x"_a, "y"_a, "z"_a,
          R"(Direction (three components) to the nearest point of a wall, distance, and rotation per sideways step.

A row for each point (x, y, z), for one wall after the other. The distance is negative beyond a plane, sphere or
cone and inside of a ball or post. At a cone or post the rotation is that for a step around the axis.)");
}
