#include "laws.h"

#include "ring_blocks.h"

#include <cmath>

using namespace deformable;

namespace {

using Table = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

Table table_of(const std::string &name, nb::handle given, std::size_t columns)
{
  const nb::object array =
      nb::module_::import_("numpy").attr("ascontiguousarray")(given, "dtype"_a = "float64");
  Table table;
  if (!nb::try_cast(array, table) || table.shape(1) != columns)
    refuse(name + " must have rows of " + std::to_string(columns) + " numbers");
  return table;
}

// Columns of the tables of particles and of sides.
enum ParticleColumn { SIDES, RADIUS, KA, KP, SKIN, TENSION, PARTICLE_COLUMNS };
enum SideColumn { X, Y, TURN, PARTNER, PLACE, DIRECTED, SIDE_COLUMNS };

enum class Law { RADICAL, BALANCED, TILTED };

Law law_of(const std::string &name)
{
  if (name == "radical") return Law::RADICAL;
  if (name == "balanced") return Law::BALANCED;
  if (name == "tilted") return Law::TILTED;
  refuse("law must be radical, balanced or tilted, not " + name);
}

Line line_of(Law law, const double *side, double radius)
{
  const SideVector v = {side[X], side[Y], side[TURN]};
  const double partner = side[PARTNER];
  if (partner == 0.0) return wall_line(v, radius);
  if (law == Law::RADICAL) return radical_line(v, radius, partner);
  if (law == Law::BALANCED) return shifted_line(v, radius, partner, side[PLACE]);
  return turned_line(v, radius, partner, side[PLACE], side[DIRECTED]);
}

RingBlocks ring_blocks(const char *name, nb::handle given_particles, nb::handle given_sides)
{
  const Law law = law_of(name);
  const Table particles = table_of("particles", given_particles, PARTICLE_COLUMNS),
              sides = table_of("sides", given_sides, SIDE_COLUMNS);
  const int variables = law == Law::RADICAL ? 2 : law == Law::BALANCED ? 3 : 4;
  RingBlocks result;
  std::vector<Line> lines;
  std::size_t next = 0;
  for (std::size_t i = 0; i < particles.shape(0); ++i) {
    const double *const of = particles.data() + PARTICLE_COLUMNS * i;
    const Stiffness stiffness = {of[KA], of[KP], of[TENSION]};
    refuse_invalid(of[RADIUS], stiffness, of[SKIN]);
    if (!(of[SIDES] >= 0.0 && of[SIDES] <= static_cast<double>(sides.shape(0) - next)))
      refuse("sides has fewer rows than the particles need, or particle " + std::to_string(i) +
             " a number of them that is none");
    const std::size_t end = next + static_cast<std::size_t>(of[SIDES]);
    lines.clear();
    for (; next < end; ++next) {
      const double *const side = sides.data() + SIDE_COLUMNS * next;
      lines.push_back(line_of(law, side, of[RADIUS]));
      const double a = lines.back().indentation.value;
      if (!(a < of[RADIUS]) || !std::isfinite(lines.back().angle.value))
        refuse("side " + std::to_string(next) + " has the indentation " + std::to_string(a) +
               ": its line must lie before the center of particle " + std::to_string(i));
    }
    if (!add_ring(lines, variables, of[RADIUS] - of[SKIN], stiffness, result))
      refuse("particle " + std::to_string(i) + ": its contacts leave no room for its area");
  }
  if (next != sides.shape(0)) refuse("sides has more rows than the particles need");
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
Balanced lines have a shift s too, and tilted ones a direction psi. The energy of the packing is stationary in both.

    radical    a, theta from the radical axis at v
    balanced   a = (R_i + R_j - d)/2 + s,   theta = angle of v
    tilted     a = (R_i + R_j - m.v)/2 + s,   theta = psi,   m = (cos psi, sin psi)
    walls      a = R - |v|,   theta = angle of v

Parameters
----------
law : str
    radical, balanced or tilted.
particles : array, shape (N, 6)
    Number of sides, radius R, kA, kP, skin and tension of each particle.
sides : array, shape (S, 6)
    Of each side v_x, v_y [length], the turn of `disk_blocks` [1/length], the radius R_j of the neighbor, 0 for a wall
    [length], the shift s [length], and psi [rad] (tilted); the sides of the first particle come first. The other side
    of a contact has the opposite shift, and psi + pi.

Returns
-------
RingBlocks
    The local variables are v_x, v_y, then s (balanced, tilted), then psi (tilted), of each side after the other.

Raises
------
ValueError
    Tables that do not fit each other, parameters as for `soft_ring`, a line behind the center, or contacts that leave
    no room.

Source: docs/theory.md, "Second derivatives".)");
}
