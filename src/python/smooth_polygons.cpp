#include "polygons/smooth_polygons.h"
#include "geometry/polygon.h"
#include "polygons/edge_contact.h"
#include "python/laws.h"

#include <cmath>
#include <string>

using namespace deformable;

namespace {

using Pairs = nb::ndarray<nb::numpy, int, nb::shape<-1, 2>>;

struct Evaluated {
  SmoothPolygons polygons;
  PolygonEnergy energy;
};

Points points(const std::vector<double> &values)
{
  return to_numpy<Points>(values.data(), {values.size() / 2, 2});
}

// First vertices of polygons, from their numbers of vertices.
std::vector<int> offsets(const std::vector<double> &number, std::size_t vertices)
{
  std::vector<int> first = {0};
  for (const double count : number) {
    if (!(count >= 3.0) || count != std::rint(count) || count > vertices)
      refuse("number of vertices is " + std::to_string(count) +
             ": a polygon needs a whole number, at least 3");
    first.push_back(first.back() + static_cast<int>(count));
  }
  if (static_cast<std::size_t>(first.back()) != vertices)
    refuse("vertices has " + std::to_string(vertices) + " rows, but the polygons have " +
           std::to_string(first.back()) + " vertices");
  return first;
}

Evaluated smooth_polygons(const std::vector<double> &x, const std::vector<double> &number,
                          const std::vector<double> &box, const std::vector<double> &kL,
                          const std::vector<double> &length, const std::vector<double> &kA,
                          const std::vector<double> &area, const Repulsion &repulsion)
{
  require_positive("kr", repulsion.kr);
  require_positive("c", repulsion.c);
  for (const auto *values : {&kL, &length, &kA, &area})
    if (values->size() != number.size())
      refuse("kL, length, kA and area must have one value for each of " +
             std::to_string(number.size()) + " polygons");
  if (box.size() != 4 || !(box[0] > 0.0) || box[1] != 0.0 || !(box[3] > 0.0))
    refuse("box must have the rows (lx, 0) and (xy, ly) with positive lx and ly");
  std::vector<PolygonParameters> parameters;
  for (std::size_t m = 0; m < number.size(); ++m)
    parameters.push_back({kL[m], length[m], kA[m], area[m]});
  Evaluated result = {
      {{{box[0], box[2], box[3]}, x, offsets(number, x.size() / 2)}, parameters, repulsion}, {}};
  const PolygonVertices &v = result.polygons.vertices;
  const double reach = repulsion.c + v.longest_edge();
  if (!(2.0 * reach < std::min(v.box.width(), v.box.height())))
    refuse("the longest edge and c are together " + std::to_string(reach) +
           ": they must be below half of the box");
  result.energy = polygon_energy(result.polygons);
  return result;
}

nb::tuple touches(const PolygonEnergy &u)
{
  std::vector<int> pairs;
  std::vector<double> values;
  for (const Touch &t : u.touches) {
    pairs.insert(pairs.end(), {t.vertex, t.edge});
    values.insert(values.end(), {t.dx, t.dy, t.contact.vertex_x, t.contact.vertex_y});
  }
  const std::size_t count = u.touches.size();
  return nb::make_tuple(to_numpy<Pairs>(pairs.data(), {count, 2}),
                        to_numpy<Matrix>(values.data(), {count, 4}));
}

nb::tuple hessian(const Evaluated &e)
{
  const Triplets h = polygon_hessian(e.polygons, e.energy);
  return nb::make_tuple(to_numpy(h.row), to_numpy(h.column), to_numpy(h.value));
}

}    // namespace

void deformable::bind_smooth_polygons(nb::module_ &m)
{
  nb::class_<Evaluated>(m, "SmoothPolygonEnergy",
                        "The energy of smooth polygons, and its derivatives.")
      .def_prop_ro(
          "energy",
          [](const Evaluated &e) { return e.energy.springs + e.energy.areas + e.energy.contacts; },
          "the sum of springs, areas and contacts [energy]")
      .def_prop_ro(
          "springs", [](const Evaluated &e) { return e.energy.springs; },
          "kL/2 sum (l - l0)^2 [energy]")
      .def_prop_ro(
          "areas", [](const Evaluated &e) { return e.energy.areas; },
          "kA/2 sum (A - A0)^2 [energy]")
      .def_prop_ro(
          "contacts", [](const Evaluated &e) { return e.energy.contacts; },
          "of vertices with edges of other polygons [energy]")
      .def_prop_ro(
          "pressure", [](const Evaluated &e) { return to_numpy(e.energy.pressure); },
          nb::rv_policy::move, "kA (A0 - A) of each polygon [energy/length^2], (N,)")
      .def_prop_ro(
          "gradient", [](const Evaluated &e) { return points(e.energy.gradient); },
          nb::rv_policy::move, "of the energy [energy/length], (V, 2)")
      .def_prop_ro(
          "area_gradient", [](const Evaluated &e) { return points(e.energy.area_gradient); },
          nb::rv_policy::move, "of the area of the vertex' own polygon [length], (V, 2)")
      .def(
          "touches", [](const Evaluated &e) { return touches(e.energy); },
          R"(The vertices that touch edges of other polygons.

Returns the numbers of the vertex and of the edge's first vertex (K, 2), and the vector from this one to the
vertex with the force on the vertex (K, 4).)")
      .def(
          "hessian", &hessian,
          R"(Second derivatives of the energy by the 2V coordinates, as rows, columns and values to be added up.

The dense part kA grad(A) grad(A)^T of each polygon is left out: see `area_gradient`.)");

  m.def(
      "smooth_polygons",
      [](nb::handle vertices, nb::handle number, nb::handle box, nb::handle kL, nb::handle length,
         nb::handle kA, nb::handle area, double kr, double c) {
        return smooth_polygons(flat_vector_of("vertices", vertices), vector_of("number", number),
                               flat_vector_of("box", box), vector_of("kL", kL),
                               vector_of("length", length), vector_of("kA", kA),
                               vector_of("area", area), {kr, c});
      },
      "vertices"_a, "number"_a, "box"_a, "kL"_a, "length"_a, "kA"_a, "area"_a, "kr"_a, "c"_a,
      R"(Smooth polygons in a periodic box: springs, soft areas, and contacts of vertices with edges.

    U = kL/2 sum (l - l0)^2 + kA/2 sum (A - A0)^2 + contacts, see `edge_contact`

Parameters
----------
vertices : (V, 2)
    Of all polygons, one polygon after the other, each counterclockwise and unwrapped [length].
number : (N,)
    Vertices of each polygon.
box : (2, 2)
    Lattice vectors as rows, (lx, 0) and (xy, ly) [length].
kL, length : (N,)
    Stiffness of the springs of each polygon [energy/length^2], and their length at rest, l0 [length].
kA, area : (N,)
    Stiffness of its area [energy/length^4], and its area at rest, A0 [length^2].
kr, c : float
    Stiffness [energy/length^2] and range [length] of the contacts.

Returns
-------
SmoothPolygonEnergy

Raises
------
ValueError
    Shapes that do not fit each other, a value that is not finite or positive, or an edge so long that it
    could meet an image of itself.

Source: docs/theory/numerics.md, "Smooth polygons".)");
}

namespace {

Point place(const std::string &name, nb::handle given)
{
  const std::vector<double> xy = vector_of(name, given);
  if (xy.size() != 2)
    refuse(name + " has " + std::to_string(xy.size()) + " numbers: it must have x and y");
  return {xy[0], xy[1]};
}

}    // namespace

void deformable::bind_edge_contacts(nb::module_ &m)
{
  m.def(
      "edge_contact",
      [](nb::handle vertex, nb::handle begin, nb::handle end, double kr, double c) {
        const Point a = place("vertex", vertex), v = place("begin", begin), w = place("end", end);
        require_positive("kr", kr);
        require_positive("c", c);
        const double px = a.x - v.x, py = a.y - v.y, ex = w.x - v.x, ey = w.y - v.y;
        EdgeContact contact;
        EdgeStiffness stiffness;
        edge_contact(px, py, ex, ey, {kr, c}, contact);
        edge_stiffness(px, py, ex, ey, {kr, c}, stiffness);
        const double forces[] = {contact.vertex_x,
                                 contact.vertex_y,
                                 -contact.vertex_x - contact.end_x,
                                 -contact.vertex_y - contact.end_y,
                                 contact.end_x,
                                 contact.end_y};
        return nb::make_tuple(contact.energy, to_numpy<Matrix>(forces, {3, 2}),
                              to_numpy<Matrix>(&stiffness.value[0][0], {6, 6}));
      },
      "vertex"_a, "begin"_a, "end"_a, "kr"_a, "c"_a,
      R"(Energy phi(dist(vertex, edge)) - phi(|vertex - begin|) of a vertex and an edge of another polygon.

phi(d) = kr/2 (c - d)^2 for d < c, else 0; the edge goes from begin to end. Returns the energy, the forces on
vertex, begin and end (3 x 2), and the second derivatives by their coordinates in that order (6 x 6).)");
}
