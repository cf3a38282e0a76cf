// Soft disks: second derivatives of the energy of a contact.

#ifndef DEFORMABLE_DISK_BLOCKS_H
#define DEFORMABLE_DISK_BLOCKS_H

#include "energy_blocks.h"

#include <cmath>

namespace deformable {

// U = o^2/2 of the overlap o = contact - |v| with a neighbor (contact = R_i + R_j) or a wall (contact = R_i):
//   dU/dv = -o n,   d^2U/dv dv = n n^T - o turn t t^T.
inline void add_disk_contact(const SideVector &v, double contact, EnergyBlocks &result)
{
  const double nx = v.x / v.length(), ny = v.y / v.length(), overlap = contact - v.length();
  const double across = overlap * v.turn;
  const double xy = (1.0 + across) * nx * ny;
  const double block[4] = {nx * nx - across * ny * ny, xy, xy, ny * ny - across * nx * nx};
  result.energy += 0.5 * overlap * overlap;
  const std::size_t first = result.gradient.size();
  result.gradient.insert(result.gradient.end(), {-overlap * nx, -overlap * ny});
  result.add_block(first, 2, block);
}

}    // namespace deformable

#endif
