#include "laws/friction.h"
#include "laws/parameter_rules.h"
#include "python/laws.h"

#include <limits>

using namespace deformable;

void deformable::refuse_invalid(double radius, const Stiffness &k, double skin)
{
  for (const std::string &problem : {invalid_stiffness(k), invalid_skin(skin, radius)})
    if (!problem.empty()) refuse(problem);
  const std::string unstable = unstable_radius(radius - skin, k);
  if (!unstable.empty()) refuse(unstable);
}

void deformable::bind_rules(nb::module_ &m)
{
  m.def(
      "invalid_stiffness",
      [](double kA, double kP, const nb::args &more, const nb::kwargs &named) {
        return or_none(invalid_stiffness(stiffness_of(kA, kP, more, named)));
      },
      "kA"_a, "kP"_a, "more"_a, "named"_a,
      R"(The problem of these stiffnesses in a phrase that names the value, or None.

Here and below all parameters of a ring but the skin, such as `tension`, follow in their order or by name. kA and kP must be positive; one of them may be inf. Beside a positive tension kP is finite, and may be 0.)");
  m.def(
      "unstable_radius",
      [](double radius, double kA, double kP, const nb::args &more, const nb::kwargs &named) {
        return or_none(unstable_radius(radius, stiffness_of(kA, kP, more, named)));
      },
      "radius"_a, "kA"_a, "kP"_a, "more"_a, "named"_a,
      R"(The problem of valid stiffnesses for a ring of this radius, without its skin, or None.

kP + kA R^2 must be above tension/(2 pi R): otherwise the ring collapses without any contact.)");
  m.def(
      "invalid_skin",
      [](double skin, double radius) { return or_none(invalid_skin(skin, radius)); }, "skin"_a,
      "radius"_a = std::numeric_limits<double>::infinity(),
      R"(The problem of this skin in a phrase that names its value, or None.

It must be from 0 to below the radius; without a radius, 0 or positive and finite.)");
  m.def(
      "invalid_for_sectors",
      [](double kA, double kP, double skin, const nb::args &more, const nb::kwargs &named) {
        return or_none(invalid_for_sectors(stiffness_of(kA, kP, more, named), skin));
      },
      "kA"_a, "kP"_a, "skin"_a = 0.0, "more"_a, "named"_a,
      R"(The problem of valid stiffnesses and a skin for the sector law, or None.

One of kA and kP must be inf, the skin and all other parameters 0.)");
  m.def(
      "invalid_for_droplets",
      [](double kA, double kP, double skin, const nb::args &more, const nb::kwargs &named) {
        return or_none(invalid_for_droplets(stiffness_of(kA, kP, more, named), skin));
      },
      "kA"_a, "kP"_a, "skin"_a = 0.0, "more"_a, "named"_a,
      R"(The problem of valid stiffnesses and a skin for droplets in three dimensions, or None.

kA must be inf, the tension positive, the skin and all other parameters 0.)");
  m.def(
      "invalid_adhesion", [](double adhesion) { return or_none(invalid_adhesion(adhesion)); },
      "adhesion"_a,
      R"(The problem of this adhesion in a phrase that names its value, or None: it must be 0 or positive and finite.)");
  m.def(
      "invalid_for_adhesion",
      [](double adhesion, double kA, double kP, double skin, const nb::args &more,
         const nb::kwargs &named) {
        return or_none(invalid_for_adhesion(adhesion, stiffness_of(kA, kP, more, named), skin));
      },
      "adhesion"_a, "kA"_a, "kP"_a, "skin"_a = 0.0, "more"_a, "named"_a,
      R"(The problem of valid stiffnesses and a skin for a particle of this adhesion, or None.

Its tension must be above half of the adhesion, kP finite, the skin 0.)");
}

void deformable::bind_friction(nb::module_ &m)
{
  m.def(
      "friction_time_step",
      [](double mu, double kt, double gt, double damp, double mass, double lever) {
        const Friction c = {mu, kt, gt, damp};
        const std::string problem = invalid_friction(c);
        if (!problem.empty()) refuse(problem);
        require_positive("mass", mass);
        return largest_time_step(c, mass, lever);
      },
      "mu"_a, "kt"_a, "gt"_a, "damp"_a, "mass"_a, "lever"_a,
      R"(The largest time step of fix deformable/friction for particles of this mass.

kt dt^2 + 2 gt dt = mass/(2 lever) and 2 damp dt = mass/2, with lever = 1 + m R^2/I: 3.5 for spheres, 3 for disks, 1 without
spins. A quarter of what one contact alone is stable with.)");
  m.def(
      "invalid_friction",
      [](double mu, double kt, double gt, double damp) {
        return or_none(invalid_friction({mu, kt, gt, damp}));
      },
      "mu"_a, "kt"_a, "gt"_a = 0.0, "damp"_a = 0.0,
      R"(The problem of these coefficients in a phrase that names the value, or None.

None of them may be negative; mu may be inf.)");
}
