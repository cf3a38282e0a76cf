// The energy of a particle of the ring laws as a function of its contact lines' local variables, to second order.

#ifndef DEFORMABLE_RING_BLOCKS_H
#define DEFORMABLE_RING_BLOCKS_H

#include "laws/contact.h"
#include "laws/ring_lcp.h"
#include "laws/soft_ring.h"
#include "laws/stiffness.h"
#include "response/curved_hessian.h"
#include "response/energy_blocks.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace deformable {

// A ring in equilibrium between its contacts.
struct RingState {
  double radius, expansion;    // R - c, delta
  Stiffness stiffness;
  double pressure;
  Contacts contacts;
  const Response *response;
};

// G^-1 of the n active contacts, which depends on their directions only. Where directions coincide up to rounding a diagonal
// matrix takes its place.
inline void green_inverse(const Contacts &contacts, int n, const int *active, RingLCP &p,
                          double *inverse)
{
  p.clear(contacts.size);
  for (int m = 0; m < n; ++m) p.add(contacts, active[m], 0.0, RingLCP::ACTIVE);
  const MatrixRows green = p.rows(p.green);
  double *const per_pivot = p.scratch.data();
  const bool regular = solve_dense(n, green, p.indentation.data(), per_pivot) < 0;
  std::fill_n(inverse, n * n, 0.0);
  for (int m = 0; m < n; ++m) {
    double *const row = inverse + m * n;
    row[m] = regular ? 1.0 : 1.0 / GREEN_AT_ZERO;
    if (regular) solve_factored(n, green, per_pivot, row);
  }
}

// Second derivatives of the energy by any variables y of the area deficit D, with s = dD/dy and r = d^2D/dy ddelta:
//   d^2U/dy dy = p d^2D/dy dy + kA s s^T - f f^T/u,   f = d^2U/dy ddelta = p r - 2 pi q kA s,
//   u = d^2U/ddelta^2 = 4 pi^2 q^2 kA + w,   w = p (1.G^-1.1 - 2 pi) + 4 pi^2 kP,
// where the last term is that of the radial expansion. These are the factors of s s^T, s r^T + r s^T and -r r^T, which
// are finite for kA = inf too; `lengths` is the sum of L, `rates` 1.G^-1.1.
struct ExpansionTerms {
  double square, mixed, rates;
};

inline ExpansionTerms expansion_terms(const RingState &ring, double lengths, double rates)
{
  const double p = ring.pressure, kA = ring.stiffness.kA;
  if (ring.stiffness.conserves_perimeter()) return {kA, 0.0, 0.0};
  const double two_pi_q = 2.0 * PI * (ring.radius + ring.expansion) - lengths;
  const double w =
      p * (rates - 2.0 * PI) + 4.0 * PI * PI * ring.stiffness.perimeter_stiffness(ring.expansion);
  const double per = 1.0 / (two_pi_q * two_pi_q + w / kA);
  return {w * per, two_pi_q * p * per, p / kA * p * per};
}

// K = dF/da, F_c = p L_c, of the n active contacts: dD/da = L, d^2D/da da = G^-1, r = G^-1 1. `rate` is memory for r.
inline void contact_stiffness(const RingState &ring, int n, const int *active,
                              const double *inverse, std::vector<double> &rate, double *stiffness)
{
  const double p = ring.pressure;
  double lengths = 0.0, rates = 0.0;
  rate.assign(n, 0.0);
  for (int m = 0; m < n; ++m) {
    for (int k = 0; k < n; ++k) rate[m] += inverse[m * n + k];
    rates += rate[m];
    lengths += ring.response[active[m]].length;
  }
  const ExpansionTerms terms = expansion_terms(ring, lengths, rates);
  for (int m = 0; m < n; ++m) {
    const double length = ring.response[active[m]].length;
    const double by_length = terms.square * length + terms.mixed * rate[m];
    const double by_rate = terms.mixed * length - terms.rates * rate[m];
    for (int k = 0; k < n; ++k)
      stiffness[m * n + k] =
          p * inverse[m * n + k] + by_length * ring.response[active[k]].length + by_rate * rate[k];
  }
}

// Contact lines as functions of the centers and of what is free to move in them, to second order.

// Local variables of one side of a contact: the vector v, the shift of the line, its direction and curvature. Laws have
// the first 2, 3 or 5 of them.
enum LineVariable { V_X, V_Y, SHIFT, DIRECTION, CURVATURE, LINE_VARIABLES };

// A quantity with its derivatives by the local variables.
struct LineQuantity {
  double value, first[LINE_VARIABLES] = {}, second[LINE_VARIABLES][LINE_VARIABLES] = {};

  // by v: along n, and second derivatives n n^T, t t^T and n t^T + t n^T
  void by_vector(const SideVector &v, double along, double across, double nn, double tt, double nt)
  {
    const double d = v.length(), nx = v.x / d, ny = v.y / d;
    first[V_X] += along * nx - across * ny;
    first[V_Y] += along * ny + across * nx;
    second[V_X][V_X] += nn * nx * nx + tt * ny * ny - 2.0 * nt * nx * ny;
    second[V_Y][V_Y] += nn * ny * ny + tt * nx * nx + 2.0 * nt * nx * ny;
    const double mixed = (nn - tt) * nx * ny + nt * (nx * nx - ny * ny);
    second[V_X][V_Y] += mixed;
    second[V_Y][V_X] += mixed;
  }
  void mixed(int a, int b, double value_)
  {
    second[a][b] += value_;
    second[b][a] += value_;
  }
};

// What the energy of a ring depends on. Lines are straight, unless CURVATURE is a variable.
struct Line {
  LineQuantity indentation, angle, curvature = {0.0};
  const LineQuantity &operator[](int q) const
  {
    return q == 0 ? indentation : q == 1 ? angle : curvature;
  }
};

// The angle of v: dtheta/dv = turn t,   d^2theta/dv dv = -turn^2 (n t^T + t n^T)
inline LineQuantity angle_of_vector(const SideVector &v)
{
  LineQuantity theta = {angle_of(v.x, v.y)};
  theta.by_vector(v, 0.0, v.turn, 0.0, 0.0, -v.turn * v.turn);
  return theta;
}

// A line at the distance |v|, of a wall: a = R - |v|
inline Line wall_line(const SideVector &v, double radius)
{
  LineQuantity a = {radius - v.length()};
  a.by_vector(v, -1.0, 0.0, 0.0, -v.turn, 0.0);
  return {a, angle_of_vector(v)};
}

// The radical axis: a and da/dd of contact_line,   d^2a/dd^2 = -(R_i^2 - R_j^2)/d^3
inline Line radical_line(const SideVector &v, double radius_i, double radius_j)
{
  const double d = v.length(), per_d = 1.0 / d;
  const ContactLine<double> line = contact_line(d, per_d, radius_i, radius_j);
  LineQuantity a = {line.indentation};
  const double slope = line.d_indentation;
  const double curvature = -(radius_i - radius_j) * (radius_i + radius_j) * per_d * per_d * per_d;
  a.by_vector(v, slope, 0.0, curvature, slope * v.turn, 0.0);
  return {a, angle_of_vector(v)};
}

// A line that is perpendicular to v, moved from the middle of the overlap towards the center:
//   a = (R_i + R_j - d)/2 + shift
inline Line shifted_line(const SideVector &v, double radius_i, double radius_j, double shift)
{
  LineQuantity a = {0.5 * (radius_i + radius_j - v.length()) + shift};
  a.by_vector(v, -0.5, 0.0, 0.0, -0.5 * v.turn, 0.0);
  a.first[SHIFT] = 1.0;
  return {a, angle_of_vector(v)};
}

// A line of any direction psi, with the normal m = (cos psi, sin psi), so moved:
//   a = (R_i + R_j - m.v)/2 + shift,   theta = psi
inline Line turned_line(const SideVector &v, double radius_i, double radius_j, double shift,
                        double direction)
{
  const double mx = std::cos(direction), my = std::sin(direction);
  const double along = mx * v.x + my * v.y, across = mx * v.y - my * v.x;
  LineQuantity a = {0.5 * (radius_i + radius_j - along) + shift}, theta = {angle_of(mx, my)};
  a.first[V_X] = -0.5 * mx;
  a.first[V_Y] = -0.5 * my;
  a.first[SHIFT] = 1.0;
  a.first[DIRECTION] = -0.5 * across;
  a.second[DIRECTION][DIRECTION] = 0.5 * along;
  a.mixed(DIRECTION, V_X, 0.5 * my);
  a.mixed(DIRECTION, V_Y, -0.5 * mx);
  theta.first[DIRECTION] = 1.0;
  Line line = {a, theta};
  line.curvature.first[CURVATURE] = 1.0;
  return line;
}

// Second derivatives of the energy of a ring by the indentations and the directions of its contacts.

struct RingHessian {
  std::vector<double> block;    // of a of the n active contacts, then of theta: (2n)^2 entries

  // memory
  std::vector<double> inverse, d_green, turn, turned, gradient, rate;
  RingLCP lcp;
};

// With D_ck = G'(theta_c - theta_k) and M = diag(D L) - D diag(L), because G L = a:
//   dL/da = G^-1,   dL/dtheta = -G^-1 M,
//   S_aa = G^-1,   S_atheta = -G^-1 M,   S_thetatheta = E + M^T G^-1 M,
//   E_ck = L_c L_k G''(theta_c - theta_k) for c != k,   E_cc = - sum of the others in its row,
// and with s = (L, S_theta), S_theta = -L (D L), and r = (G^-1 1, -M^T G^-1 1), the derivatives of U are those of
// expansion_terms.
inline void ring_hessian(const RingState &ring, int n, const int *active, RingHessian &h)
{
  const int size = 2 * n;
  h.block.assign(size * size, 0.0);
  for (auto *values : {&h.inverse, &h.d_green, &h.turn, &h.turned}) values->assign(n * n, 0.0);
  for (auto *values : {&h.gradient, &h.rate}) values->assign(size, 0.0);
  green_inverse(ring.contacts, n, active, h.lcp, h.inverse.data());
  const double p = ring.pressure;
  const auto length = [&](int m) { return ring.response[active[m]].length; };
  const auto add = [&](int row, int column, double value) {
    h.block[row * size + column] += 0.5 * p * value;
    h.block[column * size + row] += 0.5 * p * value;
  };

  for (int c = 0; c < n; ++c) {
    const Contact to = ring.contacts[active[c]];
    double slope = 0.0;    // (D L)_c
    for (int k = 0; k < n; ++k) {
      if (k == c) continue;
      const Contact from = ring.contacts[active[k]];
      const double difference = to.angle - from.angle, sign = std::copysign(1.0, difference);
      const double sine = sign * (from.nx * to.ny - from.ny * to.nx);
      const double cosine = from.nx * to.nx + from.ny * to.ny;
      const double D = sign * d_green(std::fabs(difference), sine, cosine);
      const double E = length(c) * length(k) * dd_green(std::fabs(difference), sine, cosine);
      slope += D * length(k);
      h.turn[c * n + k] = -D * length(k);
      add(n + c, n + k, E);
      add(n + c, n + c, -E);
    }
    h.turn[c * n + c] = slope;
    h.gradient[c] = length(c);
    h.gradient[n + c] = -length(c) * slope;
  }
  double lengths = 0.0, rates = 0.0;
  for (int c = 0; c < n; ++c) {
    lengths += length(c);
    for (int k = 0; k < n; ++k) {
      h.rate[c] += h.inverse[c * n + k];
      for (int m = 0; m < n; ++m) h.turned[c * n + k] += h.inverse[c * n + m] * h.turn[m * n + k];
    }
    rates += h.rate[c];
  }
  for (int c = 0; c < n; ++c)
    for (int k = 0; k < n; ++k) {
      h.rate[n + c] -= h.turn[k * n + c] * h.rate[k];
      add(c, k, h.inverse[c * n + k]);
      add(c, n + k, -2.0 * h.turned[c * n + k]);
      for (int m = 0; m < n; ++m) add(n + c, n + k, h.turn[m * n + c] * h.turned[m * n + k]);
    }

  const ExpansionTerms terms = expansion_terms(ring, lengths, rates);
  for (int c = 0; c < size; ++c)
    for (int k = 0; k < size; ++k)
      h.block[c * size + k] +=
          terms.square * h.gradient[c] * h.gradient[k] +
          terms.mixed * (h.gradient[c] * h.rate[k] + h.rate[c] * h.gradient[k]) -
          terms.rates * h.rate[c] * h.rate[k];
}

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
