// The energy of a droplet as a function of the vectors to its neighbors and of the places of its facets, to second order.

#ifndef DEFORMABLE_DROPLET_BLOCKS_H
#define DEFORMABLE_DROPLET_BLOCKS_H

#include "laws/droplet.h"
#include "response/energy_blocks.h"

#include <array>
#include <cmath>
#include <vector>

namespace deformable {

// A contact of a droplet at rest. Its facet has the indentation a = const - share |v| + s, with the vector v to a neighbor
// (share 1/2) or to the nearest point of a wall (share 1), and the shift s of the facet. `turn`: see SideVector.
struct DropletSide {
  std::array<double, 3> vector;
  double turn, share, force;
};

constexpr int DROPLET_VARIABLES = 4;    // v and s of each side

// A compliance beyond this condition counts as singular.
constexpr double LARGEST_CONDITION = 1e12;

// U(a, n) = F.a - W(F, n), stationary in F. With the compliance A = W_FF, all variables x of the sides and D = d(a - W_F)/dx,
//   U_x = F.a_x - W_x,   U_xx = F.a_xx - W_xx + D^T A^-1 D,
// where x changes a and n: with P = 1 - n n^T,
//   a_v = -share n,   a_vv = -share turn P,   n_v = turn P,   g.n_vv = -turn^2 [(g.n) P + (P g) n^T + n (P g)^T],
// and in units of R and g R, with m = n_c.n_k,
//   W_n = f_c t_c,   t_c = sum_k G' f_k n_k,   d(W_f)_c/dn_c = t_c,   d(W_f)_c/dn_k = G' f_k n_c,
//   d^2W/dn_c dn_k = f_c f_k (G' + G'' n_k n_c^T),   d^2W/dn_c dn_c = f_c sum_k f_k G'' n_k n_k^T.
// A need not be positive definite: that of all droplets of a packing together is. False: it is singular.
inline bool add_droplet(const std::vector<DropletSide> &sides, double radius, double tension,
                        EnergyBlocks &blocks)
{
  const int z = static_cast<int>(sides.size()), V = DROPLET_VARIABLES, size = V * z;
  const double unit = radius * tension, energy = unit * radius;
  using Vector = std::array<double, 3>;
  std::vector<Vector> n(z), t(z, Vector{});
  std::vector<double> f(z), length(z), A(z * z), D(z * size), local(size * size);
  double sum = 0.0, squares = 0.0;
  for (int c = 0; c < z; ++c) {
    const Vector &v = sides[c].vector;
    length[c] = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int a = 0; a < 3; ++a) n[c][a] = v[a] / length[c];
    f[c] = sides[c].force / unit;
    sum += f[c];
    squares += f[c] * f[c];
  }
  const DropletLoad<double> load(sum, squares, [](double q) { return std::log(q); });
  // the part of a vector, or of both sides of a matrix, that turns n_c
  const auto across = [&n](int c, int a, int b) {
    return (a == b ? 1.0 : 0.0) - n[c][a] * n[c][b];
  };

  double work = 0.0, product = 0.0;
  for (int c = 0; c < z; ++c) {
    const double l = LOG_8_PI - std::log(f[c]), turn = sides[c].turn, share = sides[c].share;
    double response = 0.0;
    double bend[3][3] = {};    // sum_k f_k G'' n_k n_k^T
    for (int k = 0; k < z; ++k) {
      const double shared = (f[c] + f[k]) * load.slope * (0.25 / PI) + load.squares * load.bend;
      if (k == c) {
        A[c * z + c] = (own_compliance(l, load.logarithm) + shared) / tension;
        continue;
      }
      const double m = n[c][0] * n[k][0] + n[c][1] * n[k][1] + n[c][2] * n[k][2];
      const double half = std::max(0.5 - 0.5 * m, SMALLEST_HALF), log_half = std::log(half);
      const bool apart = half > SMALLEST_HALF;
      const double G = droplet_green(m, log_half),
                   dG = apart ? d_droplet_green(m, log_half, 1.0 / half) : 0.0,
                   ddG = apart ? dd_droplet_green(1.0 / half) : 0.0;
      A[c * z + k] = (G + shared) / tension;
      response += G * f[k];
      for (int a = 0; a < 3; ++a) {
        t[c][a] += dG * f[k] * n[k][a];
        for (int b = 0; b < 3; ++b) bend[a][b] += f[k] * ddG * n[k][a] * n[k][b];
      }
      for (int b = 0; b < 3; ++b) {    // of the vector to k
        const double turned = sides[k].turn * (n[c][b] - m * n[k][b]);
        D[c * size + V * k + b] -= radius * dG * f[k] * turned;
      }
      // -turn_c turn_k P_c (G' + G'' n_k n_c^T) P_k
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
          const double both = across(c, a, b) - n[k][b] * (n[k][a] - m * n[c][a]);
          const double bent = (n[k][a] - m * n[c][a]) * (n[c][b] - m * n[k][b]);
          local[(V * c + a) * size + V * k + b] -=
              energy * f[c] * f[k] * turn * sides[k].turn * (dG * both + ddG * bent);
        }
    }
    const double a_c =
        radius * (own_indentation(f[c], l, load.logarithm) + response + load.squares * load.slope);
    work += energy * (own_work(f[c], l, load.logarithm) + 0.5 * f[c] * response);
    product += sides[c].force * a_c;

    const double along = t[c][0] * n[c][0] + t[c][1] * n[c][1] + t[c][2] * n[c][2];
    Vector sideways, bent_along{};    // P t, and (sum_k f_k G'' n_k n_k^T) n_c
    for (int a = 0; a < 3; ++a) {
      sideways[a] = t[c][a] - along * n[c][a];
      for (int b = 0; b < 3; ++b) bent_along[a] += bend[a][b] * n[c][b];
    }
    double twice = 0.0;
    for (int a = 0; a < 3; ++a) twice += bent_along[a] * n[c][a];
    for (int a = 0; a < 3; ++a) {
      blocks.gradient.push_back(-share * sides[c].force * n[c][a] -
                                energy * f[c] * turn * sideways[a]);
      D[c * size + V * c + a] += -share * n[c][a] - radius * turn * sideways[a];
      for (int b = 0; b < 3; ++b) {
        const double P = across(c, a, b);
        const double both = bend[a][b] - n[c][a] * bent_along[b] - bent_along[a] * n[c][b] +
                            twice * n[c][a] * n[c][b];
        const double curved = along * P + sideways[a] * n[c][b] + n[c][a] * sideways[b];
        local[(V * c + a) * size + V * c + b] +=
            -share * turn * sides[c].force * P + energy * f[c] * turn * turn * (curved - both);
      }
    }
    blocks.gradient.push_back(sides[c].force);
    D[c * size + V * c + 3] += 1.0;
  }
  std::vector<double> taken = D;    // A^-1 D
  if (!solve_by_elimination(A, taken, z, size)) return false;
  double largest = 0.0, inverse = 0.0;    // entries of A, and of A^-1: D has a 1 for each shift
  for (int c = 0; c < z; ++c)
    for (int k = 0; k < z; ++k) {
      largest = std::max(largest, std::fabs(A[c * z + k]));
      inverse = std::max(inverse, std::fabs(taken[c * size + V * k + 3]));
    }
  if (!(largest * inverse < LARGEST_CONDITION)) return false;
  for (int x = 0; x < size; ++x)
    for (int y = 0; y < size; ++y)
      for (int c = 0; c < z; ++c)
        local[x * size + y] +=
            0.5 * (D[c * size + x] * taken[c * size + y] + D[c * size + y] * taken[c * size + x]);
  blocks.energy += product - work;
  blocks.add_block(blocks.gradient.size() - size, size, local.data());
  return true;
}

}    // namespace deformable

#endif
