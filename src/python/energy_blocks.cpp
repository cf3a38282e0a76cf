#include "response/energy_blocks.h"
#include "python/arguments.h"
#include "python/laws.h"
#include "response/droplet_blocks.h"
#include "response/ring_blocks.h"

#include <algorithm>
#include <cmath>

using namespace deformable;

namespace {

// Rows, columns and values of a matrix.
nb::tuple entries_of(const EnergyBlocks &e)
{
  return nb::make_tuple(to_numpy(e.row), to_numpy(e.column), to_numpy(e.value));
}

// None: no axes.
EnergyBlocks disk_blocks(nb::handle given, nb::handle given_turn, nb::handle given_contact,
                         nb::handle given_axes)
{
  const std::size_t dimension =
      nb::cast<std::size_t>(nb::module_::import_("numpy").attr("shape")(given)[nb::int_(-1)]);
  if (dimension != 2 && dimension != 3)
    refuse("vectors must have two or three components, not " + std::to_string(dimension));
  const Table vectors = table_of("vectors", given, dimension),
              axes = table_of("axes", given_axes.is_none() ? given : given_axes, dimension);
  const std::vector<double> turn = vector_of("turn", given_turn),
                            contact = vector_of("contact", given_contact);
  const double none[3] = {};
  if (turn.size() != vectors.shape(0) || contact.size() != vectors.shape(0) ||
      axes.shape(0) != vectors.shape(0))
    refuse("turn, contact and axes must have one value for each vector");
  EnergyBlocks result;
  for (std::size_t c = 0; c < turn.size(); ++c) {
    const double *const v = vectors.data() + dimension * c;
    const double *const axis = given_axes.is_none() ? none : axes.data() + dimension * c;
    double square = 0.0;
    for (std::size_t k = 0; k < dimension; ++k) square += v[k] * v[k];
    if (!(square > 0.0 && std::isfinite(square)))
      refuse("vector " + std::to_string(c) + " has no direction, which a contact needs");
    if (dimension == 2)
      add_disk_contact<2>(v, turn[c], axis, contact[c], result);
    else
      add_disk_contact<3>(v, turn[c], axis, contact[c], result);
  }
  return result;
}

// Columns of the tables of droplets and of their sides.
enum DropletColumn { SIDES_OF_DROPLET, DROPLET_RADIUS, DROPLET_TENSION, DROPLET_COLUMNS };
enum DropletSideColumn {
  DROPLET_TURN = 3,
  DROPLET_AXIS,
  DROPLET_OVERLAP = DROPLET_AXIS + 3,
  DROPLET_PART,
  DROPLET_FILM,
  DROPLET_FORCE,
  DROPLET_ANGLE,
  DROPLET_WEIGHT,
  DROPLET_SIDE_COLUMNS = DROPLET_WEIGHT + 3
};

void require_angle(std::size_t side, double angle)
{
  if (!(angle >= 0.0 && angle <= MOST_FILM_ANGLE))
    refuse("contact angle of side " + std::to_string(side) + " is " + std::to_string(angle) +
           ", not between 0 and " + std::to_string(MOST_FILM_ANGLE));
}

// use(sides, radius, tension) of each droplet.
template <class Use>
void for_droplets(nb::handle given_droplets, nb::handle given_sides, Use &&use)
{
  const Table droplets = table_of("droplets", given_droplets, DROPLET_COLUMNS),
              sides = table_of("sides", given_sides, DROPLET_SIDE_COLUMNS);
  std::vector<DropletSide> of_droplet;
  for_particles(
      droplets, sides, [&](std::size_t i, const double *of, std::size_t begin, std::size_t end) {
        const std::string name = "droplet " + std::to_string(i);
        require_positive("radius of " + name, of[DROPLET_RADIUS]);
        require_positive("tension of " + name, of[DROPLET_TENSION]);
        of_droplet.clear();
        for (std::size_t n = begin; n < end; ++n) {
          const double *const s = sides.data() + DROPLET_SIDE_COLUMNS * n;
          const double *const axis = s + DROPLET_AXIS, *const w = s + DROPLET_WEIGHT;
          const double square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
          if (!(square > 0.0 && std::isfinite(square)))
            refuse("vector " + std::to_string(n) + " has no direction, which a contact needs");
          if (!std::all_of(s, s + DROPLET_SIDE_COLUMNS, [](double x) { return std::isfinite(x); }))
            refuse("side " + std::to_string(n) + " is not finite");
          require_angle(n, s[DROPLET_ANGLE]);
          if (s[DROPLET_ANGLE] == 0.0)
            require_positive("force of side " + std::to_string(n), s[DROPLET_FORCE]);
          of_droplet.push_back({{{s[0], s[1], s[2]}, s[DROPLET_TURN], {axis[0], axis[1], axis[2]}},
                                s[DROPLET_OVERLAP],
                                s[DROPLET_PART],
                                s[DROPLET_FILM],
                                s[DROPLET_FORCE],
                                std::sin(s[DROPLET_ANGLE]),
                                {w[0], w[1], w[2]}});
        }
        use(of_droplet, of[DROPLET_RADIUS], of[DROPLET_TENSION]);
      });
}

nb::tuple droplet_blocks(nb::handle droplets, nb::handle sides, bool turning)
{
  EnergyBlocks blocks, facets;
  for_droplets(droplets, sides,
               [&](const std::vector<DropletSide> &of, double radius, double tension) {
                 add_droplet(of, radius, tension, turning, blocks, facets, nullptr);
               });
  return nb::make_tuple(blocks, entries_of(facets));
}

nb::tuple droplet_parameters(nb::handle droplets, nb::handle sides, bool turning)
{
  EnergyBlocks blocks, facets;
  ParameterBlocks parameters;
  for_droplets(droplets, sides,
               [&](const std::vector<DropletSide> &of, double radius, double tension) {
                 add_droplet(of, radius, tension, turning, blocks, facets, &parameters);
               });
  return nb::make_tuple(to_numpy(parameters.gradient), entries_of(parameters));
}

enum StretchedColumn { STRETCH = DROPLET_COLUMNS, PRESSURE, STRETCHED_COLUMNS };
enum StretchSideColumn { STRETCH_FORCE, STRETCH_ANGLE, STRETCH_LEAN, STRETCH_SIDE_COLUMNS };

EnergyBlocks stretches(nb::handle given_droplets, nb::handle given_sides,
                       ParameterBlocks *parameters)
{
  const Table droplets = table_of("droplets", given_droplets, STRETCHED_COLUMNS),
              sides = table_of("sides", given_sides, STRETCH_SIDE_COLUMNS);
  EnergyBlocks blocks;
  std::vector<StretchSide> of_droplet;
  for_particles(droplets, sides,
                [&](std::size_t i, const double *of, std::size_t begin, std::size_t end) {
                  const std::string name = " of droplet " + std::to_string(i);
                  require_positive("radius" + name, of[DROPLET_RADIUS]);
                  require_positive("tension" + name, of[DROPLET_TENSION]);
                  require_positive("stretch" + name, of[STRETCH]);
                  require_positive("pressure" + name, of[PRESSURE]);
                  of_droplet.clear();
                  for (std::size_t n = begin; n < end; ++n) {
                    const double *const s = sides.data() + STRETCH_SIDE_COLUMNS * n;
                    if (!std::isfinite(s[STRETCH_FORCE]))
                      refuse("force of side " + std::to_string(n) + " is not finite");
                    require_angle(n, s[STRETCH_ANGLE]);
                    require_positive("lambda of side " + std::to_string(n), s[STRETCH_LEAN]);
                    of_droplet.push_back({s[STRETCH_FORCE], s[STRETCH_ANGLE], s[STRETCH_LEAN]});
                  }
                  add_stretch(of_droplet, of[DROPLET_RADIUS], of[DROPLET_TENSION], of[STRETCH],
                              of[PRESSURE], blocks, parameters);
                });
  return blocks;
}

EnergyBlocks stretch_blocks(nb::handle droplets, nb::handle sides)
{
  return stretches(droplets, sides, nullptr);
}

nb::tuple stretch_parameters(nb::handle droplets, nb::handle sides)
{
  ParameterBlocks parameters;
  stretches(droplets, sides, &parameters);
  return nb::make_tuple(to_numpy(parameters.gradient), entries_of(parameters));
}

enum CapColumn {
  CAP_FORCE,
  CAP_P_I,
  CAP_P_J,
  CAP_R_I,
  CAP_R_J,
  CAP_TENSION,
  CAP_ANGLE,
  CAP_COLUMNS
};

EnergyBlocks caps(nb::handle given, ParameterBlocks *parameters)
{
  const Table films = table_of("films", given, CAP_COLUMNS);
  EnergyBlocks blocks;
  for (std::size_t n = 0; n < films.size() / CAP_COLUMNS; ++n) {
    const double *const s = films.data() + CAP_COLUMNS * n;
    for (int c = CAP_P_I; c <= CAP_TENSION; ++c)
      require_positive("column " + std::to_string(c) + " of film " + std::to_string(n), s[c]);
    if (!std::isfinite(s[CAP_FORCE]))
      refuse("force of film " + std::to_string(n) + " is not finite");
    require_angle(n, s[CAP_ANGLE]);
    add_cap(s[CAP_FORCE], {s[CAP_P_I], s[CAP_P_J]}, {s[CAP_R_I], s[CAP_R_J]}, s[CAP_TENSION],
            s[CAP_ANGLE], blocks, parameters);
  }
  return blocks;
}

EnergyBlocks cap_blocks(nb::handle films)
{
  return caps(films, nullptr);
}

nb::tuple cap_parameters(nb::handle films)
{
  ParameterBlocks parameters;
  caps(films, &parameters);
  return nb::make_tuple(to_numpy(parameters.gradient), entries_of(parameters));
}

auto facets_of_droplets(nb::handle droplets, nb::handle sides)
{
  std::vector<double> rows;
  for_droplets(droplets, sides,
               [&](const std::vector<DropletSide> &of, double radius, double tension) {
                 const DropletFacets found = droplet_facets(of, radius, tension);
                 for (const auto &place : found.place)
                   rows.insert(rows.end(), {place[0], place[1], place[2], found.damping});
               });
  return to_numpy<Matrix>(rows.data(), {rows.size() / 4, 4});
}

}    // namespace

void deformable::bind_energy_blocks(nb::module_ &m)
{
  nb::class_<EnergyBlocks>(m, "EnergyBlocks",
                           "An energy with its first and second derivatives by local variables.")
      .def_ro("energy", &EnergyBlocks::energy, "sum over all contacts or particles [energy]")
      .def_prop_ro(
          "gradient", [](const EnergyBlocks &e) { return to_numpy(e.gradient); },
          nb::rv_policy::move, "derivatives by the local variables, (V,)")
      .def("hessian", &entries_of,
           "Second derivatives by the local variables, as rows, columns and values.");

  m.def(
      "disk_blocks", &disk_blocks, "vectors"_a, "turn"_a, "contact"_a, "axes"_a = nb::none(),
      R"(The energy U = o^2/2 of contacts of soft disks or spheres, and its derivatives by their vectors v and lengths.

The overlap is o = contact - |v|, and dU/dcontact = o. With the direction n of v, and the direction c of its part across the axis, dU/dv = -o n and
d^2U/dv dv = n n^T - o turn (1 - axis axis^T - c c^T).

Parameters
----------
vectors : array, shape (M, 2) or (M, 3)
    The vector v of each contact, from a center to that of a neighbor or to the nearest point of a wall [length].
turn : array, shape (M,)
    Angle by which n turns for a step of v across it and the axis: 1/|v| for a neighbor, 0 for a flat wall [1/length].
contact : array, shape (M,)
    Distance at which they touch: R_i + R_j, or R_i for a wall [length].
axes : array, shape (M, 2) or (M, 3)
    Axis of a cylinder or cone, a unit vector; 0 for all others, the default.

Returns
-------
EnergyBlocks
    The local variables are the components of v, then `contact`, of each contact, one after the other.

Raises
------
ValueError
    Unequal lengths, values that are not finite, a vector without length.

Source: docs/theory/response.md.)");

  m.def(
      "droplet_blocks", &droplet_blocks, "droplets"_a, "sides"_a, "turning"_a = false,
      R"(The dual energy of droplets, and its derivatives by the vectors to their neighbors and by their forces.

L = sum part F o - W(F, n), with W of `droplet`, the overlap o and the direction n of the vector v. Films that may turn are not in
it.

Parameters
----------
droplets : array, shape (N, 3)
    Number of sides, radius [length] and tension [energy/length^2] of each droplet.
sides : array, shape (S, 15)
    Of each side v_x, v_y, v_z [length], turn [1/length] and axis (three numbers) of `disk_blocks`, the overlap o = R_i + R_j - |v|,
    of a wall R_i - |v| [length], its part of it (1/2, of a wall 1), the logarithm ln(lambda) of its facet without adhesion, its force
    F [energy/length], which is positive where the angle is 0, the contact angle of a film that sticks [rad], and three numbers w: the
    second derivatives have the further term -g R^2 w.t, with the place R t of the facet beside the line of centers. The sides of the
    first droplet come first. Of droplets with films W is the part W_0 of the law; `stretch_blocks` has the other one.
turning : bool
    Whether turns of sides about their droplet, with v, are variables too, as of a wall that turns.

Returns
-------
EnergyBlocks, tuple of array
    The local variables are v_x, v_y, v_z and F, then angles about x, y and z, of each side after the other. The derivatives of R t by them, as rows, columns and
    values: three rows for each side.

Raises
------
ValueError
    Tables that do not fit each other, values that are not positive or not finite.

Source: docs/theory/response.md.)");

  m.def("stretch_blocks", &stretch_blocks, "droplets"_a, "sides"_a,
        R"(What films that stick add to the dual energy of droplets, and its derivatives.

In units of R and g R, with the volume V0 = 4 pi/3, the contact angle theta and lambda of each film, minus

    sum u(f, P lambda; theta) + P V0 (L^3 - 1) - (L - 1) sum (f - f^2/(8 pi)) - 4 pi (L^2 - 1)

It is stationary in the pressure P and in the stretch L, the radius of the outline that goes on behind the films.

Parameters
----------
droplets : array, shape (N, 5)
    Number of sides, radius [length], tension [energy/length^2], L and P of each droplet.
sides : array, shape (S, 3)
    Of each side the force F [energy/length], the contact angle [rad], 0 without a film, and lambda of `film_angles`.

Returns
-------
EnergyBlocks
    The local variables are F of the sides of a droplet, then its L and P.

Raises
------
ValueError
    Tables that do not fit each other, values that are not positive or not finite, an angle above 1 rad.

Source: src/laws/droplet_film.h.)");

  m.def("cap_blocks", &cap_blocks, "films"_a,
        R"(Minus the energy of `curved_film`, and its derivatives.

Parameters
----------
films : array, shape (M, 7)
    Of each film F [energy/length], P_i and P_j in units of g/R, R_i and R_j [length], the tension g [energy/length^2] and the contact
    angle [rad].

Returns
-------
EnergyBlocks
    The local variables are F, P_i and P_j of each film.

Raises
------
ValueError
    Values that are not positive or not finite, an angle above 1 rad.

Source: src/laws/droplet_film.h.)");

  m.def("droplet_parameters", &droplet_parameters, "droplets"_a, "sides"_a, "turning"_a = false,
        R"(How the energy of `droplet_blocks` depends on parameters, while its local variables stay.

Parameters
----------
droplets, sides, turning
    As of `droplet_blocks`.

Returns
-------
array, tuple of array
    Derivatives of the energy by ln(lambda) and the contact angle of each side of a droplet, then by its radius and tension,
    and those of its gradient by the same numbers, as rows, columns and values.

Raises
------
ValueError
    As `droplet_blocks`.

Source: src/response/droplet_blocks.h.)");

  m.def(
      "stretch_parameters", &stretch_parameters, "droplets"_a, "sides"_a,
      R"(The same of `stretch_blocks`, by the contact angle and lambda of each side, then by radius and tension.

Parameters
----------
droplets, sides
    As of `stretch_blocks`.

Returns
-------
array, tuple of array
    As of `droplet_parameters`.

Raises
------
ValueError
    As `stretch_blocks`.

Source: src/response/droplet_blocks.h.)");

  m.def("cap_parameters", &cap_parameters, "films"_a,
        R"(The same of `cap_blocks`, by R_i, R_j, the tension and the contact angle of each film.

Parameters
----------
films
    As of `cap_blocks`.

Returns
-------
array, tuple of array
    As of `droplet_parameters`.

Raises
------
ValueError
    As `cap_blocks`.

Source: src/response/droplet_blocks.h.)");

  m.def("droplet_facets", &facets_of_droplets, "droplets"_a, "sides"_a,
        R"(Where the facets of droplets are, and how much less films turn at large loads.

Parameters
----------
droplets, sides
    As of `droplet_blocks`.

Returns
-------
array, shape (S, 4)
    R t of each side [length], and D = exp(-0.65 x) of its droplet.

Raises
------
ValueError
    As `droplet_blocks`.

Source: docs/theory/droplets.md.)");
}

namespace {

// Columns of the tables of particles and of sides.
enum ParticleColumn { SIDES, RADIUS, KA, KP, SKIN, MORE };
enum SideColumn { X, Y, TURN, PARTNER, PLACE, SIDE_COLUMNS };

// As many columns as particles have parameters.
Table particles_of(nb::handle given)
{
  const auto is_named = [](const Parameter &p) { return p.name != nullptr; };
  return table_of("particles", given,
                  MORE - FIRST_KEYWORD + std::count_if(PARAMETERS, PARAMETERS + MEMBERS, is_named));
}

// Columns of sides with curved lines.
enum CurvedColumn { FORCE = PLACE, DIRECTED, HALF_ANGLE, CURVED_COLUMNS };

// ring(particle, stiffness, rows of its sides) of each particle.
template <class Ring> void for_rings(const Table &particles, const Table &sides, Ring &&ring)
{
  for_particles(
      particles, sides, [&](std::size_t i, const double *of, std::size_t begin, std::size_t end) {
        Stiffness stiffness = {of[KA], of[KP]};
        for (int n = FIRST_KEYWORD, column = MORE; n < MEMBERS; ++n)
          if (PARAMETERS[n].name) stiffness.*PARAMETERS[n].of_ring = of[column++];
        refuse_invalid(of[RADIUS], stiffness, of[SKIN]);
        if (!ring(of, stiffness, begin, end))
          refuse("particle " + std::to_string(i) + ": its contacts leave no room for its area");
      });
}

RingBlocks ring_blocks(const std::string &law, nb::handle given_particles, nb::handle given_sides,
                       bool parameters)
{
  if (law != "radical" && law != "balanced") refuse("law must be radical or balanced, not " + law);
  const bool radical = law == "radical";
  const Table particles = particles_of(given_particles),
              sides = table_of("sides", given_sides, SIDE_COLUMNS);
  RingBlocks result;
  result.of_parameters = parameters;
  const int variables = parameters ? SIDE_VARIABLES : radical ? 2 : 3;
  std::vector<Line> lines;
  for_rings(particles, sides,
            [&](const double *of, const Stiffness &k, std::size_t n, std::size_t end) {
              const double radius = of[RADIUS];
              lines.clear();
              for (; n < end; ++n) {
                const double *const side = sides.data() + SIDE_COLUMNS * n;
                const double partner = side[PARTNER], shift = side[PLACE];
                const SideVector v = {side[X], side[Y], side[TURN]};
                lines.push_back(partner == 0.0 ? wall_line(v, radius, shift)
                                : radical      ? radical_line(v, radius, partner, shift)
                                               : shifted_line(v, radius, partner, shift));
                const double a = lines.back().indentation.value;
                if (!(a < radius) || !std::isfinite(lines.back().angle.value))
                  refuse("side " + std::to_string(n) + " has the indentation " + std::to_string(a) +
                         ": its line must lie before the center of its particle");
              }
              return add_ring(lines, variables, radius - of[SKIN], k, result);
            });
  return result;
}

RingBlocks curved_blocks(nb::handle given_particles, nb::handle given_sides, bool parameters)
{
  const Table particles = particles_of(given_particles),
              sides = table_of("sides", given_sides, CURVED_COLUMNS);
  RingBlocks result;
  result.of_parameters = parameters;
  std::vector<Line> lines;
  std::vector<BentContact> contacts;
  for_rings(particles, sides,
            [&](const double *of, const Stiffness &k, std::size_t n, std::size_t end) {
              lines.clear();
              contacts.clear();
              for (; n < end; ++n) {
                const double *const side = sides.data() + CURVED_COLUMNS * n;
                const double partner = side[PARTNER];
                for (int column = 0; column < CURVED_COLUMNS; ++column)
                  if (!std::isfinite(side[column]))
                    refuse("side " + std::to_string(n) + " is not finite");
                const SideVector v = {side[X], side[Y], side[TURN]};
                lines.push_back(partner == 0.0
                                    ? wall_line(v, of[RADIUS], 0.0)
                                    : turned_line(v, of[RADIUS], partner, 0.0, side[DIRECTED]));
                contacts.push_back(
                    {side[FORCE], lines.back().angle.value, std::tan(0.5 * side[HALF_ANGLE])});
              }
              return add_curved_ring(lines, contacts, of[RADIUS] - of[SKIN], of[SKIN], k, result);
            });
  return result;
}

}    // namespace

void deformable::bind_ring_blocks(nb::module_ &m)
{
  nb::class_<RingBlocks, EnergyBlocks>(m, "RingBlocks", "The energy of particles of the ring laws.")
      .def_prop_ro(
          "force", [](const RingBlocks &b) { return to_numpy(b.force); }, nb::rv_policy::move,
          "dU/da = p L of each side [energy/length], (S,)");

  m.def(
      "ring_blocks", &ring_blocks, "law"_a, "particles"_a, "sides"_a, "parameters"_a = false,
      R"(The energy of particles of the ring laws, and its derivatives by the vectors to their neighbors.

Each side of a contact has a vector v, from the center to that of the neighbor or to the nearest point of a wall.
Balanced lines have a shift s too, in which the energy of the packing is stationary.

    radical    a, theta from the radical axis at v
    balanced   a = (R_i + R_j - d)/2 + s,   theta = angle of v
    walls      a = R - |v|,   theta = angle of v

Parameters
----------
law : str
    radical or balanced.
particles : array, shape (N, 6)
    Number of sides, radius R, kA, kP, skin, tension and all other parameters of a ring of each particle.
sides : array, shape (S, 5)
    Of each side v_x, v_y [length], the turn of `disk_blocks` [1/length], the radius R_j of the neighbor, 0 for a wall
    [length], and the shift s [length]; the sides of the first particle come first. The other side of a contact has the
    opposite shift.
parameters : bool
    Whether parameters are variables too, of shapes at given indentations.

Returns
-------
RingBlocks
    The local variables are v_x, v_y, then s (balanced), of each side after the other. With `parameters` those of a particle
    are v_x, v_y, s, the direction, and the curvature of each of its sides, then R, kA, kP, skin, tension, and the area
    A0, by which the derivative is the pressure. s moves any line towards the center, and a wall turns by its direction.

Raises
------
ValueError
    Tables that do not fit each other, parameters as for `soft_ring`, a line behind the center, or contacts that leave
    no room.

Source: docs/theory/response.md.)");

  m.def("curved_blocks", &curved_blocks, "particles"_a, "sides"_a, "parameters"_a = false,
        R"(As `ring_blocks`, for curved lines at rest.

    a = (R_i + R_j - m.v)/2 + s,   theta = psi,   m = (cos psi, sin psi)

The energy of the packing is stationary in the shift s, the direction psi and the curvature kappa of each line.
Indentations are those that the forces give. Lines of walls are straight, and follow their wall.

Parameters
----------
particles : array, shape (N, 6)
    As for `ring_blocks`.
sides : array, shape (S, 7)
    Of each side v_x, v_y, turn and R_j as for `ring_blocks`, its force [energy/length], psi and its half angle,
    positive where it is convex [rad]. The other side of a contact has the same force, psi + pi and the opposite half
    angle and curvature.
parameters : bool
    As for `ring_blocks`.

Returns
-------
RingBlocks
    The local variables are v_x, v_y, s, psi and kappa of each side after the other, and parameters as of `ring_blocks`.

Raises
------
ValueError
    As for `ring_blocks`.

Source: docs/theory/response.md.)");
}
