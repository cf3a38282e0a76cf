#include "python/arguments.h"

#include "laws/parameter_rules.h"
#include "python/tables.h"

#include <cmath>

using namespace deformable;

void deformable::refuse(const std::string &message)
{
  throw nb::value_error(message.c_str());
}

std::vector<double> deformable::vector_of(const std::string &name, nb::handle given)
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

Table deformable::table_of(const std::string &name, nb::handle given, std::size_t columns)
{
  const nb::object array =
      nb::module_::import_("numpy").attr("ascontiguousarray")(given, "dtype"_a = "float64");
  Table table;
  if (!nb::try_cast(array, table) || table.shape(1) != columns)
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
