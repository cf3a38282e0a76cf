#include "python/laws.h"
#include "python/tables.h"

#include "response/ring_blocks.h"

#include <algorithm>
#include <cmath>

using namespace deformable;

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

// Of sides with curved lines.
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

RingBlocks ring_blocks(const std::string &law, nb::handle given_particles, nb::handle given_sides)
{
  if (law != "radical" && law != "balanced") refuse("law must be radical or balanced, not " + law);
  const bool radical = law == "radical";
  const Table particles = particles_of(given_particles),
              sides = table_of("sides", given_sides, SIDE_COLUMNS);
  RingBlocks result;
  std::vector<Line> lines;
  for_rings(particles, sides,
            [&](const double *of, const Stiffness &k, std::size_t n, std::size_t end) {
              const double radius = of[RADIUS];
              lines.clear();
              for (; n < end; ++n) {
                const double *const side = sides.data() + SIDE_COLUMNS * n;
                const double partner = side[PARTNER];
                const SideVector v = {side[X], side[Y], side[TURN]};
                lines.push_back(partner == 0.0 ? wall_line(v, radius)
                                : radical      ? radical_line(v, radius, partner)
                                               : shifted_line(v, radius, partner, side[PLACE]));
                const double a = lines.back().indentation.value;
                if (!(a < radius) || !std::isfinite(lines.back().angle.value))
                  refuse("side " + std::to_string(n) + " has the indentation " + std::to_string(a) +
                         ": its line must lie before the center of its particle");
              }
              return add_ring(lines, radical ? 2 : 3, radius - of[SKIN], k, result);
            });
  return result;
}

RingBlocks curved_blocks(nb::handle given_particles, nb::handle given_sides)
{
  const Table particles = particles_of(given_particles),
              sides = table_of("sides", given_sides, CURVED_COLUMNS);
  RingBlocks result;
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
                                    ? wall_line(v, of[RADIUS])
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
          "force",
          [](const RingBlocks &b) { return to_numpy<Vector>(b.force.data(), {b.force.size()}); },
          nb::rv_policy::move, "dU/da = p L of each side [energy/length], (S,)");

  m.def(
      "ring_blocks", &ring_blocks, "law"_a, "particles"_a, "sides"_a,
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

Returns
-------
RingBlocks
    The local variables are v_x, v_y, then s (balanced), of each side after the other.

Raises
------
ValueError
    Tables that do not fit each other, parameters as for `soft_ring`, a line behind the center, or contacts that leave
    no room.

Source: docs/theory.md, "Second derivatives".)");

  m.def("curved_blocks", &curved_blocks, "particles"_a, "sides"_a,
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

Returns
-------
RingBlocks
    The local variables are v_x, v_y, s, psi and kappa of each side after the other.

Raises
------
ValueError
    As for `ring_blocks`.

Source: docs/theory.md, "Second derivatives".)");
}
