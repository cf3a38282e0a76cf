#include "laws.h"

#include "parameter_rules.h"

#include <limits>

using namespace deformable;

namespace {

// None if there is no problem.
nb::object or_none(const std::string &problem)
{
  return problem.empty() ? nb::none() : nb::object(nb::str(problem.c_str()));
}

}    // namespace

void deformable::bind_rules(nb::module_ &m)
{
  m.def(
      "invalid_radius", [](double radius) { return or_none(invalid_radius(radius)); }, "radius"_a,
      R"(The problem of this radius in a phrase that names its value, or None: it must be positive and finite.)");
  m.def(
      "invalid_stiffness", [](double kA, double kP) { return or_none(invalid_stiffness(kA, kP)); },
      "kA"_a, "kP"_a,
      R"(The problem of these stiffnesses in a phrase that names the value, or None.

Both must be positive; one of them may be inf.)");
  m.def(
      "invalid_skin",
      [](double skin, double radius) { return or_none(invalid_skin(skin, radius)); }, "skin"_a,
      "radius"_a = std::numeric_limits<double>::infinity(),
      R"(The problem of this skin in a phrase that names its value, or None.

It must be from 0 to below the radius; without a radius, 0 or positive and finite.)");
  m.def(
      "invalid_for_sectors",
      [](double kA, double kP, double skin) { return or_none(invalid_for_sectors(kA, kP, skin)); },
      "kA"_a, "kP"_a, "skin"_a = 0.0,
      R"(The problem of valid stiffnesses and a skin for the sector law, or None.

One of kA and kP must be inf, and the skin 0.)");
}
