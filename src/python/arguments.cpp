#include "python/arguments.h"

#include "laws/parameter_rules.h"

#include <nanobind/stl/string.h>

#include <algorithm>
#include <cmath>

using namespace deformable;

void deformable::refuse(const std::string &message)
{
  throw nb::value_error(message.c_str());
}

nb::object deformable::contiguous(nb::handle given)
{
  return nb::module_::import_("numpy").attr("ascontiguousarray")(given, "dtype"_a = "float64");
}

std::vector<double> deformable::vector_of(const std::string &name, nb::handle given)
{
  const nb::object array = contiguous(given);
  const auto values = nb::cast<nb::ndarray<const double, nb::c_contig, nb::device::cpu>>(array);
  if (values.ndim() != 1)
    refuse(name + " has " + std::to_string(values.ndim()) + " dimensions: it must have one");
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!std::isfinite(values.data()[k]))
      refuse(name + "[" + std::to_string(k) + "] is " + std::to_string(values.data()[k]) +
             ": it must be finite");
  return {values.data(), values.data() + values.size()};
}

std::vector<double> deformable::flat_vector_of(const std::string &name, nb::handle given)
{
  return vector_of(name, nb::module_::import_("numpy").attr("ravel")(given));
}

Table deformable::table_of(const std::string &name, nb::handle given, std::size_t columns)
{
  Table table;
  if (!nb::try_cast(contiguous(given), table) || table.shape(1) != columns)
    refuse(name + " must have rows of " + std::to_string(columns) + " numbers");
  return table;
}

std::vector<double> deformable::contact_angles_of(nb::handle given, std::size_t contacts)
{
  std::vector<double> angles(contacts, 0.0);
  if (!given.is_none()) angles = vector_of("contact_angle", given);
  if (angles.size() != contacts)
    refuse("contact_angle must have the length of angle, " + std::to_string(contacts) + ", not " +
           std::to_string(angles.size()));
  for (const double angle : angles)
    if (!(angle >= 0.0 && angle < PI))
      refuse("contact_angle must lie between 0 and pi, not " + shown_number(angle));
  return angles;
}

Stiffness deformable::stiffness_of(double kA, double kP, const nb::args &more,
                                   const nb::kwargs &named)
{
  Stiffness k = {kA, kP};
  std::size_t place = 0, found = 0;
  for (int n = FIRST_KEYWORD; n < MEMBERS; ++n) {
    const Parameter &p = PARAMETERS[n];
    if (!p.name) continue;
    const bool by_name = named.contains(p.name), by_place = place < more.size();
    if (by_name && by_place)
      throw nb::type_error((std::string(p.name) + " is given twice").c_str());
    if (by_place) k.*p.of_ring = nb::cast<double>(more[place++]);
    if (by_name) k.*p.of_ring = nb::cast<double>(named[p.name]);
    found += by_name;
  }
  if (place < more.size()) throw nb::type_error("too many parameters of a ring");
  if (found < named.size())
    for (const auto &[name, value] : named) {
      const std::string given = nb::cast<std::string>(name);
      if (std::none_of(PARAMETERS, PARAMETERS + MEMBERS,
                       [&](const Parameter &p) { return p.name && given == p.name; }))
        throw nb::type_error((given + " is no parameter of a ring").c_str());
    }
  return k;
}

nb::object deformable::or_none(const std::string &problem)
{
  return problem.empty() ? nb::none() : nb::object(nb::str(problem.c_str()));
}

std::vector<Edge> deformable::polygon_of(nb::handle nx, nb::handle ny, nb::handle offset)
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
  std::vector<Edge> edges;
  if (!intersect(planes, edges)) refuse("the half planes have no point in common");
  return edges;
}

void deformable::require_positive(const std::string &name, double value)
{
  if (!(value > 0.0) || !std::isfinite(value))
    refuse(name + " is " + std::to_string(value) + ": it must be positive and finite");
}

Call deformable::checked(double radius, nb::handle angles, nb::handle indentations)
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
             ": the contact line lies behind the center (radius " + std::to_string(radius) + ")");

  // The kernels need all angles within one turn; such angles are not touched.
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
