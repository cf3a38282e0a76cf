// The dual energy of a droplet as a function of the vectors to its neighbors and of its forces, to second order.

#ifndef DEFORMABLE_DROPLET_BLOCKS_H
#define DEFORMABLE_DROPLET_BLOCKS_H

#include "laws/droplet_film.h"
#include "response/dual.h"
#include "response/energy_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace deformable {

// A droplet between contacts, in units of R and g R: W(f, n) of droplet.h with a further term,
//   W + sum f^2/(8 pi) film + sum_c weight_c.t_c,
// its derivatives a by the forces, and by the normals, of which only the parts across them count. Where films have a sine, W is the W_0
// of droplet_film.h.
template <class T> struct LoadedDroplet {
  using Vector = std::array<T, 3>;
  T work, load, damping;
  std::vector<T> indentation;
  std::vector<Vector> facet, by_normal;    // t

  static T product(const Vector &a, const Vector &b)
  {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }

  LoadedDroplet(const std::vector<T> &f, const std::vector<Vector> &n,
                const std::vector<double> &film, const std::vector<T> &sine,
                const std::vector<Vector> &weight)
      : work(0.0),
        load(0.0),
        damping(0.0),
        indentation(f.size()),
        facet(f.size(), Vector{}),
        by_normal(f.size(), Vector{})
  {
    const std::size_t z = f.size();
    T sum(0.0), squares(0.0), cubes(0.0), sum_of_e(0.0), squares_of_e(0.0);
    bool sticks = false;
    Vector balance{};
    std::array<Vector, 3> Q{};
    for (std::size_t c = 0; c < z; ++c) {
      const T e = f[c] + PI * (sine[c] * sine[c]);
      sum_of_e += e;
      squares_of_e += e * e;
      sticks |= sine[c] > 0.0;
      sum += f[c];
      squares += f[c] * f[c];
      cubes += f[c] * f[c] * f[c];
      for (int a = 0; a < 3; ++a) {
        balance[a] += f[c] * n[c][a];
        for (int b = 0; b < 3; ++b) Q[a][b] += f[c] * n[c][a] * n[c][b];
      }
    }
    const T mean = (Q[0][0] + Q[1][1] + Q[2][2]) * (1.0 / 3.0);
    for (int a = 0; a < 3; ++a) Q[a][a] -= mean;
    const auto of_log = [](const T &x) { return log(x); };
    const auto of_exp = [](const T &x) { return exp(x); };
    T tilt(0.0);
    const DropletLoad<T> of = [&]() -> DropletLoad<T> {
      if (!sticks) return {sum, squares, of_log, of_exp};
      const FilmLoad<T> with_films(sum, squares, sum_of_e, squares_of_e, of_log, of_exp);
      tilt = with_films.tilt;
      return with_films;
    }();
    load = of.x;
    damping = of.damping;

    // of each two contacts
    struct Between {
      T m, g, dg, slope, bend, g2, dg2;
    };
    std::vector<Between> between(z * z);
    std::vector<T> first(z, T(0.0)), second(z, T(0.0)), squared(z, T(0.0)), squared2(z, T(0.0));
    for (std::size_t c = 0; c < z; ++c)
      for (std::size_t k = 0; k < z; ++k) {
        Between &e = between[c * z + k];
        if (c == k) {
          e.g2 = T(GREEN2_AT_ONE);
        } else {
          e.m = product(n[c], n[k]);
          const T apart = 0.5 - 0.5 * e.m, q = apart > SMALLEST_HALF ? apart : T(SMALLEST_HALF),
                  log_q = log(q), over = 1.0 / q;
          const bool is_far = apart > SMALLEST_APART;
          const T steep = d_droplet_green(e.m, log_q, over);
          e.g = droplet_green(e.m, log_q);
          e.dg = apart > SMALLEST_HALF ? steep : T(0.0);
          e.slope = is_far ? steep : T(SLOPE_AT_SMALLEST);
          e.bend = is_far ? dd_droplet_green(e.m, over) : T(0.0);
          e.g2 = droplet_green2(q, log_q);
          e.dg2 = d_droplet_green2(q, log_q);
        }
        first[c] += e.g * f[k];
        second[c] += e.g2 * f[k];
        squared[c] += e.g * f[k] * f[k];
        squared2[c] += e.g2 * f[k] * f[k];
        if (c == k) continue;
        for (int a = 0; a < 3; ++a) facet[c][a] -= e.slope * f[k] * (n[k][a] - e.m * n[c][a]);
      }

    T T1(0.0), J(0.0), of_green2(0.0);
    std::vector<Vector> v(z);
    for (std::size_t c = 0; c < z; ++c) {
      T1 -= 0.5 * f[c] * product(facet[c], facet[c]);
      J += f[c] * second[c];
      of_green2 += f[c] * f[c] * second[c];
      for (int a = 0; a < 3; ++a) v[c][a] = weight[c][a] - of.first * f[c] * facet[c][a];
      work += product(weight[c], facet[c]);
    }
    std::array<Vector, 3> QQ{};
    T trace2(0.0), trace3(0.0);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        for (int e = 0; e < 3; ++e) QQ[a][b] += Q[a][e] * Q[e][b];
        trace2 += Q[a][b] * Q[a][b];
      }
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) trace3 += QQ[a][b] * Q[b][a];
    const T cubic = CUBE_TRACE * trace3 + CUBE_FORCES * cubes + CUBE_GREEN2 * of_green2;
    const SharedTerms<T> shared(of, T1, J, cubic, product(balance, balance));
    work += shared.work;

    for (std::size_t c = 0; c < z; ++c) {
      const T l = LOG_8_PI - log(some_force(f[c]));
      work += own_work(f[c], l, T(film[c]), of.psi) + first[c] * f[c] * (0.5 - f[c] * (0.25 / PI));
      Vector Qn{}, QQn{};
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
          Qn[a] += Q[a][b] * n[c][b];
          QQn[a] += QQ[a][b] * n[c][b];
        }
      T back(0.0);
      for (std::size_t k = 0; k < z; ++k) {
        if (k == c) continue;
        const Between &e = between[c * z + k];
        const T both = f[c] + f[k], here = product(v[c], n[c]), there = product(v[k], n[k]);
        const T of_c = product(v[c], n[k]) - e.m * here, of_k = product(v[k], n[c]) - e.m * there;
        back += e.slope * of_k;
        const T by =
            f[c] * f[k] *
                (e.dg * (1.0 - both * (0.25 / PI)) +
                 e.dg2 * (4.0 * of.x * of.first + (2.0 / 3.0 * CUBE_GREEN2) * of.third * both)) -
            f[k] * (e.bend * of_c - e.slope * here) - f[c] * (e.bend * of_k - e.slope * there);
        for (int a = 0; a < 3; ++a)
          by_normal[c][a] +=
              by * n[k][a] - e.slope * f[c] * v[k][a] + e.slope * e.m * f[k] * v[c][a];
      }
      for (int a = 0; a < 3; ++a)
        by_normal[c][a] +=
            f[c] * (4.0 * CUBE_TRACE * of.third * QQn[a] + BALANCE * of.held * balance[a]);
      const T of_cube = 2.0 * CUBE_TRACE * (product(Qn, Qn) - trace2 * (1.0 / 3.0)) +
                        2.0 * CUBE_FORCES * f[c] * f[c] +
                        (2.0 / 3.0 * CUBE_GREEN2) * (2.0 * f[c] * second[c] + squared2[c]);
      indentation[c] = own_indentation(f[c], l, T(film[c]), of.stretch) +
                       first[c] * (1.0 - f[c] * (0.5 / PI)) - squared[c] * (0.25 / PI) +
                       of.first * (4.0 * of.x * second[c] - 0.5 * product(facet[c], facet[c])) +
                       of.third * of_cube + BALANCE * of.held * product(n[c], balance) +
                       shared.by_force - back + tilt * (sine[c] * sine[c]);
    }
  }
};

// A contact of a droplet: its vector, the overlap, of which the droplet has this part (half of a pair, all of a wall), ln(lambda) of
// the film, the force, the sine of the contact angle, and what multiplies t in the second derivatives, over R^2 and the tension.
struct DropletSide {
  SpaceVector vector;
  double overlap, part, film, force, sine;
  std::array<double, 3> weight;
};

// R t of each side, and D.
struct DropletFacets {
  std::vector<std::array<double, 3>> place;
  double damping;
};

inline DropletFacets droplet_facets(const std::vector<DropletSide> &sides, double radius,
                                    double tension)
{
  const std::size_t z = sides.size();
  std::vector<double> f(z), sine(z);
  std::vector<std::array<double, 3>> n(z), none(z, std::array<double, 3>{});
  for (std::size_t c = 0; c < z; ++c) {
    f[c] = sides[c].force / (radius * tension);
    sine[c] = sides[c].sine;
    n[c] = sides[c].vector.direction();
  }
  const LoadedDroplet<double> loaded(f, n, std::vector<double>(z), sine, none);
  DropletFacets found = {loaded.facet, loaded.damping};
  for (auto &place : found.place)
    for (double &t : place) t *= radius;
  return found;
}

// The normal n of a side whose vector changes by d, a variable, and by how much its length grows:
//   r = r0 + d - (axis.d) axis,   n = fixed + round r/|r|,   |v| = |v0| + fixed.d + round (|r| - |r0|)
// with the vector r0 to the point about which n turns, see SpaceVector, and round = +-|part of n across the axis|.
struct TurningNormal {
  using Vector = std::array<Dual, 3>;
  Vector n;
  Dual farther;

  TurningNormal(const SpaceVector &v, std::size_t first, std::size_t size)
      : farther(0.0),
        axis(v.axis),
        to_middle{},
        per_distance(0.0)
  {
    const std::array<double, 3> out = v.direction();
    double along = 0.0, square = 0.0;
    for (int a = 0; a < 3; ++a) along += out[a] * axis[a];
    for (int a = 0; a < 3; ++a) square += (out[a] - along * axis[a]) * (out[a] - along * axis[a]);
    const bool turns = v.turn != 0.0;
    const double round = std::copysign(std::sqrt(square), v.turn);
    Vector step;
    Dual along_axis(0.0), distance_square(0.0);
    for (int a = 0; a < 3; ++a) {
      step[a] = Dual::variable(0.0, first + a, size);
      along_axis += step[a] * axis[a];
    }
    for (int a = 0; a < 3; ++a) {
      const double across = turns ? out[a] - along * axis[a] : 0.0;
      n[a] = out[a] - across;
      farther += step[a] * (out[a] - across);
      if (!turns) continue;
      to_middle[a] = across / v.turn + step[a] - along_axis * axis[a];
      distance_square += to_middle[a] * to_middle[a];
    }
    if (!turns) return;
    const Dual distance = sqrt(distance_square);
    per_distance = round / distance;
    farther += round * (distance - distance.value);
    for (int a = 0; a < 3; ++a) {
      n[a] += per_distance * to_middle[a];
      to_middle[a] = to_middle[a] / distance;
    }
  }

  // (dn/dv) w
  Vector turned(const Vector &w) const
  {
    Dual along_axis(0.0), outward(0.0);
    for (int a = 0; a < 3; ++a) {
      along_axis += w[a] * axis[a];
      outward += w[a] * to_middle[a];
    }
    Vector result;
    for (int a = 0; a < 3; ++a)
      result[a] = per_distance * (w[a] - along_axis * axis[a] - outward * to_middle[a]);
    return result;
  }

 private:
  std::array<double, 3> axis;
  Vector to_middle;    // a unit vector
  Dual per_distance;
};

// v and F of each side, and a turn of its normal.
constexpr int DROPLET_VARIABLES = 4, TURNING_VARIABLES = DROPLET_VARIABLES + 3;

// A vector b that turns by small angles a becomes b + a x b.
template <class T> std::array<T, 3> crossed(const std::array<T, 3> &a, const std::array<T, 3> &b)
{
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Derivatives E_t of an energy by parameters t, `gradient`, and those of its first derivatives by the local variables, with a row for
// each of these and a column for each parameter.
struct ParameterBlocks : EnergyBlocks {
  void add(std::size_t variable, double mixed)
  {
    row.push_back(static_cast<int>(variable));
    column.push_back(static_cast<int>(gradient.size()));
    value.push_back(mixed);
  }
  // E_t with its derivatives by the variables from `first` on.
  void add(std::size_t first, std::size_t size, const Dual &by)
  {
    for (std::size_t v = 0; v < std::min(size, by.by.size()); ++v) add(first + v, by.by[v]);
    gradient.push_back(by.value);
  }
};

// L = sum part F o - W(F, n) - sum weight.t of a droplet, whose value and first derivatives leave out the last term:
//   L_F = part o - a,   L_v = -part F n - (dn/dv) W_n,
// and their derivatives by those of dual numbers. `facets`: the derivatives of R t, three rows for each side.
// `turning`: each side turns about the droplet by angles w, which are variables too. v turns with it:  n = R(w) n(v),
//   L_v = -part F n(v) - (dn/dv) R^-1 W_n,   L_w = -n x W_n
// The last one is by a further turn: the symmetric part of its derivatives by w is that of the second derivatives by w.
// `parameters`, unless null: ln(lambda) and contact angle of each side, then R and tension g. In units of R and g R the work W depends
// on these by f = F/(g R) alone,
//   L_R = g R (sum f a - 2 W),   L_g = R^2 (sum f a - W),   L_ln(lambda) = -g R^2 f^2/(8 pi).
inline void add_droplet(const std::vector<DropletSide> &sides, double radius, double tension,
                        bool turning, EnergyBlocks &blocks, EnergyBlocks &facets,
                        ParameterBlocks *parameters)
{
  const std::size_t z = sides.size(), V = turning ? TURNING_VARIABLES : DROPLET_VARIABLES,
                    size = V * z, all = size + (parameters ? z : 0);
  const double unit = radius * tension, energy = unit * radius;
  const int first = static_cast<int>(blocks.gradient.size()),
            first_row = static_cast<int>(facets.gradient.size());
  using Vector = LoadedDroplet<Dual>::Vector;
  std::vector<double> film(z), local(size * size), of_sine(size * z);
  std::vector<Vector> n(z), weight(z), turn(z);
  std::vector<Dual> f(z), sine(z);
  std::vector<TurningNormal> normal;
  for (std::size_t c = 0; c < z; ++c) {
    film[c] = sides[c].film;
    sine[c] = parameters ? Dual::variable(sides[c].sine, size + c, all) : Dual(sides[c].sine);
    for (std::size_t a = 0; a < 3; ++a) weight[c][a] = sides[c].weight[a];
    f[c] = Dual::variable(sides[c].force, V * c + 3, all) / unit;
    normal.emplace_back(sides[c].vector, V * c, all);
    n[c] = normal[c].n;
    if (!turning) continue;
    for (std::size_t a = 0; a < 3; ++a)
      turn[c][a] = Dual::variable(0.0, V * c + DROPLET_VARIABLES + a, all);
    const Vector step = crossed(turn[c], normal[c].n);
    for (std::size_t a = 0; a < 3; ++a) n[c][a] += step[a];
  }
  const LoadedDroplet<Dual> loaded(f, n, film, sine, weight);
  const LoadedDroplet<Dual> alone(f, n, film, sine, std::vector<Vector>(z, Vector{}));
  blocks.energy -= energy * alone.work.value;
  for (std::size_t c = 0; c < z; ++c) {
    const double part = sides[c].part;
    blocks.energy += part * sides[c].force * sides[c].overlap;
    const auto slope = [&](const LoadedDroplet<Dual> &droplet, std::size_t variable) {
      if (variable == 3)
        return part * (sides[c].overlap - normal[c].farther) - radius * droplet.indentation[c];
      Vector by = droplet.by_normal[c];
      if (variable > 3) {
        const std::size_t axis = variable - DROPLET_VARIABLES;
        return -energy * crossed(n[c], by)[axis];
      }
      if (turning) {
        const Vector back = crossed(turn[c], by);
        for (std::size_t a = 0; a < 3; ++a) by[a] -= back[a];
      }
      return -part * unit * f[c] * normal[c].n[variable] - energy * normal[c].turned(by)[variable];
    };
    for (std::size_t a = 0; a < V; ++a) {
      blocks.gradient.push_back(slope(alone, a).value);
      const Dual second = slope(loaded, a);
      const auto end = second.by.begin() + static_cast<std::ptrdiff_t>(size);
      std::copy(second.by.begin(), end, local.begin() + (V * c + a) * size);
      if (parameters) std::copy(end, second.by.end(), of_sine.begin() + (V * c + a) * z);
    }
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t along = 0; along < std::min(size, loaded.facet[c][a].by.size()); ++along) {
        facets.row.push_back(first_row + static_cast<int>(3 * c + a));
        facets.column.push_back(first + static_cast<int>(along));
        facets.value.push_back(radius * loaded.facet[c][a].by[along]);
      }
  }
  for (std::size_t r = 0; r < size; ++r)    // to the last bit
    for (std::size_t c = 0; c < r; ++c)
      local[r * size + c] = local[c * size + r] = 0.5 * (local[r * size + c] + local[c * size + r]);
  blocks.add_block(first, size, local.data());
  facets.gradient.resize(first_row + 3 * z);
  if (!parameters) return;
  Dual moment(0.0);
  for (std::size_t c = 0; c < z; ++c) {
    moment += f[c] * alone.indentation[c];
    parameters->add(first, size, -energy * BY_SUM * f[c] * f[c]);
    const double cosine = std::sqrt(1.0 - sides[c].sine * sides[c].sine);
    for (std::size_t v = 0; v < size; ++v) parameters->add(first + v, cosine * of_sine[v * z + c]);
    const bool depends = alone.work.by.size() == all;
    parameters->gradient.push_back(depends ? -energy * cosine * alone.work.by[size + c] : 0.0);
  }
  parameters->add(first, size, unit * (moment - 2.0 * alone.work));
  parameters->add(first, size, radius * radius * (moment - alone.work));
}

// A contact of a droplet that has films: its force, and of a film the angle and lambda.
struct StretchSide {
  double force, angle, lean;
};

// What films add to the energy of a droplet, with the stretch L and the pressure P as variables; W is stationary in both.
// In units of R and g R,
//   -{sum u(f, P lambda) + P V0 (L^3 - 1) - (L - 1) sum (f - f^2/(8 pi)) - 4 pi (L^2 - 1)} = -w(f, L, P)
// The local variables are F of each side, then L and P. `parameters`, unless null: angle and lambda of each side, then R and g, by
//   E_R = -g R (2 w - sum f w_f),   E_g = -R^2 (w - sum f w_f).
inline void add_stretch(const std::vector<StretchSide> &sides, double radius, double tension,
                        double L, double P, EnergyBlocks &blocks, ParameterBlocks *parameters)
{
  constexpr double VOLUME = 4.0 / 3.0 * PI;
  const std::size_t z = sides.size(), size = z + 2, first = blocks.gradient.size();
  const double unit = radius * tension, energy = unit * radius;
  std::vector<double> by(size), block(size * size);
  const auto second = [&](std::size_t r, std::size_t c, double value) {
    block[r * size + c] = block[c * size + r] = value;
  };
  double work = P * VOLUME * (L * L * L - 1.0) - 4.0 * PI * (L * L - 1.0), of_PP = 0.0;
  by[z] = 3.0 * P * VOLUME * L * L - 8.0 * PI * L;
  by[z + 1] = VOLUME * (L * L * L - 1.0);
  for (std::size_t c = 0; c < z; ++c) {
    const double f = sides[c].force / unit, lean = sides[c].lean, at = P * lean,
                 half = std::sin(0.5 * sides[c].angle), free = f - f * f * BY_SUM;
    const FilmTerm<double> u(f, std::log(some_force(f)), at, std::log(at), std::sin(sides[c].angle),
                             2.0 * half * half, [](double x) { return std::log(x); });
    work += u.u - (L - 1.0) * free;
    by[c] = u.f + (L - 1.0) * (f * (0.25 / PI) - 1.0);
    by[z] -= free;
    by[z + 1] += lean * u.P;
    second(c, c, u.ff + (L - 1.0) * (0.25 / PI));
    second(c, z, f * (0.25 / PI) - 1.0);
    second(c, z + 1, lean * u.fP);
    of_PP += lean * lean * u.PP;
    if (!parameters) continue;
    const Dual angle = Dual::variable(sides[c].angle, 0, 2), leans = Dual::variable(lean, 1, 2);
    const Dual part = sin(0.5 * angle), pressure = P * leans;
    const FilmTerm<Dual> of(f, log(some_force(Dual(f))), pressure, log(pressure), sin(angle),
                            2.0 * part * part, [](const Dual &x) { return log(x); });
    const Dual by_P = leans * of.P;
    for (std::size_t k = 0; k < 2; ++k) {
      if (of.f.by.size() == 2) {
        parameters->add(first + c, -radius * of.f.by[k]);
        parameters->add(first + z + 1, -energy * by_P.by[k]);
      }
      parameters->gradient.push_back(of.u.by.size() == 2 ? -energy * of.u.by[k] : 0.0);
    }
  }
  second(z, z, 6.0 * P * VOLUME * L - 8.0 * PI);
  second(z, z + 1, 3.0 * VOLUME * L * L);
  second(z + 1, z + 1, of_PP);
  if (parameters) {
    double moment = 0.0;
    std::vector<double> moments(size);    // sum f w_f by the variables
    for (std::size_t c = 0; c < z; ++c) {
      const double f = sides[c].force / unit;
      moment += f * by[c];
      moments[c] += by[c];
      for (std::size_t v = 0; v < size; ++v) moments[v] += f * block[c * size + v];
    }
    const double factors[2] = {unit, radius * radius}, works[2] = {2.0, 1.0};
    for (int k = 0; k < 2; ++k) {
      for (std::size_t v = 0; v < size; ++v)
        parameters->add(first + v,
                        -factors[k] * (works[k] * by[v] - moments[v]) / (v < z ? unit : 1.0));
      parameters->gradient.push_back(-factors[k] * (works[k] * work - moment));
    }
  }
  const auto scale = [&](std::size_t a) { return a < z ? 1.0 / unit : 1.0; };
  blocks.energy -= energy * work;
  for (std::size_t r = 0; r < size; ++r) {
    blocks.gradient.push_back(-energy * scale(r) * by[r]);
    for (std::size_t c = 0; c < size; ++c) block[r * size + c] *= -energy * scale(r) * scale(c);
  }
  blocks.add_block(first, size, block.data());
}

// Minus the further term of a film between droplets of one tension and unlike radii, see CurvedFilm. The local variables are F, and P
// of both droplets in units of g/R. `parameters`, unless null: both radii, the tension and the contact angle.
inline void add_cap(double force, const double (&P)[2], const double (&radius)[2], double tension,
                    double angle, EnergyBlocks &blocks, ParameterBlocks *parameters)
{
  const std::size_t of_parameters = 4, all = 3 + (parameters ? of_parameters : 0);
  const auto number = [&](double x, std::size_t n) {
    return n < all ? Dual::variable(x, n, all) : Dual(x);
  };
  const Dual g = number(tension, 5), turned = number(angle, 6), half = sin(0.5 * turned);
  const Dual of_P[2] = {g / number(radius[0], 3), g / number(radius[1], 4)};
  const CurvedFilm<Dual> film(number(force, 0), of_P[0] * number(P[0], 1),
                              of_P[1] * number(P[1], 2), g, sin(turned), 2.0 * half * half,
                              [](const Dual &x) { return log(x); });
  const Dual by[3] = {film.by_force, of_P[0] * film.by_p_i, of_P[1] * film.by_p_j};
  double block[9];
  const std::size_t first = blocks.gradient.size();
  blocks.energy -= film.energy.value;
  for (int r = 0; r < 3; ++r) {
    blocks.gradient.push_back(-by[r].value);
    for (int c = 0; c < 3; ++c) block[3 * r + c] = -0.5 * (by[r].by[c] + by[c].by[r]);
  }
  blocks.add_block(first, 3, block);
  for (std::size_t k = 3; k < all; ++k) {
    for (std::size_t v = 0; v < 3; ++v) parameters->add(first + v, -by[v].by[k]);
    parameters->gradient.push_back(-film.energy.by[k]);
  }
}

}    // namespace deformable

#endif
