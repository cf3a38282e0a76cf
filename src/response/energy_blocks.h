// An energy that is a sum of functions of the vectors from particles to their neighbors and walls, to second order.

#ifndef DEFORMABLE_ENERGY_BLOCKS_H
#define DEFORMABLE_ENERGY_BLOCKS_H

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace deformable {

// X of A X = B by elimination with pivots, rows of both one after the other; X replaces B. False: A is singular.
inline bool solve_by_elimination(std::vector<double> a, std::vector<double> &b, int n, int columns)
{
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int r = k + 1; r < n; ++r)
      if (std::fabs(a[r * n + k]) > std::fabs(a[pivot * n + k])) pivot = r;
    if (!(std::fabs(a[pivot * n + k]) > 0.0)) return false;
    for (int c = 0; c < n; ++c) std::swap(a[k * n + c], a[pivot * n + c]);
    for (int c = 0; c < columns; ++c) std::swap(b[k * columns + c], b[pivot * columns + c]);
    for (int r = 0; r < n; ++r) {
      if (r == k) continue;
      const double part = a[r * n + k] / a[k * n + k];
      if (part == 0.0) continue;
      for (int c = k; c < n; ++c) a[r * n + c] -= part * a[k * n + c];
      for (int c = 0; c < columns; ++c) b[r * columns + c] -= part * b[k * columns + c];
    }
  }
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < columns; ++c) b[k * columns + c] /= a[k * n + k];
  return true;
}

// The vector v = (x, y) from the center of a particle to that of a neighbor, or to the nearest point of a wall, and
// the angle by which its direction n turns for a step of v along t, which is n turned by 90 degrees: 1/|v| for a
// neighbor, SurfacePoint::turn for a wall. Where a wall is near, v changes by -dr_i.
//   d|v|/dv = n,   d^2|v|/dv dv = turn t t^T,   dtheta/dv = turn t,   d^2theta/dv dv = -turn^2 (n t^T + t n^T)
struct SideVector {
  double x, y, turn;
  double length() const { return std::sqrt(x * x + y * y); }
};

// The vector v of a contact in space, from the center of a particle to that of a neighbor, or to the nearest point of a wall. Its
// direction n turns for a step of v across the axis and across n, by the angle `turn` for each unit of length: 1/|v| for a neighbor,
// as at a SurfacePoint for a round wall. The axis is that of a cylinder or cone, a unit vector; 0 for all others. A part of n along
// it does not turn. So n turns about a point: the center of a neighbor or sphere, or the point of the axis at the vector
//   (n - (n.axis) axis)/turn.
struct SpaceVector {
  std::array<double, 3> v;
  double turn;
  std::array<double, 3> axis;

  std::array<double, 3> direction() const
  {
    const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return {v[0] / length, v[1] / length, v[2] / length};
  }
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

// Adds a contact of soft disks or soft spheres. U = o^2/2 of the overlap o = contact - |v| with a neighbor (contact = R_i + R_j)
// or a wall (contact = R_i), with the direction n of v, which turns as that of a SideVector or SpaceVector, and the direction c of
// its part across the axis:
//   dU/dv = -o n,   d^2U/dv dv = n n^T - o turn (1 - axis axis^T - c c^T),   dU/dcontact = o.
template <int dimension>
inline void add_disk_contact(const double *v, double turn, const double *axis, double contact,
                             EnergyBlocks &result)
{
  constexpr int size = dimension + 1;
  double n[dimension], c[dimension], block[size * size];
  double square = 0.0, along = 0.0, round = 0.0;
  for (int a = 0; a < dimension; ++a) square += v[a] * v[a];
  const double length = std::sqrt(square), overlap = contact - length, across = overlap * turn;
  for (int a = 0; a < dimension; ++a) {
    n[a] = v[a] / length;
    along += n[a] * axis[a];
  }
  for (int a = 0; a < dimension; ++a) {
    c[a] = n[a] - along * axis[a];
    round += c[a] * c[a];
  }
  const std::size_t first = result.gradient.size();
  for (int a = 0; a < dimension; ++a) {
    result.gradient.push_back(-overlap * n[a]);
    for (int b = 0; b < dimension; ++b) {
      block[a * size + b] = n[a] * n[b];
      if (turn != 0.0)
        block[a * size + b] -=
            across * ((a == b ? 1.0 : 0.0) - axis[a] * axis[b] - c[a] * c[b] / round);
    }
    block[a * size + dimension] = block[dimension * size + a] = -n[a];
  }
  block[dimension * size + dimension] = 1.0;
  result.gradient.push_back(overlap);
  result.energy += 0.5 * overlap * overlap;
  result.add_block(first, size, block);
}

}    // namespace deformable

#endif
