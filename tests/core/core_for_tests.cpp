// What only tests call: kernels for particles side by side, and parts of laws that Python has no use for. Compiled for the tests
// (DEFORMABLE_FOR_TESTS), into lammps_deformable.core_for_tests.

#include "python/arguments.h"

#include "geometry/polygon.h"
#include "kernels/block_walk.h"
#include "kernels/processor.h"
#include "laws/friction.h"
#include "laws/parameter_rules.h"
#include "laws/sector.h"
#include "laws/soft_ring.h"

#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <numeric>

using namespace deformable;

namespace {

struct BatchResult {
  ContactBlock block;
  std::vector<double> fx, fy, length;    // of each contact, in the order of the input
  int one_by_one = 0;
};

// The laws for one particle, as the pair styles call them.
struct OneByOne {
  Shape shape;
  RingLCP lcp;
  std::vector<char> is_active;
  std::vector<int> order;

  Energy ring(const BlockParticle &p, const Contacts &contacts)
  {
    is_active.assign(contacts.size, 0);
    Energy energy;
    if (!soft_ring_shape(p.ring_radius, p.stiffness, contacts, is_active.data(), lcp, shape,
                         energy))
      refuse("dx: these contacts leave no room for a ring of this area");
    return energy;
  }

  Energy sector(const BlockParticle &p, const Contacts &contacts)
  {
    order.resize(contacts.size);
    std::iota(order.begin(), order.end(), 0);
    if (!std::isinf(p.stiffness.kP)) refuse("kP: these sectors conserve their perimeter");
    sector_shape(p.radius, contacts, order.data(), shape);
    if (!std::isfinite(shape.area_deficit)) refuse("angle: two contacts have the same direction");
    return harmonic(p.stiffness.kA, shape.area_deficit);
  }
};

BatchResult batch(const std::string &law, const std::string &level,
                  const std::vector<int> &contacts, nb::handle dx_, nb::handle dy_,
                  nb::handle partner_radius, nb::handle radius_, const std::vector<double> &kA,
                  const std::vector<double> &kP, nb::handle skin_, std::vector<double> tension)
{
  const bool is_ring = law == "ring";
  if (!is_ring && law != "sector") refuse("law: '" + law + "' is neither 'ring' nor 'sector'");
  const BatchKernels *const kernels = batch_kernels(level == "one" ? "" : level);
  if (!kernels) refuse(why_no_kernels("level", level));

  const std::vector<double> dx = vector_of("dx", dx_), dy = vector_of("dy", dy_);
  const std::vector<double> rj = vector_of("partner_radius", partner_radius);
  const std::vector<double> radius = vector_of("radius", radius_), skin = vector_of("skin", skin_);
  const std::size_t n = contacts.size();
  const std::size_t places = std::accumulate(contacts.begin(), contacts.end(), std::size_t{0});
  if (dx.size() != places || dy.size() != places || rj.size() != places)
    refuse("contacts: their sum must be the length of dx, dy and partner_radius");
  if (radius.size() != n || skin.size() != n || kA.size() != n || kP.size() != n)
    refuse("radius: it must be as long as contacts, and kA, kP and skin too");
  if (tension.empty()) tension.assign(n, 0.0);
  if (tension.size() != n) refuse("tension: it must be as long as contacts");

  BatchResult result;
  ContactBlock &block = result.block;
  block.clear(static_cast<int>(n));
  for (std::size_t i = 0, c = 0; i < n; ++i) {
    BlockParticle &p = block.particles[i];
    block.place(p, static_cast<int>(i), radius[i], skin[i], {kA[i], kP[i], tension[i]},
                contacts[i]);
    int front = p.first;
    for (const std::size_t end = c + contacts[i]; c < end; ++c) {
      const bool touches =
          dx[c] * dx[c] + dy[c] * dy[c] <= (radius[i] + rj[c]) * (radius[i] + rj[c]);
      block.places[touches ? front++ : --p.others] = {dx[c], dy[c], rj[c], 0.0,
                                                      0.0,   0.0,   0.0,   static_cast<int>(c)};
    }
    p.active = front - p.first;
  }

  OneByOne one;
  const auto group_of = [&](const BlockParticle &p) {
    if (level == "one") return 0;
    return is_ring ? ring_group(p) : sector_group(p);
  };
  shape_block(block, is_ring ? kernels->ring : kernels->sector, true, one.shape, group_of,
              [&](BlockParticle &p, const Contacts &at) {
                ++result.one_by_one;
                for (int c = 0; c < at.size; ++c)
                  if (!(at[c].indentation < p.radius))
                    refuse("dx: a contact line does not lie in front of the center");
                const Energy energy = is_ring ? one.ring(p, at) : one.sector(p, at);
                p.pressure = energy.derivative;
                return energy;
              });

  for (std::vector<double> *v : {&result.fx, &result.fy, &result.length}) v->assign(places, 0.0);
  for (const BlockParticle &p : block.particles)
    for (int k = p.first; k < p.first + p.active; ++k) {
      const Place &place = block.places[k];
      result.fx[place.partner] = place.fx;
      result.fy[place.partner] = place.fy;
      result.length[place.partner] = place.length;
    }
  return result;
}

void bind_batches(nb::module_ &m)
{
  const auto particles = [](double BlockParticle::*member) {
    return [member](const BatchResult &r) {
      return per_contact(r.block.particles.size(),
                         [&](std::size_t i) { return r.block.particles[i].*member; });
    };
  };
  const auto move = nb::rv_policy::move;
  nb::class_<BatchResult>(m, "Batch", "Shapes and forces of many particles.")
      .def_prop_ro("energy", particles(&BlockParticle::energy), move, "energies, (n,)")
      .def_prop_ro("pressure", particles(&BlockParticle::pressure), move,
                   "dU/dS: pressures [energy/length^2], (n,)")
      .def_prop_ro("area_deficit", particles(&BlockParticle::area_deficit), move,
                   "A0 - A [length^2], (n,)")
      .def_prop_ro("perimeter_excess", particles(&BlockParticle::perimeter_excess), move,
                   "P - P0 [length], (n,)")
      .def_prop_ro("arc_radius", particles(&BlockParticle::arc_radius), move,
                   "smallest radii of curvature [length], (n,)")
      .def_prop_ro(
          "force",
          [](const BatchResult &r) {
            std::vector<double> xy;
            for (std::size_t c = 0; c < r.fx.size(); ++c) {
              xy.push_back(r.fx[c]);
              xy.push_back(r.fy[c]);
            }
            return to_numpy<Matrix>(xy.data(), {r.fx.size(), 2});
          },
          move, "force of each contact on its particle [energy/length], (contacts, 2)")
      .def_prop_ro(
          "contact_length",
          [](const BatchResult &r) {
            return per_contact(r.length.size(), [&](std::size_t c) { return r.length[c]; });
          },
          move, "length of each contact [length], (contacts,)")
      .def_ro("one_by_one", &BatchResult::one_by_one,
              "number of particles that the law for one particle has shaped");

  m.def("batch", &batch, "law"_a, "level"_a, "contacts"_a, "dx"_a, "dy"_a, "partner_radius"_a,
        "radius"_a, "kA"_a, "kP"_a, "skin"_a, "tension"_a = std::vector<double>{},
        R"(Shapes and forces of many particles by the code that the pair styles run.

Contact lines lie on the radical axes with partners at (dx, dy).

Parameters
----------
law : str
    'ring' or 'sector'.
level : str
    One of `simd_levels()`, or 'one' for the laws of one particle, the reference.
contacts : sequence of int, shape (n,)
    Number of contacts of each particle.
dx, dy, partner_radius : array, shape (sum of contacts,)
    From the center of the particle to its partner, and the partner's radius [length]; those of the
    first particle first.
radius, skin : array, shape (n,)
    Radii of the particles, and the thickness of their skins [length].
kA, kP : sequence of float, shape (n,)
    Stiffness, see `soft_ring`; sectors have kP = inf.
tension : sequence of float, shape (n,)
    Line tensions, see `soft_ring`; none by default.

Returns
-------
Batch

Raises
------
ValueError
    Unknown law or level, lengths that do not fit, a contact line behind the center, or contacts that
    leave no shape.)");
}

void require(const Friction &c, double dt)
{
  const std::string problem = invalid_friction(c);
  if (!problem.empty()) refuse(problem);
  require_positive("dt", dt);
}

void bind_friction(nb::module_ &m)
{
  m.def(
      "rub",
      [](double mu, double kt, double gt, double xi, double way, double dt, double normal) {
        const Friction c = {mu, kt, gt, 0.0};
        require(c, dt);
        const Rub<double> now = rub(c, xi, way, dt, normal);
        return nb::make_tuple(now.xi, now.force, now.slides);
      },
      "mu"_a, "kt"_a, "gt"_a, "xi"_a, "way"_a, "dt"_a, "normal"_a,
      R"(A step of the spring of length xi along a contact whose sides move by `way` against each other.

f = kt xi + gt dxi/dt, held to abs(f) <= mu max(normal, 0); where it slides, dxi/dt = (f - kt xi)/gt. Returns xi and f at the
end of the step, and whether it slides. `normal` is the force that presses then.

Raises
------
ValueError
    A coefficient that is negative or no number, or a step dt that is not positive.)");
  m.def(
      "rub_loss",
      [](double kt, double xi_before, double force_before, double xi, double force, double way) {
        const Rub<double> before = {xi_before, force_before, false}, now = {xi, force, false};
        const RubLoss lost = loss(kt, before, now, way);
        return nb::make_tuple(lost.sliding, lost.dashpot);
      },
      "kt"_a, "xi_before"_a, "force_before"_a, "xi"_a, "force"_a, "way"_a,
      R"(Energies that a step loses by sliding, F (way - dxi), and in the dashpot, (F - kt mean(xi)) dxi.

F is the mean force of both ends of the step. With the change of kt xi^2/2 their sum is the work F way.)");
  m.def(
      "film_constant",
      [](double film, double power, double size, double speed, double most) {
        Friction c;
        c.film = film;
        c.power = power;
        require(c, 1.0);
        return film_constant(c, size, speed, most);
      },
      "film"_a, "power"_a, "size"_a, "speed"_a, "most"_a,
      R"(Force over speed of a film of this size, c S v^(n-1): for n < 1 not above `most`.)");
  m.def(
      "turned",
      [](const std::array<double, 3> &v, const std::array<double, 3> &n,
         const std::array<double, 3> &m) {
        const Vector3 found =
            turned(Vector3{v[0], v[1], v[2]}, {n[0], n[1], n[2]}, {m[0], m[1], m[2]});
        return nb::make_tuple(found.x, found.y, found.z);
      },
      "v"_a, "n"_a, "m"_a, R"(v after the shortest rotation that takes the unit vector n to m.)");
  m.def(
      "contact_damping",
      [](double damp, double way, double dt, double normal) {
        require({0.0, 0.0, 0.0, damp}, dt);
        return damping(damp, way, dt, normal);
      },
      "damp"_a, "way"_a, "dt"_a, "normal"_a,
      R"(Force damp way/dt along the normal, positive where the sides separate, at most max(normal, 0).)");
}

}    // namespace

NB_MODULE(core_for_tests, m)
{
  m.doc() = "What only the tests of lammps-deformable call.";
  bind_batches(m);
  bind_friction(m);
  m.def(
      "nearest_on_polygon",
      [](nb::handle nx, nb::handle ny, nb::handle offset, double x, double y) {
        const NearestPoint point = nearest_on_polygon(polygon_of(nx, ny, offset), x, y);
        if (!(point.height > 0.0)) return nb::object(nb::none());
        return nb::object(nb::make_tuple(point.nx, point.ny, point.height, point.turn));
      },
      "nx"_a, "ny"_a, "offset"_a, "x"_a, "y"_a,
      R"(The contact of a particle at (x, y) with the polygon nx x + ny y <= offset, None inside.

Direction (two components), distance, and rotation of the direction per sideways step: 0 on a side,
1/distance at a corner.)");
  m.def(
      "invalid_radius", [](double radius) { return or_none(invalid_radius(radius)); }, "radius"_a,
      R"(The problem of this radius in a phrase that names its value, or None: it must be positive and finite.)");
}
