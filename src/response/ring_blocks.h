// The energy of a particle of the ring laws as a function of its contact lines' local variables, to second order.

#ifndef DEFORMABLE_RING_BLOCKS_H
#define DEFORMABLE_RING_BLOCKS_H

#include "laws/contact.h"
#include "laws/ring_lcp.h"
#include "laws/soft_ring.h"
#include "laws/stiffness.h"
#include "response/curved_hessian.h"
#include "response/energy_blocks.h"
#include "response/ring_parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
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
// the first 2, 3 or 5 of them. A curved line depends on the skin of the particle too.
enum LineVariable { V_X, V_Y, SHIFT, DIRECTION, CURVATURE, THE_SKIN, LINE_VARIABLES };
constexpr int SIDE_VARIABLES = THE_SKIN;

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

// A line at the distance |v|, of a wall: a = R - |v| + shift. The direction is that by which the wall has turned.
inline Line wall_line(const SideVector &v, double radius, double shift)
{
  LineQuantity a = {radius - v.length() + shift}, theta = angle_of_vector(v);
  a.by_vector(v, -1.0, 0.0, 0.0, -v.turn, 0.0);
  a.first[SHIFT] = 1.0;
  theta.first[DIRECTION] = 1.0;
  return {a, theta};
}

// The radical axis, moved towards the center: a and da/dd of contact_line,   d^2a/dd^2 = -(R_i^2 - R_j^2)/d^3
inline Line radical_line(const SideVector &v, double radius_i, double radius_j, double shift)
{
  const double d = v.length(), per_d = 1.0 / d;
  const ContactLine<double> line = contact_line(d, per_d, radius_i, radius_j);
  LineQuantity a = {line.indentation + shift};
  const double slope = line.d_indentation;
  const double curvature = -(radius_i - radius_j) * (radius_i + radius_j) * per_d * per_d * per_d;
  a.by_vector(v, slope, 0.0, curvature, slope * v.turn, 0.0);
  a.first[SHIFT] = 1.0;
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

// The derivatives of U by the parameters of ring_parameters.h, and by these and by y. U is stationary in x = (delta, p), so that
//   U_yk = U_yx x_k,   U_kl = (U_k)_l + (U_k)_x x_l,   U_xx x_k = -(U_k)_x,
//   U_ydelta = p r,   U_yp = s,   U_deltadelta = w,   U_deltap = -2 pi q,   U_pp = -1/kA.
// `gradient`: U_k. Adds rows and columns to h.block.
inline bool add_parameters(const RingState &ring, int n, RingHessian &h,
                           std::vector<double> &gradient)
{
  constexpr int K = RING_PARAMETERS;
  const int size = 2 * n, all = size + K;
  const Stiffness &k = ring.stiffness;
  double two_pi_q = 2.0 * PI * (ring.radius + ring.expansion), rates = 0.0;
  for (int m = 0; m < n; ++m) {
    two_pi_q -= h.gradient[m];
    rates += h.rate[m];
  }
  const double w =
      ring.pressure * (rates - 2.0 * PI) + 4.0 * PI * PI * k.perimeter_stiffness(ring.expansion);
  const std::array<Dual, K> by = by_parameters(ring.radius, k, ring.expansion, ring.pressure);
  std::vector<double> balance = {w, -two_pi_q, -two_pi_q, -1.0 / k.kA}, follow(2 * K);
  if (k.conserves_perimeter()) balance = {1.0, 0.0, 0.0, -1.0 / k.kA};
  for (int c = 0; c < K; ++c) {
    follow[c] = k.conserves_perimeter() ? 0.0 : -by[c].by[K];
    follow[K + c] = -by[c].by[K + 1];
  }
  if (!solve_by_elimination(balance, follow, 2, K)) return false;
  std::vector<double> block(all * all, 0.0);
  for (int r = 0; r < size; ++r) {
    std::copy_n(&h.block[r * size], size, &block[r * all]);
    for (int c = 0; c < K; ++c)
      block[r * all + size + c] = block[(size + c) * all + r] =
          ring.pressure * h.rate[r] * follow[c] + h.gradient[r] * follow[K + c];
  }
  for (int r = 0; r < K; ++r) {
    gradient.push_back(by[r].value);
    for (int c = 0; c < K; ++c)
      block[(size + r) * all + size + c] =
          by[r].by[c] + by[r].by[K] * follow[c] + by[r].by[K + 1] * follow[K + c];
  }
  h.block = block;
  return true;
}

struct RingBlocks : EnergyBlocks {
  std::vector<double> force;     // p L of each side
  bool of_parameters = false;    // whether these are variables too

  // memory
  std::vector<Contact> contacts;
  std::vector<char> is_active;
  std::vector<int> active;
  std::vector<BentContact> bent;
  std::vector<double> by_quantity, local;
  std::vector<std::vector<std::pair<int, double>>> entries;    // of quantities, by variables
  Shape shape;
  RingHessian hessian;
  CurvedHessian curved;
};

// The parameters as variables: those of the table of particles, and the area A0.
enum ParameterVariable {
  BY_RADIUS,
  BY_KA,
  BY_KP,
  BY_SKIN,
  BY_TENSION,
  BY_AREA,
  PARAMETER_VARIABLES
};
constexpr int VARIABLE_OF_PARAMETER[RING_PARAMETERS] = {BY_RADIUS, BY_KA, BY_KP, BY_TENSION,
                                                        BY_AREA};

// Adds one particle. The energy of its ring depends on so many quantities y of each active line: its derivatives by them,
// in `gradient` and `block`, are those of the first quantity of all lines, then of the second one. With so many local
// variables x of each line,
//   dU/dx = sum_y U_y dy/dx,   d^2U/dx dx' = sum_yy' U_yy' dy/dx dy'/dx' + sum_y U_y d^2y/dx dx'.
// Where parameters are variables, the last quantities are those of the ring, and its radius is R less the skin.
inline void chain_lines(const std::vector<Line> &lines, const std::vector<int> &active,
                        int quantities, int variables, const double *gradient, const double *block,
                        RingBlocks &b)
{
  const int z = static_cast<int>(lines.size()), n = static_cast<int>(active.size());
  const int of_lines = z * variables, parameters = b.of_parameters ? RING_PARAMETERS : 0;
  const int size = of_lines + (b.of_parameters ? PARAMETER_VARIABLES : 0);
  const int all = quantities * n + parameters, count = variables + (b.of_parameters ? 1 : 0);
  const std::size_t first = b.gradient.size();
  b.gradient.resize(first + size);
  b.local.assign(size * size, 0.0);
  b.entries.resize(all);
  const auto place = [&](int m, int x) {
    return x < variables ? active[m] * variables + x : of_lines + BY_SKIN;
  };
  for (auto &entries : b.entries) entries.clear();
  for (int m = 0; m < n; ++m)
    for (int q = 0; q < quantities; ++q) {
      const LineQuantity &of = lines[active[m]][q];
      for (int x = 0; x < count; ++x) {
        if (of.first[x] != 0.0) b.entries[q * n + m].push_back({place(m, x), of.first[x]});
        for (int y = 0; y < count; ++y)
          b.local[place(m, x) * size + place(m, y)] += gradient[q * n + m] * of.second[x][y];
      }
    }
  for (int k = 0; k < parameters; ++k)
    b.entries[quantities * n + k].push_back({of_lines + VARIABLE_OF_PARAMETER[k], 1.0});
  if (parameters) b.entries[quantities * n + OF_RADIUS].push_back({of_lines + BY_SKIN, -1.0});
  for (int r = 0; r < all; ++r)
    for (const auto &[x, dx] : b.entries[r]) {
      b.gradient[first + x] += gradient[r] * dx;
      for (int c = 0; c < all; ++c)
        for (const auto &[y, dy] : b.entries[c])
          b.local[x * size + y] += dx * block[r * all + c] * dy;
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
  const RingState ring = {
      radius, b.shape.perimeter_excess / (2.0 * PI), k, p, contacts, b.shape.contact.data()};
  ring_hessian(ring, n, b.active.data(), b.hessian);
  for (int c = 0; c < z; ++c) b.force.push_back(p * b.shape.contact[c].d_indentation);
  b.by_quantity.resize(2 * n);
  for (int m = 0; m < n; ++m) {
    b.by_quantity[m] = p * b.shape.contact[b.active[m]].d_indentation;
    b.by_quantity[n + m] = p * b.shape.contact[b.active[m]].d_angle;
  }
  if (b.of_parameters && !add_parameters(ring, n, b.hessian, b.by_quantity)) return false;
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
    const RingState free = {radius, 0.0, k, k.rest_pressure(radius), {0, nullptr}, nullptr};
    for (auto *values : {&b.by_quantity, &b.hessian.block}) values->clear();
    if (b.of_parameters && !add_parameters(free, 0, b.hessian, b.by_quantity)) return false;
    chain_lines(lines, b.active, 3, SIDE_VARIABLES, b.by_quantity.data(), b.hessian.block.data(),
                b);
    return true;
  }
  if (!curved_hessian(radius, k, b.bent, b.of_parameters, h)) return false;
  for (std::size_t m = 0; m < b.active.size(); ++m) {
    LineQuantity &curvature = lines[b.active[m]].curvature;
    if (curvature.first[CURVATURE] == 0.0) continue;    // of a wall
    const double wider = 1.0 + skin * h.curvature[m];
    curvature.first[CURVATURE] = wider * wider;
    curvature.second[CURVATURE][CURVATURE] = 2.0 * skin * wider * wider * wider;
    curvature.first[THE_SKIN] = h.curvature[m] * h.curvature[m];
    curvature.second[THE_SKIN][THE_SKIN] = 2.0 * h.curvature[m] * curvature.first[THE_SKIN];
    curvature.mixed(CURVATURE, THE_SKIN, 2.0 * h.curvature[m] * wider * wider);
  }
  b.by_quantity = h.by_indentation;
  b.by_quantity.insert(b.by_quantity.end(), h.by_angle.begin(), h.by_angle.end());
  b.by_quantity.insert(b.by_quantity.end(), h.by_curvature.begin(), h.by_curvature.end());
  b.by_quantity.insert(b.by_quantity.end(), h.by_parameter.begin(), h.by_parameter.end());
  chain_lines(lines, b.active, 3, SIDE_VARIABLES, b.by_quantity.data(), h.block.data(), b);
  b.energy += h.energy;
  return true;
}

}    // namespace deformable

#endif
