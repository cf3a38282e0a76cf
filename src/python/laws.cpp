#include "python/laws.h"

#include "laws/friction.h"
#include "laws/parameter_rules.h"
#include "laws/ring.h"

#include <cmath>
#include <limits>
#include <nanobind/stl/optional.h>
#include <optional>
#include <utility>

using namespace deformable;

void deformable::refuse_coincident(double change)
{
  if (!std::isfinite(change))
    refuse("angle: two contacts have the same direction, which leaves no sector between them; use "
           "the ring law");
}

namespace {

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

}    // namespace

Sector deformable::perimeter_part(const Opening &o, double ai, double ak)
{
  return sector(sector_coefficients(o), ai, ak);
}

Result deformable::sector_result(Call &call)
{
  Shape shape;
  sector_shape(call.radius, call.view(), call.order.data(), shape);
  refuse_coincident(shape.area_deficit);
  return with_arcs(call, std::move(shape), perimeter_part);
}

Result deformable::area_sector_result(Call &call)
{
  Shape shape;
  if (!area_sector_shape(call.radius, call.view(), call.order.data(), shape))
    refuse("indentation: these contacts leave no room for a sector of this area");
  refuse_coincident(shape.perimeter_excess);
  return with_arcs(call, std::move(shape), [&](const Opening &o, double ai, double ak) {
    return area_sector(call.radius, o, ai, ak).part;
  });
}

Result deformable::ring_result(Call &call)
{
  std::vector<char> is_active(call.contacts.size(), 0);
  RingLCP lcp;
  Result result = {{}, call.contacts.size(), false, {}};
  ring_shape(call.radius, call.view(), is_active.data(), lcp, result.shape);
  return result;
}

namespace {

template <Result (*LAW)(Call &)>
Result evaluate(double radius, nb::handle angle, nb::handle indentation)
{
  Call call = checked(radius, angle, indentation);
  return LAW(call);
}

}    // namespace

void deformable::bind_laws(nb::module_ &m)
{
  const auto vector = [](double Response::*member) {
    return [member](const Result &r) {
      return per_contact(r.contacts, [&](std::size_t c) { return r.shape.contact[c].*member; });
    };
  };
  nb::class_<Result>(m, "Shape", "The shape that a contact law gives a particle.")
      .def_prop_ro(
          "area_deficit", [](const Result &r) { return r.shape.area_deficit; },
          "S = A0 - A [length^2]; zero for a law that conserves the area")
      .def_prop_ro(
          "perimeter_excess", [](const Result &r) { return r.shape.perimeter_excess; },
          "P - P0 [length]; zero for a law that conserves the perimeter")
      .def_prop_ro("d_indentation", vector(&Response::d_indentation), nb::rv_policy::move,
                   "derivatives of the area deficit or perimeter excess by the indentations, (z,)")
      .def_prop_ro("d_angle", vector(&Response::d_angle), nb::rv_policy::move,
                   "derivatives of the area deficit or perimeter excess by the directions, (z,)")
      .def_prop_ro("contact_length", vector(&Response::length), nb::rv_policy::move,
                   "length of each contact [length], (z,)")
      .def_prop_ro(
          "arc_radius",
          [](const Result &r) -> nb::object {
            if (!r.has_sectors) return nb::cast(r.shape.arc_radius);
            return nb::cast(to_numpy(r.arc_radii));
          },
          "sector laws: radius of each arc [length], (z,), the n-th from the n-th smallest\n"
          "angle to the next; ring law: the smallest radius of curvature of the free outline, a\n"
          "float. Negative: beyond the model.");

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
    R minus the distance of each contact line from the center [length].

Returns
-------
Shape
    Derivatives are those of the area deficit. Fewer than two contacts leave a circle.

Raises
------
ValueError
    Unequal lengths, values that are not finite, radius <= 0, a contact line behind the center, or two
    contacts in the same direction.

Source: R. Maharana, "Efficient Simulation of Deformable Particles".)");
  m.def("area_sector", &evaluate<area_sector_result>, "radius"_a, "angle"_a, "indentation"_a,
        R"(Contacts that stick: each sector between two contacts keeps its area R^2 phi/2.

Parameters and errors as for `sector`; ValueError too where no such sector exists. Derivatives are
those of the perimeter excess. Source: docs/theory/sector.md, "Sectors that keep their area".)");
  m.def("ring", &evaluate<ring_result>, "radius"_a, "angle"_a, "indentation"_a,
        R"(Contacts that slip: an inextensible ring takes the shape of largest area.

S = 1/2 a.L with L >= 0, a - G L <= 0, L.(a - G L) = 0 and G(t) = [1/2 + cos t/4 - (pi - t) sin t/2]/pi.
Lines outside the circle (negative indentation) matter where the outline bulges up to them.

Parameters and errors as for `sector`, but contacts may coincide. Derivatives are those of the area
deficit. Source: docs/theory/laws.md, "Ring".)");
}

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

Here and below all parameters of a ring but the skin, such as `tension`, follow in their order or by name. kA and kP must be
positive; one of them may be inf. Beside a positive tension kP is finite, and may be 0.)");
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
  m.def(
      "invalid_for_droplet_film",
      [](double adhesion, double tension, std::optional<double> partner) {
        for (const double each : {tension, partner.value_or(tension)}) {
          const Stiffness droplet = {Stiffness::INF, 0.0, each};
          const std::string problem = invalid_for_adhesion(adhesion, droplet, 0.0);
          if (!problem.empty()) return or_none(problem);
        }
        const double rise = partner ? std::max(film_rise(tension, *partner, adhesion),
                                               film_rise(*partner, tension, adhesion))
                                    : film_side_of_wall(tension, adhesion).rise;
        return or_none(invalid_for_droplet_film(adhesion, rise));
      },
      "adhesion"_a, "tension"_a, "partner"_a = nb::none(),
      R"(The problem of a droplet in space that sticks to another one, or to a wall, or None.

Args:
    adhesion: by area [energy/length^2].
    tension: of the droplet [energy/length^2].
    partner: tension of the other one; of a wall None.

Tensions must be above half of the adhesion, and contact angles at most 1.)");
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
      [](double mu, double kt, double gt, double damp, double film, double power,
         double restitution) {
        Friction c = {mu, kt, gt, damp, film, power};
        c.restitution = restitution;
        return or_none(invalid_friction(c));
      },
      "mu"_a, "kt"_a, "gt"_a = 0.0, "damp"_a = 0.0, "film"_a = 0.0, "power"_a = 1.0,
      "restitution"_a = 1.0,
      R"(The problem of these coefficients in a phrase that names the value, or None.

None of them may be negative; mu may be inf. The power of a film lies above 0, and is 1 at most; so does the restitution, beside
which damp must be 0 if it is below 1.)");
}
