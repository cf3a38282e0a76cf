// Soft disks and soft spheres: second derivatives of the energy of a contact.

#ifndef DEFORMABLE_DISK_BLOCKS_H
#define DEFORMABLE_DISK_BLOCKS_H

#include "response/energy_blocks.h"

#include <cmath>

namespace deformable {

// U = o^2/2 of the overlap o = contact - |v| with a neighbor (contact = R_i + R_j) or a wall (contact = R_i), with the
// direction n of v, which turns as that of a SideVector:
//   dU/dv = -o n,   d^2U/dv dv = n n^T - o turn (1 - n n^T).
template <int dimension>
inline void add_disk_contact(const double *v, double turn, double contact, EnergyBlocks &result)
{
  double square = 0.0;
  for (int a = 0; a < dimension; ++a) square += v[a] * v[a];
  const double length = std::sqrt(square), overlap = contact - length, across = overlap * turn;
  double block[dimension * dimension];
  const std::size_t first = result.gradient.size();
  for (int a = 0; a < dimension; ++a) {
    const double along = v[a] / length;
    result.gradient.push_back(-overlap * along);
    for (int b = 0; b < dimension; ++b)
      block[a * dimension + b] = (1.0 + across) * along * (v[b] / length) - (a == b ? across : 0.0);
  }
  result.energy += 0.5 * overlap * overlap;
  result.add_block(first, dimension, block);
}

}    // namespace deformable

#endif
