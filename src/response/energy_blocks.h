// An energy that is a sum of functions of the vectors from particles to their neighbors and walls, to second order.

#ifndef DEFORMABLE_ENERGY_BLOCKS_H
#define DEFORMABLE_ENERGY_BLOCKS_H

#include <cmath>
#include <cstddef>
#include <vector>

namespace deformable {

// The vector v = (x, y) from the center of a particle to that of a neighbor, or to the nearest point of a wall, and
// the angle by which its direction n turns for a step of v along t, which is n turned by 90 degrees: 1/|v| for a
// neighbor, SurfacePoint::turn for a wall. Where a wall is near, v changes by -dr_i.
//   d|v|/dv = n,   d^2|v|/dv dv = turn t t^T,   dtheta/dv = turn t,   d^2theta/dv dv = -turn^2 (n t^T + t n^T)
struct SideVector {
  double x, y, turn;
  double length() const { return std::sqrt(x * x + y * y); }
};

// Energy, gradient, and the entries of the second derivatives, a dense symmetric block after the other.
struct EnergyBlocks {
  double energy = 0.0;
  std::vector<double> gradient;
  std::vector<int> row, column;
  std::vector<double> value;

  // The variables of the block are first, first + 1, ...
  void add_block(std::size_t first, std::size_t size, const double *block)
  {
    const int begin = static_cast<int>(first), count = static_cast<int>(size);
    for (int r = 0; r < count; ++r)
      for (int c = 0; c < count; ++c) {
        row.push_back(begin + r);
        column.push_back(begin + c);
        value.push_back(block[r * count + c]);
      }
  }
};

}    // namespace deformable

#endif
