#include "python/laws.h"

#include "laws/contact.h"
#include "laws/parameter_rules.h"
#include "response/outline.h"

#include <nanobind/stl/string.h>

#include <cmath>

using namespace deformable;

namespace {

void require_fine(int points)
{
  if (points < 8) refuse("points is " + std::to_string(points) + ": give at least 8");
}

Points outline_points(const std::string &law, double radius, nb::handle angle,
                      nb::handle indentation, int points, bool same_area)
{
  require_fine(points);
  Call call = checked(radius, angle, indentation);
  int *const order = call.order.data();
  Outline outline = {same_area};
  if (law == "ring") {
    const Result result = ring_result(call);
    ring_outline(radius, call.view(), result.shape, order, points, outline);
  } else if (law == "sector") {
    sector_result(call);    // refuses what has no shape
    sector_outline(radius, call.view(), order, points, outline, perimeter_part);
  } else if (law == "area_sector") {
    area_sector_result(call);    // likewise
    sector_outline(radius, call.view(), order, points, outline,
                   [&](const Opening &o, double ai, double ak) {
                     return area_sector(radius, o, ai, ak).part;
                   });
  } else {
    refuse("law is '" + law + "': it must be 'ring', 'sector' or 'area_sector'");
  }
  return to_numpy<Points>(outline.xy.data(), {outline.xy.size() / 2, 2});
}

Points curved_points(double radius, nb::handle angles, nb::handle lengths, nb::handle half_angles,
                     int points, bool same_area, nb::handle contact_angles)
{
  require_fine(points);
  require_positive("radius", radius);
  const std::vector<double> angle = vector_of("angle", angles),
                            length = vector_of("length", lengths),
                            half_angle = vector_of("half_angle", half_angles);
  const std::vector<double> contact_angle = contact_angles_of(contact_angles, angle.size());
  if (angle.size() != length.size() || angle.size() != half_angle.size())
    refuse("angle, length and half_angle must have the same length");
  std::vector<CurvedContact> contacts;
  for (std::size_t c = 0; c < angle.size(); ++c) {
    const bool is_film = contact_angle[c] > 0.0;
    if (length[c] < 0.0 && !is_film)
      refuse("length: lengths must not be negative, not " + shown_number(length[c]));
    if (!(std::fabs(half_angle[c]) < 0.5 * PI))
      refuse("half_angle: must lie between -pi/2 and pi/2, not " + shown_number(half_angle[c]));
    if (length[c] > 0.0 || is_film)
      contacts.push_back(
          {std::remainder(angle[c], 2.0 * PI), length[c], half_angle[c], contact_angle[c]});
  }
  Outline outline = {same_area};
  curved_outline(radius, std::move(contacts), points, outline);
  return to_numpy<Points>(outline.xy.data(), {outline.xy.size() / 2, 2});
}

Arcs arcs_of(double radius, nb::handle angle, nb::handle indentation, bool closed)
{
  if (!closed) {
    const std::vector<double> angles = vector_of("angle", angle);
    const auto [low, high] = std::minmax_element(angles.begin(), angles.end());
    if (!angles.empty() && *high - *low >= 2.0 * PI)
      refuse("angle spans " + std::to_string(*high - *low) + ": contacts of an arc lie in a turn");
  }
  Call call = checked(radius, angle, indentation);
  const int size = static_cast<int>(call.contacts.size());
  std::vector<double> rows;
  const auto add = [&](const Arc &arc) {
    rows.insert(rows.end(), {arc.x, arc.y, arc.radius, arc.from, arc.to});
  };
  if (closed && size < 2) {
    add({0.0, 0.0, radius, 0.0, 2.0 * PI});    // a circle
  } else {
    sort_by_angle(call.view(), call.order.data());
    for_each_sector(call.view(), call.order.data(), [&](int s, int i, int k, const Opening &o) {
      if (!closed && s + 1 == size) return;
      const Sector part =
          perimeter_part(o, call.contacts[i].indentation, call.contacts[k].indentation);
      refuse_coincident(part.length_i + part.shrinkage);
      add(sector_arc(radius, call.contacts[i], o, part));
    });
  }
  return to_numpy<Arcs>(rows.data(), {rows.size() / 5, 5});
}

Points points_of_arcs(nb::handle given, int points, bool same_area)
{
  require_fine(points);
  const nb::object array = contiguous(given);
  const auto rows = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(array);
  if (rows.ndim() != 2 || rows.shape(1) != 5)
    refuse("arcs must have the shape (m, 5): center x, y, radius, from, to");
  Outline outline = {same_area};
  for (std::size_t k = 0; k < rows.shape(0); ++k) {
    const double *row = rows.data() + 5 * k;
    const bool finite = std::all_of(row, row + 5, [](double v) { return std::isfinite(v); });
    // a whole turn may have been rounded up
    if (!finite || row[4] < row[3] || row[4] - row[3] > 2.0 * PI + 1e-9)
      refuse("arcs[" + std::to_string(k) +
             "] must be five finite numbers, the last two the ends of at most one turn");
    arc_outline({row[0], row[1], row[2], row[3], row[4]}, points, outline);
  }
  return to_numpy<Points>(outline.xy.data(), {outline.xy.size() / 2, 2});
}

double line_of(double distance, double radius_i, double radius_j)
{
  require_positive("distance", distance);
  require_positive("radius_i", radius_i);
  require_positive("radius_j", radius_j);
  return contact_line(distance, 1.0 / distance, radius_i, radius_j).indentation;
}

nb::object lines_of(nb::handle distances, nb::handle radii_i, nb::handle radii_j)
{
  const nb::object ndim = nb::module_::import_("numpy").attr("ndim");
  const auto is_scalar = [&](nb::handle given) { return nb::cast<int>(ndim(given)) == 0; };
  if (is_scalar(distances) && is_scalar(radii_i) && is_scalar(radii_j))
    return nb::cast(line_of(nb::cast<double>(nb::float_(distances)),
                            nb::cast<double>(nb::float_(radii_i)),
                            nb::cast<double>(nb::float_(radii_j))));
  const std::vector<double> distance = vector_of("distance", distances);
  const std::vector<double> radius_i = vector_of("radius_i", radii_i);
  const std::vector<double> radius_j = vector_of("radius_j", radii_j);
  if (distance.size() != radius_i.size() || distance.size() != radius_j.size())
    refuse("distance, radius_i and radius_j must have the same length");
  std::vector<double> indentation(distance.size());
  for (std::size_t k = 0; k < distance.size(); ++k)
    indentation[k] = line_of(distance[k], radius_i[k], radius_j[k]);
  return nb::cast(to_numpy(indentation));
}

}    // namespace

void deformable::bind_outlines(nb::module_ &m)
{
  m.def("outline", &outline_points, "law"_a, "radius"_a, "angle"_a, "indentation"_a,
        "points"_a = 180, "same_area"_a = false,
        R"(The outline that a law ('ring', 'sector' or 'area_sector') gives a particle.

Returns an array (m, 2), a closed polygon about the center, counterclockwise, the last point not
repeated; every point is exact, the ends of the contacts among them. `points` sets how fine a whole
turn is divided. With `same_area` the points between contacts lie a little outside, so that the polygon
has the area of the outline, 2e-4 more for 180 points. Parameters and errors as for the law.)");
  m.def("curved_outline", &curved_points, "radius"_a, "angle"_a, "length"_a, "half_angle"_a,
        "points"_a = 180, "same_area"_a = false, "contact_angle"_a = nb::none(),
        R"(The outline of a ring whose contacts are arcs.

As `outline`, from what `forced_ring` gives: its `support_radius` [length], and the `contact_length` L [length],
direction and half angle [rad] of each contact, and the angle at which the outline meets it, 0 if omitted [rad].
Raises ValueError for a negative length without such an angle, or a half angle of a quarter turn and more.)");
  m.def("sector_arcs", &arcs_of, "radius"_a, "angle"_a, "indentation"_a, "closed"_a = true,
        R"(The arcs of `sector`, one a sector, by rising angle.

Returns an array (m, 5): center x, y about the circle's center, radius [length], and the directions from
and to of the arc's normals [rad], from < to. Straight flats join them to the outline. Fewer than two
contacts leave the circle. With `closed` false the last contact is not joined to the first one: the
contacts divide an arc of the circle, whose two ends are contacts of indentation 0. Parameters and errors
as for `sector`.)");
  m.def("arc_outline", &points_of_arcs, "arcs"_a, "points"_a = 180, "same_area"_a = false,
        R"(The outline of arcs as `sector_arcs` gives them, as from `outline`.)");
  m.def("contact_line", &lines_of, "distance"_a, "radius_i"_a, "radius_j"_a,
        R"(Indentation of particle i by j, with the contact on the radical axis.

a_ij = R_i - (d^2 + R_i^2 - R_j^2)/2d [length]. Floats, or arrays of one length.)");
}
