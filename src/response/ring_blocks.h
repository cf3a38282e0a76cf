// The energy of a particle of the ring laws as a function of its contact lines' local variables, to second order.

#ifndef DEFORMABLE_RING_BLOCKS_H
#define DEFORMABLE_RING_BLOCKS_H

#include "laws/soft_ring.h"
#include "response/curved_hessian.h"
#include "response/line_geometry.h"
#include "response/ring_hessian.h"

#include <vector>

namespace deformable {

struct RingBlocks : EnergyBlocks {
  std::vector<double> force;    // p L of each side

  // memory
  std::vector<Contact> contacts;
  std::vector<char> is_active;
  std::vector<int> active;
  std::vector<BentContact> bent;
  std::vector<double> by_quantity, local;
  Shape shape;
  RingHessian hessian;
  CurvedHessian curved;
};

// Adds one particle. The energy of its ring depends on so many quantities y of each active line: its derivatives by them,
// in `gradient` and `block`, are those of the first quantity of all lines, then of the second one. With so many local
// variables x of each line,
//   dU/dx = sum_y U_y dy/dx,   d^2U/dx dx' = sum_yy' U_yy' dy/dx dy'/dx' + sum_y U_y d^2y/dx dx'.
inline void chain_lines(const std::vector<Line> &lines, const std::vector<int> &active,
                        int quantities, int variables, const double *gradient, const double *block,
                        RingBlocks &b)
{
  const int z = static_cast<int>(lines.size()), n = static_cast<int>(active.size());
  const int size = z * variables, all = quantities * n;
  const std::size_t first = b.gradient.size();
  b.gradient.resize(first + size);
  b.local.assign(size * size, 0.0);
  for (int m = 0; m < n; ++m)
    for (int q = 0; q < quantities; ++q) {
      const LineQuantity &of = lines[active[m]][q];
      const int row = active[m] * variables;
      for (int x = 0; x < variables; ++x) {
        b.gradient[first + row + x] += gradient[q * n + m] * of.first[x];
        for (int y = 0; y < variables; ++y)
          b.local[(row + x) * size + row + y] += gradient[q * n + m] * of.second[x][y];
      }
      for (int l = 0; l < n; ++l)
        for (int r = 0; r < quantities; ++r) {
          const LineQuantity &to = lines[active[l]][r];
          const double entry = block[(q * n + m) * all + r * n + l];
          const int column = active[l] * variables;
          for (int x = 0; x < variables; ++x) {
            if (of.first[x] == 0.0) continue;
            for (int y = 0; y < variables; ++y)
              b.local[(row + x) * size + column + y] += of.first[x] * entry * to.first[y];
          }
        }
    }
  b.add_block(first, size, b.local.data());
}

// `radius` is that of the ring, without its skin. Returns false if no ring has this shape.
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
  for (int c = 0; c < z; ++c) b.force.push_back(p * b.shape.contact[c].d_indentation);
  b.by_quantity.resize(2 * n);
  for (int m = 0; m < n; ++m) {
    b.by_quantity[m] = p * b.shape.contact[b.active[m]].d_indentation;
    b.by_quantity[n + m] = p * b.shape.contact[b.active[m]].d_angle;
  }
  chain_lines(lines, b.active, 2, variables, b.by_quantity.data(), b.hessian.block.data(), b);
  b.energy += energy.value;
  return true;
}

// The same for curved lines that are at rest under these forces. The ring's own curvature under a skin is k/(1 - skin k)
// for lines of the curvature k.
inline bool add_curved_ring(std::vector<Line> &lines, const std::vector<BentContact> &contacts,
                            double radius, double skin, const Stiffness &k, RingBlocks &b)
{
  b.active.clear();
  b.bent.clear();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    b.force.push_back(contacts[c].force);
    if (!(contacts[c].force > 0.0)) continue;
    b.active.push_back(static_cast<int>(c));
    b.bent.push_back(contacts[c]);
  }
  CurvedHessian &h = b.curved;
  if (b.bent.empty()) {
    chain_lines(lines, b.active, 3, LINE_VARIABLES, nullptr, nullptr, b);
    return true;
  }
  if (!curved_hessian(radius, k, b.bent, h)) return false;
  for (std::size_t m = 0; m < b.active.size(); ++m) {
    LineQuantity &curvature = lines[b.active[m]].curvature;
    if (curvature.first[CURVATURE] == 0.0) continue;    // of a wall
    const double wider = 1.0 + skin * h.curvature[m];
    curvature.first[CURVATURE] = wider * wider;
    curvature.second[CURVATURE][CURVATURE] = 2.0 * skin * wider * wider * wider;
  }
  b.by_quantity = h.by_indentation;
  b.by_quantity.insert(b.by_quantity.end(), h.by_angle.begin(), h.by_angle.end());
  b.by_quantity.insert(b.by_quantity.end(), h.by_curvature.begin(), h.by_curvature.end());
  chain_lines(lines, b.active, 3, LINE_VARIABLES, b.by_quantity.data(), h.block.data(), b);
  b.energy += h.energy;
  return true;
}

}    // namespace deformable

#endif
