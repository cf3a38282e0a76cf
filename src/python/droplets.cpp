#include "python/laws.h"

#include "kernels/batch_kernels.h"
#include "laws/droplet_film.h"
#include "response/droplet_blocks.h"

#include <nanobind/stl/string.h>

#include <array>
#include <cmath>

using namespace deformable;

namespace {

// One droplet, as the kernels know it.
struct Droplet {
  double radius, tension, load, facet, work, stretch;
  bool sticks;
  std::size_t contacts;
  std::vector<double> nx, ny, nz, f, indentation, tx, ty, tz, film_radius;

  double energy() const
  {
    double sum = -work;
    for (std::size_t c = 0; c < contacts; ++c) sum += force(c) * indentation[c];
    return sum;
  }
  double force(std::size_t c) const { return f[c] * radius * tension; }
  double pressure() const
  {
    double moment = 0.0;
    for (std::size_t c = 0; c < contacts; ++c) moment += force(c) * (radius - indentation[c]);
    return droplet_pressure(radius, tension, energy(), moment);
  }

  // da/dF
  std::vector<double> compliance() const
  {
    if (sticks) refuse("the compliance of a droplet with films is not known");
    std::vector<std::array<Dual, 3>> n(contacts);
    for (std::size_t c = 0; c < contacts; ++c) n[c] = {nx[c], ny[c], nz[c]};
    std::vector<Dual> forces(contacts);
    for (std::size_t c = 0; c < contacts; ++c) forces[c] = Dual::variable(f[c], c, contacts);
    const std::vector<double> none(contacts);
    const LoadedDroplet<Dual> loaded(forces, n, none, std::vector<Dual>(contacts),
                                     std::vector<std::array<Dual, 3>>(contacts));
    std::vector<double> matrix;
    for (const Dual &a : loaded.indentation)
      for (const double by : a.by) matrix.push_back(by / tension);
    return matrix;
  }
};

std::vector<double> normals_of(nb::handle given)
{
  std::vector<double> numbers = flat_vector_of("normals", given);
  if (numbers.size() % 3 != 0) refuse("normals must have 3 numbers for each contact");
  for (std::size_t c = 0; c < numbers.size(); c += 3) {
    double *const n = &numbers[c];
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0.0))
      refuse("normal " + std::to_string(c / 3) + " is 0: a contact needs a direction");
    for (int axis = 0; axis < 3; ++axis) n[axis] /= length;
  }
  return numbers;
}

std::vector<double> ratios_of(const std::string &name, nb::handle given, std::size_t z)
{
  if (given.is_none()) return std::vector<double>(z, 1.0);
  std::vector<double> ratios = vector_of(name, given);
  if (ratios.size() != z) refuse(name + " must have one value for each normal");
  for (const double ratio : ratios) require_positive(name, ratio);
  return ratios;
}

Droplet droplet(nb::handle given_normals, nb::handle given_forces, double radius, double tension,
                const std::string &level, nb::handle given_angles, nb::handle given_facet_ratios,
                nb::handle given_film_ratios)
{
  require_positive("radius", radius);
  require_positive("tension", tension);
  const std::vector<double> normals = normals_of(given_normals),
                            forces = vector_of("forces", given_forces);
  const std::size_t z = forces.size();
  if (normals.size() != 3 * z) refuse("forces must have one value for each normal");
  const BatchKernels *const kernels = batch_kernels(level);
  if (!kernels) refuse(why_no_kernels("level", level));

  const bool sticks = !given_angles.is_none();
  const std::vector<double> angles =
                                sticks ? vector_of("angles", given_angles) : std::vector<double>(z),
                            facet_ratios = ratios_of("facet_ratios", given_facet_ratios, z),
                            film_ratios = ratios_of("film_ratios", given_film_ratios, z);
  if (angles.size() != z) refuse("angles must have one value for each normal");
  for (std::size_t c = 0; c < z; ++c)
    if (!(angles[c] >= 0.0 && angles[c] <= MOST_FILM_ANGLE))
      refuse("angle " + std::to_string(c) + " is " + std::to_string(angles[c]) +
             ": contact angles must lie between 0 and 1 rad, and the law is for 0.7 at most");
  const DropletKernels &kernel = sticks ? kernels->sticking_droplets : kernels->droplets;

  std::vector<double> force(z + 1), x(z + 1), y(z + 1), n(z + 1);
  for (std::size_t c = 0; c < z; ++c) {
    if (!(forces[c] >= 0.0 || angles[c] > 0.0))
      refuse("force " + std::to_string(c) +
             " is negative: only films stick, of a contact angle above 0");
    force[c] = forces[c];
    x[c] = normals[3 * c];
    y[c] = normals[3 * c + 1];
    n[c] = normals[3 * c + 2];
  }
  // the other lanes of its batch have no contacts
  const std::size_t places = z * LANES, greens = z * (z - std::min<std::size_t>(z, 1)) / 2 * LANES,
                    first_green[] = {0, greens};
  const int size = static_cast<int>(z), first[] = {0, size * LANES}, none = 2 * size;
  std::vector<int> pair_side(places, none);
  for (std::size_t c = 0; c < z; ++c) pair_side[c * LANES] = 2 * static_cast<int>(c);
  const auto room = [&] { return std::vector<double>(places + 1); };
  std::vector<double> nx = room(), ny = room(), nz = room(), f = room(), still = room(), a = room(),
                      tx = room(), ty = room(), tz = room(), damping = room(), film = room(),
                      per_radii = room(), x_turn = room(), y_turn = room(), z_turn = room(),
                      each_green(greens), each_green2(greens), d_green(greens), scratch(7 * places),
                      sine = room(), rise = room(), lean(places + 1, 1.0), lean_log = room(),
                      film_radius = room(), curved = room(), pressure = room(), least = room();
  std::vector<double> radii(LANES, 1.0), tensions(LANES, 1.0), per_tension(LANES, 1.0), load(LANES),
      facet(LANES), work(LANES), still_work(LANES), total(LANES), stretch(LANES, 1.0), cover(LANES),
      bulge(LANES);
  for (std::size_t c = 0; c < z; ++c) {
    const double half = std::sin(0.5 * angles[c]);
    sine[c * LANES] = std::sin(angles[c]);
    rise[c * LANES] = 2.0 * half * half;
    lean[c * LANES] = film_ratios[c];
    lean_log[c * LANES] = std::log(film_ratios[c]);
    film[c * LANES] = std::log(facet_ratios[c]);
  }
  radii[0] = radius;
  tensions[0] = tension;
  per_tension[0] = 1.0 / tension;
  std::vector<float> taken(places), square(LANES), mixed(LANES), rate(LANES), share(places),
      compliance(places), each(places), green(greens);
  const std::vector<int> partner(places, static_cast<int>(places));    // walls
  RingBatches batch = {};
  batch.end = 1;
  batch.size = &size;
  batch.first = first;
  batch.first_green = first_green;
  batch.rings.radius = radii.data();
  batch.rings.work = work.data();
  batch.rings.total = total.data();
  batch.rings.per_pressure = per_tension.data();
  batch.rings.square = square.data();
  batch.rings.mixed = mixed.data();
  batch.rings.rate = rate.data();
  batch.rings.scale = 1.0;
  batch.contacts.pair_side = pair_side.data();
  batch.contacts.indentation = a.data();
  batch.contacts.compliance = compliance.data();
  batch.contacts.share = share.data();
  batch.contacts.green = green.data();
  batch.contacts.own = each.data();
  batch.contacts.scratch = scratch.data();
  batch.corrections.partner = partner.data();
  DropletArrays arrays = {};
  arrays.tension = tensions.data();
  arrays.film_log = film.data();
  arrays.per_radii = per_radii.data();
  arrays.load = load.data();
  arrays.facet = facet.data();
  arrays.still_work = still_work.data();
  arrays.still = still.data();
  arrays.nx = nx.data();
  arrays.ny = ny.data();
  arrays.nz = nz.data();
  arrays.force = f.data();
  arrays.tx = tx.data();
  arrays.ty = ty.data();
  arrays.tz = tz.data();
  arrays.damping = damping.data();
  arrays.torque_x = x_turn.data();
  arrays.torque_y = y_turn.data();
  arrays.torque_z = z_turn.data();
  arrays.taken = taken.data();
  arrays.green = each_green.data();
  arrays.green2 = each_green2.data();
  arrays.d_green = d_green.data();
  arrays.sine = sine.data();
  arrays.rise = rise.data();
  arrays.lean = lean.data();
  arrays.lean_log = lean_log.data();
  arrays.stretch = stretch.data();
  arrays.cover = cover.data();
  arrays.bulge = bulge.data();
  arrays.film_radius = film_radius.data();
  arrays.curved_by_pressure = curved.data();
  arrays.pressure = pressure.data();
  arrays.least = least.data();
  PairDirections pairs = {};
  pairs.force = force.data();
  pairs.nx = x.data();
  pairs.ny = y.data();
  pairs.nz = n.data();
  kernel.shape(batch, arrays, pairs);
  kernel.turn(batch, arrays);
  kernel.derive(batch, arrays);
  for (std::size_t c = 0; c < z; ++c)
    if (least[c * LANES] > forces[c])
      refuse("force " + std::to_string(c) + " is " + std::to_string(forces[c]) +
             ", but this film tears at " + std::to_string(least[c * LANES]));
  const auto own = [&](const std::vector<double> &by_place) {
    std::vector<double> found(z);
    for (std::size_t c = 0; c < z; ++c) found[c] = by_place[c * LANES];
    return found;
  };
  Droplet d;
  d.radius = radius;
  d.tension = tension;
  d.load = load[0];
  d.facet = facet[0];
  d.work = work[0];
  d.stretch = stretch[0];
  d.sticks = sticks;
  d.contacts = z;
  d.nx = own(nx);
  d.ny = own(ny);
  d.nz = own(nz);
  d.f = own(f);
  d.indentation = own(a);
  d.tx = own(x_turn);
  d.ty = own(y_turn);
  d.tz = own(z_turn);
  d.film_radius = own(film_radius);
  return d;
}

double standard_log(double x)
{
  return std::log(x);
}

nb::tuple film_term(double force, double pressure, double angle)
{
  require_positive("pressure", pressure);
  const double half = std::sin(0.5 * angle);
  const FilmTerm<double> u(force, std::log(some_force(force)), pressure, std::log(pressure),
                           std::sin(angle), 2.0 * half * half, standard_log);
  return nb::make_tuple(u.u, u.f, u.P, u.ff, u.fP, u.PP);
}

nb::tuple film_angles(double radius_i, double tension_i, double radius_j, double tension_j,
                      double adhesion)
{
  require_positive("radius_i", radius_i);
  require_positive("tension_i", tension_i);
  require_positive("radius_j", radius_j);
  require_positive("tension_j", tension_j);
  if (!(adhesion >= 0.0 && adhesion < 2.0 * std::min(tension_i, tension_j)))
    refuse("adhesion " + std::to_string(adhesion) +
           " must lie between 0 and twice the smaller tension");
  const FilmSide i = film_side(radius_i, tension_i, radius_j, tension_j, adhesion),
                 j = film_side(radius_j, tension_j, radius_i, tension_i, adhesion);
  return nb::make_tuple(i.angle(), j.angle(), i.lean, j.lean);
}

auto film_slopes(double radius_i, double tension_i, double radius_j, double tension_j,
                 double adhesion)
{
  constexpr std::size_t by = 5;
  const double given[by] = {radius_i, tension_i, radius_j, tension_j, adhesion};
  Dual x[by];
  for (std::size_t n = 0; n < by; ++n) {
    if (n != 3 || !std::isinf(given[n]))
      require_positive("argument " + std::to_string(n), given[n]);
    x[n] = Dual::variable(given[n], n, by);
  }
  const FilmSideOf<Dual> side = std::isinf(tension_j) ? film_side_of_wall(x[1], x[4])
                                                      : film_side(x[0], x[1], x[2], x[3], x[4]);
  std::vector<double> slopes(2 * by);
  const double cosine = 1.0 - side.rise.value;
  for (std::size_t n = 0; n < by; ++n) {
    if (!side.sine.by.empty()) slopes[n] = side.sine.by[n] / cosine;
    if (!side.lean.by.empty()) slopes[by + n] = side.lean.by[n];
  }
  return to_numpy<Matrix>(slopes.data(), {2, by});
}

nb::tuple curved_film(double force, double pressure_i, double pressure_j, double tension,
                      double angle)
{
  require_positive("pressure_i", pressure_i);
  require_positive("pressure_j", pressure_j);
  require_positive("tension", tension);
  const double half = std::sin(0.5 * angle);
  const CurvedFilm<double> film(force, pressure_i, pressure_j, tension, std::sin(angle),
                                2.0 * half * half, standard_log);
  return nb::make_tuple(film.energy, film.by_force, film.by_p_i, film.by_p_j);
}

}    // namespace

void deformable::bind_droplets(nb::module_ &m)
{
  m.attr("largest_bulge") = LARGEST_BULGE;
  m.attr("droplet_decay") = DECAY;
  nb::class_<Droplet>(m, "Droplet", "A droplet in three dimensions that bears given forces.")
      .def_ro("load", &Droplet::load, "x = sum F/(8 pi g R), the part that facets would cover")
      .def_ro("facet", &Droplet::facet,
              "y = sum F^2/(8 pi g R sum F), the part that the mean facet would cover")
      .def_ro("work", &Droplet::work, "W [energy]")
      .def_ro("stretch", &Droplet::stretch,
              "L, the radius of the outline that goes on behind films, over R; 1 without them")
      .def_prop_ro(
          "film_radius", [](const Droplet &d) { return to_numpy(d.film_radius); },
          nb::rv_policy::move, "of each contact where `angles` are given, (Z,) [length]")
      .def_prop_ro("energy", &Droplet::energy,
                   "F.a - W, what the surface has more than that of a sphere [energy]")
      .def_prop_ro("pressure", &Droplet::pressure, "pressure inside, 2 g/R at rest [energy/volume]")
      .def_prop_ro(
          "indentation", [](const Droplet &d) { return to_numpy(d.indentation); },
          nb::rv_policy::move, "a = dW/dF of each contact, (Z,) [length]")
      .def_prop_ro(
          "d_normal",
          [](const Droplet &d) {
            std::vector<double> rows;
            for (std::size_t c = 0; c < d.contacts; ++c)
              for (const auto *t : {&d.tx, &d.ty, &d.tz}) rows.push_back((*t)[c]);
            return to_numpy<Matrix>(rows.data(), {d.contacts, 3});
          },
          nb::rv_policy::move,
          "dW/dn of each normal, (Z, 3); only the part across it counts [energy]")
      .def_prop_ro(
          "compliance",
          [](const Droplet &d) {
            return to_numpy<Matrix>(d.compliance().data(), {d.contacts, d.contacts});
          },
          nb::rv_policy::move, "da/dF, (Z, Z); infinite for a force of 0 [length^2/energy]");

  m.def(
      "droplet", &droplet, "normals"_a, "forces"_a, "radius"_a = 1.0, "tension"_a = 1.0,
      "level"_a = "", "angles"_a = nb::none(), "facet_ratios"_a = nb::none(),
      "film_ratios"_a = nb::none(),
      R"(A droplet in three dimensions that keeps its volume, between contacts that bear these forces.

The work W(F) of docs/theory/droplets.md, as between walls, where films do not turn.

Parameters
----------
normals : array, shape (Z, 3)
    Outward directions of the contacts; their lengths do not matter.
forces : array, shape (Z,)
    F [energy/length], negative only in films that stick.
radius, tension : float
    R of the sphere [length] and g [energy/length^2].
level : str
    SIMD instructions, one of simd_levels(); by default the fastest ones of this processor.
angles : array, shape (Z,), optional
    theta of each film [rad], 0 of a contact that does not stick.
facet_ratios, film_ratios : array, shape (Z,), optional
    lambda of each contact without adhesion and with it, see film_angles; 1 of walls and of like droplets.

Returns
-------
Droplet

Raises
------
ValueError
    Values that are not finite, unequal lengths, a normal of length 0, a negative force without a film or below the one
    that tears it, an angle above 1 rad, an unknown level.

Source: D. C. Morse and T. A. Witten, Europhys. Lett. 22, 549 (1993), and docs/theory/droplets.md.)");

  m.def("film_term", &film_term, "force"_a, "pressure"_a, "angle"_a,
        R"(What a film adds to the work of a droplet, u(f, P) = pi int_0^theta r^2 sin psi dpsi.

r = (rho/2) [sin psi + sqrt(sin^2 psi + k)], k = 2 f/(pi rho), rho = 2/P, in units of the radius R and the tension g.

Parameters
----------
force, pressure, angle : float
    f [g R], P [g/R] and theta [rad].

Returns
-------
tuple of 6 floats
    u, u_f, u_P, u_ff, u_fP, u_PP.

Raises
------
ValueError
    A pressure that is not positive.

Source: src/laws/droplet_film.h.)");

  m.def("film_slopes", &film_slopes, "radius_i"_a, "tension_i"_a, "radius_j"_a, "tension_j"_a,
        "adhesion"_a,
        R"(Derivatives of the contact angle and lambda of side i of `film_angles`.

Parameters
----------
radius_i, tension_i, radius_j, tension_j, adhesion : float
    As of `film_angles`, above 0; an infinite tension_j is a wall.

Returns
-------
array, shape (2, 5)
    Of theta_i and of lambda_i, by the arguments.

Raises
------
ValueError
    A number is not positive.

Source: src/laws/droplet_film.h.)");

  m.def(
      "film_angles", &film_angles, "radius_i"_a, "tension_i"_a, "radius_j"_a, "tension_j"_a,
      "adhesion"_a,
      R"(Contact angles of the film between two droplets, by Neumann's triangle, and lambda of both sides.

cos theta_i = (g_f^2 + g_i^2 - g_j^2)/(2 g_f g_i), g_f = g_i + g_j - w; lambda_i = g_j (C_j + C_i R_i/R_j)/g_f at w/2.

Parameters
----------
radius_i, tension_i, radius_j, tension_j : float
    R [length] and g [energy/length^2] of both.
adhesion : float
    w [energy/length^2].

Returns
-------
tuple of 4 floats
    theta_i, theta_j [rad], lambda_i, lambda_j.

Raises
------
ValueError
    Radii and tensions that are not positive; an adhesion that is not below twice the smaller tension.

Source: src/laws/droplet_film.h.)");

  m.def(
      "curved_film", &curved_film, "force"_a, "pressure_i"_a, "pressure_j"_a, "tension"_a,
      "angle"_a,
      R"(What a film between droplets of one tension and unlike pressures has beside film_term of both sides.

2 pi g ((p_i - p_j)/4 g)^2 int_0^theta r^4 (1/4 - s/q) s dpsi, with the mean pressure in r.

Parameters
----------
force : float
    F [energy/length].
pressure_i, pressure_j : float
    Inside of both [energy/volume].
tension, angle : float
    g [energy/length^2] and theta [rad].

Returns
-------
tuple of 4 floats
    The term [energy] and its derivatives by the force and by both pressures.

Raises
------
ValueError
    A pressure or a tension that is not positive.

Source: src/laws/droplet_film.h.)");
}
