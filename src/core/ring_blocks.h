// The energy of a particle of the ring laws as a function of its contact lines' local variables, to second order.

#ifndef DEFORMABLE_RING_BLOCKS_H
#define DEFORMABLE_RING_BLOCKS_H

#include "line_geometry.h"
#include "ring_hessian.h"
#include "soft_ring.h"

#include <vector>

namespace deformable {

struct RingBlocks : EnergyBlocks {
  std::vector<double> force;    // p L of each side

  // memory
  std::vector<Contact> contacts;
  std::vector<char> is_active;
  std::vector<int> active;
  std::vector<double> local;
  Shape shape;
  RingHessian hessian;
};

// U of the lines of one particle: dU/dx = U_a da/dx + U_theta dtheta/dx, and with y = (a, theta) of all lines
//   d^2U/dx dx' = sum_yy' U_yy' dy/dx dy'/dx' + sum_y U_y d^2y/dx dx'.
// Each line has so many local variables x. `radius` is that of the ring, without its skin. Returns false if no ring
// has this shape.
inline bool add_ring(const std::vector<Line> &lines, int variables, double radius,
                     const Stiffness &k, RingBlocks &b)
{
  const int z = static_cast<int>(lines.size());
  b.contacts.clear();
  for (const Line &line : lines)
    b.contacts.push_back({line.angle.value, std::cos(line.angle.value), std::sin(line.angle.value),
                          line.indentation.value});
  const Contacts contacts = {z, b.contacts.data()};
  b.is_active.assign(z, 0);
  Energy energy;
  if (k.conserves_perimeter()) {
    ring_shape(radius, contacts, b.is_active.data(), b.hessian.lcp, b.shape);
    energy = harmonic(k.kA, b.shape.area_deficit);
  } else if (!soft_ring_shape(radius, k, contacts, b.is_active.data(), b.hessian.lcp, b.shape,
                              energy)) {
    return false;
  }
  b.active.clear();
  for (int c = 0; c < z; ++c)
    if (b.shape.contact[c].length > 0.0) b.active.push_back(c);
  const int n = static_cast<int>(b.active.size());
  const double p = energy.derivative;
  ring_hessian(
      {radius, b.shape.perimeter_excess / (2.0 * PI), k, p, contacts, b.shape.contact.data()}, n,
      b.active.data(), b.hessian);

  const std::size_t first = b.gradient.size();
  b.gradient.resize(first + z * variables);
  for (int c = 0; c < z; ++c) b.force.push_back(p * b.shape.contact[c].d_indentation);
  const int size = z * variables;
  b.local.assign(size * size, 0.0);
  for (int m = 0; m < n; ++m) {
    const int c = b.active[m];
    const Line &line = lines[c];
    const double by_a = p * b.shape.contact[c].d_indentation;
    const double by_theta = p * b.shape.contact[c].d_angle;
    for (int x = 0; x < variables; ++x) {
      b.gradient[first + c * variables + x] =
          by_a * line.indentation.first[x] + by_theta * line.angle.first[x];
      for (int y = 0; y < variables; ++y)
        b.local[(c * variables + x) * size + c * variables + y] +=
            by_a * line.indentation.second[x][y] + by_theta * line.angle.second[x][y];
    }
    for (int l = 0; l < n; ++l) {
      const int d = b.active[l];
      const double *const row = b.hessian.block.data() + m * 2 * n;
      const double aa = row[l], at = row[n + l], ta = row[n * 2 * n + l],
                   tt = row[n * 2 * n + n + l];
      for (int x = 0; x < variables; ++x) {
        const double ax = line.indentation.first[x], tx = line.angle.first[x];
        for (int y = 0; y < variables; ++y)
          b.local[(c * variables + x) * size + d * variables + y] +=
              (ax * aa + tx * ta) * lines[d].indentation.first[y] +
              (ax * at + tx * tt) * lines[d].angle.first[y];
      }
    }
  }
  b.energy += energy.value;
  b.add_block(first, size, b.local.data());
  return true;
}

}    // namespace deformable

#endif
