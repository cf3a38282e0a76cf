#include "laws/contact_curve.h"
#include "laws/green.h"
#include "laws/parameter_rules.h"
#include "laws/soft_ring.h"
#include "python/laws.h"
#include "response/curved_hessian.h"
#include "response/ring_blocks.h"

#include <cmath>
#include <numeric>

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
*more, **named : float
    All other parameters of a ring, in their order or by name: `tension`, the line tension of the perimeter at rest
    [energy/length], 0 if omitted.

Returns
-------
SoftShape
    Derivatives are those of the energy.

Raises
------
ValueError
    As for `ring`; a stiffness that is not positive, or both infinite; a tension that is negative,
    beside kP = inf, or above 2 pi r (kP + kA r^2); a skin outside [0, radius); contacts that leave no room.

Source: docs/theory/laws.md, "Rings that expand".)");
  m.def("contact_stiffness", &stiffness_of_contacts, "radius"_a, "angle"_a, "indentation"_a, "kA"_a,
        "kP"_a, "skin"_a = 0.0, "more"_a, "named"_a,
        R"(Derivatives of the forces of `soft_ring` with respect to the indentations.

Returns the symmetric matrix dF_c/da_c' (z, z) of F_c = dU/da_c [energy/length^2], zero in rows and columns
of contacts that are not active. Parameters and errors as for `soft_ring`.

Source: docs/theory/lines.md, "Balanced contacts".)");
}

namespace {

struct ForcedRing {
  Stiffness stiffness = {};
  RingLoad load = {0.0, 0.0};
  LoadedRing ring;
  double radius = 0.0;
  double force = 0.0;    // the sum of all; the load has more where contacts are curved
  std::vector<double> indentation, length, slope, slope_rate, d_angle, compliance;
};

// The load of a ring whose outline meets films at these angles, see contact_curve.h, by its load without them; `product` gets
// p (a + delta) of each contact.
RingLoad load_with_films(const CurvedLoad<double> &without, const std::vector<double> &force,
                         const std::vector<double> &contact_angle, const std::vector<double> &u,
                         double T, std::vector<double> &product)
{
  double perimeter = 0.0, linear = 0.0, square = 0.0;
  std::vector<double> depth;
  for (std::size_t c = 0; c < force.size(); ++c) {
    const FilmTerms<double> terms =
        film_terms(std::tan(0.5 * contact_angle[c]), u[c],
                   [](double cosine, double sine) { return std::atan2(sine, cosine); });
    perimeter += terms.perimeter;
    linear += force[c] * terms.linear;
    square += terms.square;
    depth.push_back(terms.depth);
  }
  const CurvedLoad<double> load =
      film_load(without.work, without.total, T, perimeter, linear, square);
  for (std::size_t c = 0; c < force.size(); ++c) product[c] += T * depth[c] + load.shift;
  return {load.work, load.total};
}

ForcedRing forced_ring(double radius, nb::handle angles, nb::handle forces, double kA, double kP,
                       double skin, const nb::args &more, nb::handle half_angles,
                       nb::handle contact_angles, const nb::kwargs &named)
{
  require_positive("radius", radius);
  const std::vector<double> angle = vector_of("angle", angles), force = vector_of("force", forces);
  const std::vector<double> half_angle = half_angles.is_none()
                                             ? std::vector<double>(force.size(), 0.0)
                                             : vector_of("half_angle", half_angles);
  if (half_angle.size() != force.size())
    refuse("half_angle and force must have the same length, not " +
           std::to_string(half_angle.size()) + " and " + std::to_string(force.size()));
  if (angle.size() != force.size())
    refuse("angle and force must have the same length, not " + std::to_string(angle.size()) +
           " and " + std::to_string(force.size()));
  const std::vector<double> contact_angle = contact_angles_of(contact_angles, force.size());
  const bool sticks = std::any_of(contact_angle.begin(), contact_angle.end(),
                                  [](double theta) { return theta > 0.0; });
  const Stiffness stiffness = stiffness_of(kA, kP, more, named);
  const double tension = stiffness.tension;
  refuse_invalid(radius, stiffness, skin);
  if (sticks && (tension == 0.0 || skin != 0.0))
    refuse("contact_angle: needs a tension and a skin of 0, not " + shown_number(tension) +
           " and " + shown_number(skin));
  const std::size_t z = force.size();
  ForcedRing result;
  result.stiffness = stiffness;
  result.radius = radius - skin;
  std::vector<double> g(z * z), u;
  for (std::size_t c = 0; c < z; ++c) {
    if (force[c] < 0.0 && contact_angle[c] == 0.0)
      refuse("force: forces must not be negative, not " + shown_number(force[c]));
    if (!(std::fabs(half_angle[c]) <= PI / 6.0 + 1e-12))
      refuse("half_angle: contacts bend by pi/6 at most, not " + shown_number(half_angle[c]));
    u.push_back(std::tan(0.5 * half_angle[c]));
    for (std::size_t k = 0; k < z; ++k) {
      const double t = std::fabs(std::remainder(angle[c] - angle[k], 2.0 * PI));
      g[c * z + k] = green(t, std::sin(t), std::cos(t));
    }
  }
  const RingSums<double> sums = ring_sums(force, angle, u);
  const std::vector<double> &d_green_force = sums.turning;
  std::vector<double> green_force = sums.product;
  result.force = std::accumulate(force.begin(), force.end(), 0.0);
  result.load = {sums.load.work, sums.load.total};
  // Films depend on the tension, which depends on them by kP only.
  double T = tension, before = sticks ? 0.0 : T;
  for (int n = 0; n == 0 || (n < 200 && std::fabs(T - before) > 1e-15 * T); ++n) {
    if (sticks) {
      green_force = sums.product;
      result.load = load_with_films(sums.load, force, contact_angle, u, T, green_force);
    }
    if (!find_pressure(result.radius, result.stiffness, result.load, result.ring))
      refuse("force: no ring of this stiffness bears these forces");
    before = T;
    if (sticks) T = stiffness.line_tension(result.ring.expansion);
  }

  const double p = result.ring.pressure;
  const RingCompliance C =
      compliance_of(result.radius, result.stiffness, result.load.work, result.ring);
  result.compliance.resize(z * z);
  for (std::size_t c = 0; c < z; ++c) {
    const double b = green_force[c] * C.per_pressure;
    const double straight = sums.product[c] - sums.load.shift + 0.5 * u[c] * force[c];    // Gf
    result.indentation.push_back(b - result.ring.expansion);
    result.length.push_back(p > 0.0 ? force[c] / p : 0.0);
    double along = 0.0;
    for (std::size_t k = 0; k < z; ++k) along += force[k] * std::cos(angle[c] - angle[k]);
    result.slope.push_back(d_green_force[c] * C.per_pressure);
    result.slope_rate.push_back(slope_rate(result.force * C.per_pressure, along * C.per_pressure,
                                           straight * C.per_pressure, result.length[c]));
    result.d_angle.push_back(-force[c] * d_green_force[c] * C.per_pressure);
    for (std::size_t k = 0; k < z; ++k) {
      const double other = green_force[k] * C.per_pressure;
      result.compliance[c * z + k] =
          g[c * z + k] * C.per_pressure - C.mixed * (b + other) - C.square * b * other + C.rate;
    }
  }
  return result;
}

}    // namespace

void deformable::bind_ring_forces(nb::module_ &m)
{
  m.attr("green_at_zero") = GREEN_AT_ZERO;
  m.attr("largest_tilt") = std::asin(LARGEST_SINE);
  m.attr("largest_half_angle") = 2.0 * std::atan(LARGEST_BEND);
  const auto vector = [](std::vector<double> ForcedRing::*values) {
    return [values](const ForcedRing &r) { return to_numpy(r.*values); };
  };
  nb::class_<ForcedRing>(m, "ForcedRing", "A ring that bears given forces.")
      .def_prop_ro(
          "energy",
          [](const ForcedRing &r) { return r.ring.energy(r.radius, r.stiffness, r.load.work); },
          "U, see `soft_ring` [energy]")
      .def_prop_ro(
          "conjugate",
          [](const ForcedRing &r) { return r.ring.conjugate(r.radius, r.stiffness, r.load); },
          "W(f) = max over a of f.a - U(a), without contact angles [energy]")
      .def_prop_ro(
          "pressure", [](const ForcedRing &r) { return r.ring.pressure; },
          "p = tension/r + kA (A0 - A) [energy/length^2]")
      .def_prop_ro(
          "delta", [](const ForcedRing &r) { return r.ring.expansion; },
          "radial expansion of the ring, (P - P0)/2 pi [length]")
      .def_prop_ro(
          "support_radius",
          [](const ForcedRing &r) {
            if (!(r.ring.pressure > 0.0)) return r.radius;
            const double more = (r.load.total - r.force) / (2.0 * PI * r.ring.pressure);
            return r.radius + r.ring.expansion - more;
          },
          "E of the support function H = E - sum L G between contacts, without the skin [length]")
      .def_prop_ro("indentation", vector(&ForcedRing::indentation), nb::rv_policy::move,
                   "a = dW/df of each contact [length], (z,)")
      .def_prop_ro("contact_length", vector(&ForcedRing::length), nb::rv_policy::move,
                   "L = f/p of each contact [length], (z,)")
      .def_prop_ro("slope", vector(&ForcedRing::slope), nb::rv_policy::move,
                   "t = -dH/dtheta of the outline at each contact, sum L G', (z,) [length]")
      .def_prop_ro("slope_rate", vector(&ForcedRing::slope_rate), nb::rv_policy::move,
                   "dt/dtheta of each contact while all lengths L stay, sum L G'', (z,) [length]")
      .def_prop_ro(
          "tension", [](const ForcedRing &r) { return tension(r.radius, r.ring, r.load.total); },
          "T = p q of the outline [energy/length]")
      .def_prop_ro("d_angle", vector(&ForcedRing::d_angle), nb::rv_policy::move,
                   "dU/dtheta = -dW/dtheta of each contact [energy], (z,)")
      .def_prop_ro(
          "compliance",
          [](const ForcedRing &r) {
            const std::size_t z = r.length.size();
            return to_numpy<Matrix>(r.compliance.data(), {z, z});
          },
          nb::rv_policy::move, "C = da/df [length^2/energy], (z, z)");

  m.def("forced_ring", &forced_ring, "radius"_a, "angle"_a, "force"_a, "kA"_a, "kP"_a,
        "skin"_a = 0.0, "more"_a, "half_angle"_a = nb::none(), "contact_angle"_a = nb::none(),
        "named"_a,
        R"(The ring of `soft_ring` with given forces in place of given indentations.

W(f) = max over a of f.a - U(a) is the convex conjugate of the energy U(a). Its derivatives are the
indentations a and, with the other sign, dU/dtheta.

Parameters
----------
radius, angle, kA, kP, skin, *more, **named
    As for `soft_ring`.
force : array_like, shape (z,)
    The force of each contact, not negative unless it has a contact angle [energy/length].
half_angle : array_like, shape (z,), optional
    Half angle of each contact line, an arc: positive where it is convex for this ring; straight if omitted
    [rad]. Indentations are those of its middle, and `compliance` is that of straight lines.
contact_angle : array_like, shape (z,), optional
    Angle at which the outline meets the film of each contact; 0 if omitted [rad]. It needs a tension. The energy
    is that of the ring alone, without what the film gains.

Returns
-------
ForcedRing

Raises
------
ValueError
    As for `soft_ring`; a negative force; forces that no ring with this stiffness bears.

Source: docs/theory/lines.md, "Balanced contacts".)");
}
