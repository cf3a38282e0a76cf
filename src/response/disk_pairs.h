// Soft disks and soft spheres: energy and forces of listed pairs.

#ifndef DEFORMABLE_DISK_PAIRS_H
#define DEFORMABLE_DISK_PAIRS_H

#include <cmath>
#include <cstddef>
#include <vector>

namespace deformable {

// Disk j, in three dimensions sphere j, lies at x_j + shift - x_i from i. They touch at the distance contact = R_i + R_j.
template <int dimension> struct DiskPair {
  int i, j;
  double shift[dimension], contact;
};

// Values of all pairs, and the gradient of the energy, (x, y) or (x, y, z) of one disk after another.
struct DiskEnergy {
  double energy = 0.0, virial = 0.0;
  std::vector<double> gradient;
};

// E = 1/2 sum_c o_c^2, o = max(R_i + R_j - d, 0), with d = scale |x_j + shift - x_i|: lengths are
// scale times those of x, the radii are not. The virial is sum_c o_c d_c, the gradient that by x:
// dE/dx_j = -scale^2 (o/d) (x_j + shift - x_i).
template <int dimension>
inline void disk_energy(const std::vector<DiskPair<dimension>> &pairs, const double *x,
                        std::size_t disks, double scale, DiskEnergy &result)
{
  result.energy = result.virial = 0.0;
  result.gradient.assign(dimension * disks, 0.0);
  double *gradient = result.gradient.data();
  const double squared = scale * scale;
  for (const DiskPair<dimension> &pair : pairs) {
    const double *xi = x + dimension * pair.i, *xj = x + dimension * pair.j;
    double step[dimension], square = 0.0;
    for (int k = 0; k < dimension; ++k) {
      step[k] = xj[k] - xi[k] + pair.shift[k];
      square += step[k] * step[k];
    }
    const double apart = squared * square;
    // disks at one place push each other in no direction
    if (!(apart < pair.contact * pair.contact)) continue;
    const double distance = std::sqrt(apart), overlap = pair.contact - distance;
    result.energy += 0.5 * overlap * overlap;
    result.virial += overlap * distance;
    const double force = distance > 0.0 ? squared * overlap / distance : 0.0;
    for (int k = 0; k < dimension; ++k) {
      gradient[dimension * pair.i + k] += force * step[k];
      gradient[dimension * pair.j + k] -= force * step[k];
    }
  }
}

}    // namespace deformable

#endif
