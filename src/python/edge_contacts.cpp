#include "python/laws.h"

#include "geometry/polygon.h"
#include "polygons/edge_contact.h"

#include <cmath>

using namespace deformable;

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
