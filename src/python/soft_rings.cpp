#include "python/laws.h"

#include "laws/contact_stiffness.h"
#include "laws/parameter_rules.h"
#include "laws/soft_ring.h"

#include <cmath>

using namespace deformable;

namespace {

struct SoftResult {
  double radius;    // of the undeformed ring
  Shape shape;
  std::size_t contacts;
  Energy energy;
};

SoftResult soft_ring(const Call &call, const Stiffness &stiffness, double skin)
{
  const double radius = call.radius;
  refuse_invalid(radius, stiffness, skin);

  std::vector<char> is_active(call.contacts.size(), 0);
  RingLCP lcp;
  SoftResult result = {radius - skin, {}, call.contacts.size(), {}};
  if (!soft_ring_shape(result.radius, stiffness, call.view(), is_active.data(), lcp, result.shape,
                       result.energy))
    refuse("indentation: these contacts leave no room for a ring of this stiffness and area");
  return result;
}

SoftResult soft_ring_result(double radius, nb::handle angle, nb::handle indentation, double kA,
                            double kP, double skin, const nb::args &more, const nb::kwargs &named)
{
  return soft_ring(checked(radius, angle, indentation), stiffness_of(kA, kP, more, named), skin);
}

Matrix stiffness_of_contacts(double radius, nb::handle angle, nb::handle indentation, double kA,
                             double kP, double skin, const nb::args &more, const nb::kwargs &named)
{
  const Call call = checked(radius, angle, indentation);
  const Stiffness stiffness = stiffness_of(kA, kP, more, named);
  const SoftResult result = soft_ring(call, stiffness, skin);
  const Shape &shape = result.shape;
  std::vector<int> active;
  for (std::size_t c = 0; c < result.contacts; ++c)
    if (shape.contact[c].length > 0.0) active.push_back(static_cast<int>(c));

  const std::size_t z = result.contacts, n = active.size();
  std::vector<double> inverse(n * n), rate, block(n * n), full(z * z, 0.0);
  RingLCP lcp;
  green_inverse(call.view(), static_cast<int>(n), active.data(), lcp, inverse.data());
  contact_stiffness({result.radius, shape.perimeter_excess / (2.0 * PI), stiffness,
                     result.energy.derivative, call.view(), shape.contact.data()},
                    static_cast<int>(n), active.data(), inverse.data(), rate, block.data());
  for (std::size_t m = 0; m < n; ++m)
    for (std::size_t k = 0; k < n; ++k) full[active[m] * z + active[k]] = block[m * n + k];
  return to_numpy<Matrix>(full.data(), {z, z});
}

}    // namespace

void deformable::bind_soft_rings(nb::module_ &m)
{
  const auto soft_vector = [](auto &&value) {
    return [value](const SoftResult &r) {
      return per_contact(r.contacts, [&](std::size_t c) {
        return value(r.shape.contact[c], r.energy.derivative);
      });
    };
  };
  nb::class_<SoftResult>(m, "SoftShape", "A ring in equilibrium between its contacts.")
      .def_prop_ro(
          "energy", [](const SoftResult &r) { return r.energy.value; },
          "U, see `soft_ring` [energy]")
      .def_prop_ro(
          "pressure", [](const SoftResult &r) { return r.energy.derivative; },
          "p = tension/r + kA (A0 - A), or the limit of it where kA is infinite [energy/length^2]")
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
          "radial expansion of the ring, (P - P0)/2 pi [length]")
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

  m.def("soft_ring", &soft_ring_result, "radius"_a, "angle"_a, "indentation"_a, "kA"_a, "kP"_a,
        "skin"_a = 0.0, "more"_a, "named"_a,
        R"(Contacts that slip, of a ring that resists a change of area and one of perimeter.

The ring of radius r = R - skin expands by the delta that minimizes
U = kA/2 (A - A0)^2 + kP/2 (P - P0)^2 + tension (P - P0) - (tension/r) (A - A0) at
A = pi (r + delta)^2 - S, P = 2 pi (r + delta), where S is that of `ring` at the indentations
a + delta. Its outline, skin included, is outline("ring", R + delta, angle, a + delta).

Parameters
----------
radius, angle, indentation
    As for `ring`.
kA : float
    Stiffness of the area [energy/length^4]; inf: the area is conserved.
kP : float
    Stiffness of the perimeter [energy/length^2]; inf: the perimeter is conserved; 0 beside a tension.
skin : float
    Thickness of the rigid shell around the ring [length].
tension : float
    Line tension of the perimeter at rest [energy/length]; 0 if omitted.

Returns
-------
SoftShape
    Derivatives are those of the energy.

Raises
------
ValueError
    As for `ring`; a stiffness that is not positive, or both infinite; a tension that is negative,
    beside kP = inf, or above 2 pi r (kP + kA r^2); a skin outside [0, radius); contacts that leave no room.

Source: docs/theory.md, "Rings that expand".)");
  m.def("contact_stiffness", &stiffness_of_contacts, "radius"_a, "angle"_a, "indentation"_a, "kA"_a,
        "kP"_a, "skin"_a = 0.0, "more"_a, "named"_a,
        R"(Derivatives of the forces of `soft_ring` with respect to the indentations.

Returns the symmetric matrix dF_c/da_c' (z, z) of F_c = dU/da_c [energy/length^2], zero in rows and columns
of contacts that are not active. Parameters and errors as for `soft_ring`.

Source: docs/theory.md, "Balanced contacts".)");
}
