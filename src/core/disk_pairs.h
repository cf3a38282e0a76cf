// Soft disks: energy and forces of listed pairs.

#ifndef DEFORMABLE_DISK_PAIRS_H
#define DEFORMABLE_DISK_PAIRS_H

#include <cmath>
#include <cstddef>
#include <vector>

namespace deformable {

// Disk j lies at x_j + shift - x_i from disk i. They touch at the distance contact = R_i + R_j.
struct DiskPair {
  int i, j;
  double shift_x, shift_y, contact;
};

// Values of all pairs, and the gradient of the energy, (x, y) of one disk after another.
struct DiskEnergy {
  double energy = 0.0, virial = 0.0;
  std::vector<double> gradient;
};

// E = 1/2 sum_c o_c^2, o = max(R_i + R_j - d, 0), with d = scale |x_j + shift - x_i|: lengths are
// scale times those of x, the radii are not. The virial is sum_c o_c d_c, the gradient that by x:
// dE/dx_j = -scale^2 (o/d) (x_j + shift - x_i).
inline void disk_energy(const std::vector<DiskPair> &pairs, const double *x, std::size_t disks,
                        double scale, DiskEnergy &result)
{
  result.energy = result.virial = 0.0;
  result.gradient.assign(2 * disks, 0.0);
  double *gradient = result.gradient.data();
  const double squared = scale * scale;
  for (const DiskPair &pair : pairs) {
    const double *xi = x + 2 * pair.i, *xj = x + 2 * pair.j;
    const double dx = xj[0] - xi[0] + pair.shift_x, dy = xj[1] - xi[1] + pair.shift_y;
    const double apart = squared * (dx * dx + dy * dy);
    // disks at one place push each other in no direction
    if (!(apart < pair.contact * pair.contact)) continue;
    const double distance = std::sqrt(apart), overlap = pair.contact - distance;
    result.energy += 0.5 * overlap * overlap;
    result.virial += overlap * distance;
    const double force = distance > 0.0 ? squared * overlap / distance : 0.0;
    gradient[2 * pair.i] += force * dx;
    gradient[2 * pair.i + 1] += force * dy;
    gradient[2 * pair.j] -= force * dx;
    gradient[2 * pair.j + 1] -= force * dy;
  }
}

}    // namespace deformable

#endif
