#include "python/laws.h"
#include "python/tables.h"

#include "response/disk_blocks.h"
#include "response/droplet_blocks.h"

#include <algorithm>
#include <cmath>

using namespace deformable;

namespace {

using Integers = nb::ndarray<nb::numpy, int, nb::ndim<1>>;

Integers integers(const std::vector<int> &values)
{
  auto *data = new int[values.size()];
  std::copy(values.begin(), values.end(), data);
  nb::capsule owner(data, [](void *p) noexcept { delete[] static_cast<int *>(p); });
  return Integers(data, {values.size()}, owner);
}

EnergyBlocks disk_blocks(nb::handle given, nb::handle given_turn, nb::handle given_contact)
{
  const std::size_t dimension =
      nb::cast<std::size_t>(nb::module_::import_("numpy").attr("shape")(given)[nb::int_(-1)]);
  if (dimension != 2 && dimension != 3)
    refuse("vectors must have two or three components, not " + std::to_string(dimension));
  const Table vectors = table_of("vectors", given, dimension);
  const std::vector<double> turn = vector_of("turn", given_turn),
                            contact = vector_of("contact", given_contact);
  if (turn.size() != vectors.shape(0) || contact.size() != vectors.shape(0))
    refuse("turn and contact must have one value for each vector");
  EnergyBlocks result;
  for (std::size_t c = 0; c < turn.size(); ++c) {
    const double *const v = vectors.data() + dimension * c;
    double square = 0.0;
    for (std::size_t axis = 0; axis < dimension; ++axis) square += v[axis] * v[axis];
    if (!(square > 0.0 && std::isfinite(square)))
      refuse("vector " + std::to_string(c) + " has no direction, which a contact needs");
    if (dimension == 2)
      add_disk_contact<2>(v, turn[c], contact[c], result);
    else
      add_disk_contact<3>(v, turn[c], contact[c], result);
  }
  return result;
}

// Columns of the tables of droplets and of their sides.
enum DropletColumn { SIDES_OF_DROPLET, DROPLET_RADIUS, DROPLET_TENSION, DROPLET_COLUMNS };
enum DropletSideColumn { DROPLET_TURN = 3, DROPLET_SHARE, DROPLET_FORCE, DROPLET_SIDE_COLUMNS };

EnergyBlocks droplet_blocks(nb::handle given_droplets, nb::handle given_sides)
{
  const Table droplets = table_of("droplets", given_droplets, DROPLET_COLUMNS),
              sides = table_of("sides", given_sides, DROPLET_SIDE_COLUMNS);
  EnergyBlocks result;
  std::vector<DropletSide> of_droplet;
  for_particles(
      droplets, sides, [&](std::size_t i, const double *of, std::size_t begin, std::size_t end) {
        const std::string name = "droplet " + std::to_string(i);
        require_positive("radius of " + name, of[DROPLET_RADIUS]);
        require_positive("tension of " + name, of[DROPLET_TENSION]);
        of_droplet.clear();
        for (std::size_t n = begin; n < end; ++n) {
          const double *const s = sides.data() + DROPLET_SIDE_COLUMNS * n;
          const double square = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
          if (!(square > 0.0 && std::isfinite(square)))
            refuse("vector " + std::to_string(n) + " has no direction, which a contact needs");
          if (!std::isfinite(s[DROPLET_TURN]) || !std::isfinite(s[DROPLET_SHARE]))
            refuse("side " + std::to_string(n) + " is not finite");
          require_positive("force of side " + std::to_string(n), s[DROPLET_FORCE]);
          of_droplet.push_back(
              {{s[0], s[1], s[2]}, s[DROPLET_TURN], s[DROPLET_SHARE], s[DROPLET_FORCE]});
        }
        if (!add_droplet(of_droplet, of[DROPLET_RADIUS], of[DROPLET_TENSION], result))
          refuse(name + " is beyond the model: its compliance is singular");
      });
  return result;
}

}    // namespace

void deformable::bind_energy_blocks(nb::module_ &m)
{
  nb::class_<EnergyBlocks>(m, "EnergyBlocks",
                           "An energy with its first and second derivatives by local variables.")
      .def_ro("energy", &EnergyBlocks::energy, "sum over all contacts or particles [energy]")
      .def_prop_ro(
          "gradient",
          [](const EnergyBlocks &e) {
            return to_numpy<Vector>(e.gradient.data(), {e.gradient.size()});
          },
          nb::rv_policy::move, "derivatives by the local variables, (V,)")
      .def(
          "hessian",
          [](const EnergyBlocks &e) {
            return nb::make_tuple(integers(e.row), integers(e.column),
                                  to_numpy<Vector>(e.value.data(), {e.value.size()}));
          },
          "Second derivatives by the local variables, as rows, columns and values.");

  m.def(
      "disk_blocks", &disk_blocks, "vectors"_a, "turn"_a, "contact"_a,
      R"(The energy U = o^2/2 of contacts of soft disks or spheres, and its derivatives by their vectors v.

The overlap is o = contact - |v|. With the direction n of v, dU/dv = -o n and
d^2U/dv dv = n n^T - o turn (1 - n n^T).

Parameters
----------
vectors : array, shape (M, 2) or (M, 3)
    The vector v of each contact, from a center to that of a neighbor or to the nearest point of a wall [length].
turn : array, shape (M,)
    Angle by which n turns for a step of v across it: 1/|v| for a neighbor, 0 for a flat wall [1/length].
contact : array, shape (M,)
    Distance at which they touch: R_i + R_j, or R_i for a wall [length].

Returns
-------
EnergyBlocks
    The local variables are the components of v of each contact, one contact after the other.

Raises
------
ValueError
    Unequal lengths, values that are not finite, a vector without length.

Source: docs/theory.md, "Second derivatives".)");

  m.def(
      "droplet_blocks", &droplet_blocks, "droplets"_a, "sides"_a,
      R"(The energy of droplets at rest, and its derivatives by the vectors to their neighbors and the places of facets.

U = F.a - W(F, n), stationary in the forces F, with W of `droplet`. A facet has the direction n of the vector v and the indentation
a = const - share |v| + s; the energy of a packing is stationary in the shifts s of its facets.

Parameters
----------
droplets : array, shape (N, 3)
    Number of sides, radius [length] and tension [energy/length^2] of each droplet.
sides : array, shape (S, 6)
    Of each side v_x, v_y, v_z [length], the turn of `disk_blocks` [1/length], the share of the distance (1/2 for a
    neighbor, 1 for a wall) and its force F > 0 [energy/length]; the sides of the first droplet come first. The other side of
    a contact has the same force and the opposite shift.

Returns
-------
EnergyBlocks
    The local variables are v_x, v_y, v_z and s of each side after the other.

Raises
------
ValueError
    Tables that do not fit each other, values that are not positive or not finite, or a droplet beyond the model whose
    compliance is singular.

Source: docs/theory.md, "Second derivatives".)");
}
