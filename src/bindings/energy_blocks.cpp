#include "laws.h"

#include "disk_blocks.h"

#include <algorithm>

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

std::vector<SideVector> side_vectors(nb::handle given_x, nb::handle given_y, nb::handle given_turn)
{
  const std::vector<double> x = vector_of("x", given_x), y = vector_of("y", given_y),
                            turn = vector_of("turn", given_turn);
  if (x.size() != y.size() || x.size() != turn.size())
    refuse("x, y and turn must have one value for each vector");
  std::vector<SideVector> sides;
  for (std::size_t c = 0; c < x.size(); ++c) {
    sides.push_back({x[c], y[c], turn[c]});
    if (!(sides[c].length() > 0.0))
      refuse("vector " + std::to_string(c) + " is 0: a contact needs a direction");
  }
  return sides;
}

EnergyBlocks disk_blocks(nb::handle x, nb::handle y, nb::handle turn, nb::handle contact)
{
  const std::vector<SideVector> sides = side_vectors(x, y, turn);
  const std::vector<double> distance = vector_of("contact", contact);
  if (distance.size() != sides.size()) refuse("contact must have one value for each vector");
  EnergyBlocks result;
  for (std::size_t c = 0; c < sides.size(); ++c) add_disk_contact(sides[c], distance[c], result);
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

  m.def("disk_blocks", &disk_blocks, "x"_a, "y"_a, "turn"_a, "contact"_a,
        R"(The energy U = o^2/2 of contacts of soft disks, and its derivatives by their vectors v.

The overlap is o = contact - |v|. With the direction n of v and t perpendicular to it, dU/dv = -o n and
d^2U/dv dv = n n^T - o turn t t^T.

Parameters
----------
x, y : array, shape (M,)
    The vector v of each contact, from a center to that of a neighbor or to the nearest point of a wall [length].
turn : array, shape (M,)
    Angle by which n turns for a step of v along t: 1/|v| for a neighbor, 0 for a flat wall [1/length].
contact : array, shape (M,)
    Distance at which they touch: R_i + R_j, or R_i for a wall [length].

Returns
-------
EnergyBlocks
    The local variables are v_x, v_y of each contact, one contact after the other.

Raises
------
ValueError
    Unequal lengths, values that are not finite, a vector without length.

Source: docs/theory.md, "Second derivatives".)");
}
