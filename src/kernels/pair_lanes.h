// Loops over the pairs that bear forces, for DualSolver and PairList (src/solver).
//
// A loop takes vectors, then the rest one by one: T is Lanes or double. Sums have LANES parts on every level, so that
// all levels add in the same order.

#ifndef DEFORMABLE_PAIR_LANES_H
#define DEFORMABLE_PAIR_LANES_H

#include "kernels/force_kernels.h"
#include "kernels/lane_geometry.h"
#include "laws/contact.h"
#include "laws/contact_curve.h"

namespace deformable::DEFORMABLE_LEVEL {

template <class Body> DEFORMABLE_LANE_FUNCTION void for_pairs(int begin, int end, Body &&body)
{
  int k = begin;
  for (; k + W <= end; k += W) body(Lanes{}, k);
  for (; k < end; ++k) body(0.0, k);
}

template <class Term> DEFORMABLE_LANE_FUNCTION double sum_of(int begin, int end, Term &&term)
{
  Lanes part[LANES / W] = {};
  int k = begin;
  for (; k + LANES <= end; k += LANES)
#pragma GCC unroll 8
    for (int n = 0; n < LANES / W; ++n) part[n] += term(Lanes{}, k + n * W);
  double sum = 0.0;
  for (const Lanes &p : part)
    for (int w = 0; w < W; ++w) sum += p[w];
  for (; k < end; ++k) sum += term(0.0, k);
  return sum;
}

static bool locate_pairs(PairPlaces p, int begin, int end)
{
  bool apart = true;
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const auto of_i = [&](const double *y, int stride) DEFORMABLE_LANE_LAMBDA {
      return gather<T>(y, [&](int w) DEFORMABLE_LANE_LAMBDA { return stride * p.i[k + w]; });
    };
    const auto of_j = [&](const double *y, int stride) DEFORMABLE_LANE_LAMBDA {
      return gather<T>(y, [&](int w) DEFORMABLE_LANE_LAMBDA { return stride * p.j[k + w]; });
    };
    const T dx = of_j(p.x, 3) - of_i(p.x, 3), dy = of_j(p.x + 1, 3) - of_i(p.x + 1, 3);
    const T ri = of_i(p.radius, 1), rj = of_j(p.radius, 1);
    const T d = root(dx * dx + dy * dy), per_d = 1.0 / d, small = smaller(ri, rj);
    const T indentation = contact_line(d, per_d, small, larger(ri, rj)).indentation;
    apart &= all_true(indentation < (1.0 - NEAREST_LINE) * small);
    store(p.per_distance + k, per_d);
    store(p.overlap + k, ri + rj - d);
    store(p.nx + k, dx * per_d);
    store(p.ny + k, dy * per_d);
    store(p.angle + k, angle_of(dx, dy));
  });
  return apart;
}

// x of both contacts of a pair. The sum is the same to the last bit on both ranks of the pair.
template <class T, class Number, class Arrays>
DEFORMABLE_LANE_FUNCTION T of_both(const Number *x, const Arrays &p, int k)
{
  return gather<T>(x, [&](int w) DEFORMABLE_LANE_LAMBDA { return p.side[0][k + w]; }) +
         gather<T>(x, [&](int w) DEFORMABLE_LANE_LAMBDA { return p.side[1][k + w]; });
}

// The imbalance of a pair, see DualSolver: r, 1/(C_i + C_j), k, and f beyond the least force.
template <class T>
DEFORMABLE_LANE_FUNCTION T imbalance_of(T residual, T weight, T stiffening, T force)
{
  const T linear = residual * weight, cubic = stiffening * residual * residual * residual;
  const T loss = larger(linear, -force), less = smaller(linear, cubic);    // f > 0, f = 0
  return select(residual > 0.0, larger(linear, cubic), select(force > 0.0, loss, less));
}

// In the units of single precision.
template <class T> DEFORMABLE_LANE_FUNCTION T imbalance_at(const PairArrays &p, int k, T force)
{
  return imbalance_of(load<T>(p.residual + k), magnitude(load<T>(p.weight + k)),
                      load<T>(p.stiffening + k), force);
}

static Residuals find_residuals(PairArrays p, int begin, int end)
{
  constexpr double INFINITE = __builtin_inf();
  const double per_length = 1.0 / p.length, per_unit = 1.0 / p.unit;
  const auto look = [&](auto kind, int k, auto &worst, auto &largest, auto &most, auto &norm2,
                        auto &weights) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T force = load<T>(p.force + k), zero = T{};
    const T f = (force - least_force<T>(p, k)) * per_unit;    // that the pair may lose
    const T r = (load<T>(p.overlap + k) - of_both<T>(p.indentation, p, k)) * per_length;
    const T w = 1.0 / of_both<T>(p.compliance, p, k), part = select(f + r * w > 0.0, w, zero);
    const T error = imbalance_of(r, w, load<T>(p.stiffening + k), f);
    store(p.residual + k, r);
    store(p.weight + k, select(part > 0.0, w, -w));
    worst = larger(worst, select((f > 0.0) | (r > 0.0), magnitude(error), zero));
    const T size = select(magnitude(r) < INFINITE, magnitude(r), zero + INFINITE);    // also nan
    most = larger(most, select((f > 0.0) | (r > 0.0) | (size == INFINITE), size, zero));
    largest = larger(largest, f);
    if (p.least) largest = larger(largest, zero - least_force<T>(p, k) * per_unit);
    norm2 += part * r * r;
    weights += part;
  };
  Lanes worst = Lanes{}, largest = Lanes{}, most = Lanes{};
  Lanes norm2[LANES / W] = {}, weights[LANES / W] = {};
  int k = begin;
  for (; k + LANES <= end; k += LANES)
#pragma GCC unroll 8
    for (int n = 0; n < LANES / W; ++n)
      look(Lanes{}, k + n * W, worst, largest, most, norm2[n], weights[n]);
  Residuals all;
  for (int w = 0; w < W; ++w) {
    all.error = larger(all.error, worst[w]);
    all.force = larger(all.force, largest[w]);
    all.left = larger(all.left, most[w]);
  }
  for (int w = 0; w < LANES; ++w) {
    all.norm2 += norm2[w / W][w % W];
    all.weights += weights[w / W][w % W];
  }
  for (; k < end; ++k) look(0.0, k, all.error, all.force, all.left, all.norm2, all.weights);
  all.error *= p.unit;
  all.force *= p.unit;
  return all;
}

static int find_unbalanced(PairArrays p, double limit, int begin, int end, int *found)
{
  int count = 0;
  const auto change_alone = [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T linear = load<T>(p.residual + k) * magnitude(load<T>(p.weight + k));
    return magnitude(larger(linear * p.unit, least_force<T>(p, k) - load<T>(p.force + k)));
  };
  int k = begin;
  for (; k + W <= end; k += W) {
    const Lanes change = change_alone(Lanes{}, k);
    if (!any(change > limit)) continue;
    for (int w = 0; w < W; ++w)
      if (change[w] > limit) found[count++] = k + w;
  }
  for (; k < end; ++k)
    if (change_alone(0.0, k) > limit) found[count++] = k;
  return count;
}

static void extrapolate(PastArrays p, Extrapolation by, const double *least, double *next,
                        int begin, int end)
{
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T last = load<T>(p.earlier[0] + k), second = load<T>(p.earlier[1] + k), zero = T{};
    const T bend = last - second, twist = bend - (second - load<T>(p.earlier[2] + k));
    const T most = larger(KINK * magnitude(bend), zero + by.smooth);
    const T curve = select(magnitude(twist) > most, zero, by.bend * bend + by.twist * twist);
    const T change = -(by.slope * last + curve), before = load<T>(p.last + k);
    const T after = select(before == UNKNOWN, zero, before + change * by.unit);
    store(next + k, larger(after, least ? load<T>(least + k) : zero + by.least));
    store(p.earlier[1] + k, last);
    store(p.earlier[2] + k, second);
  });
}

static double take_step(PairArrays p, bool alone, int begin, int end)
{
  constexpr double ALONE = 0.5;
  const double per_unit = 1.0 / p.unit;
  const double slope = sum_of(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T f = load<T>(p.force + k) * per_unit, r = load<T>(p.residual + k);
    const T none = least_force<T>(p, k) * per_unit, error = imbalance_at<T>(p, k, f - none);
    T change = ALONE * error;
    if (!alone) {
      const T correction =
          gather<T>(p.correction, [&](int w) DEFORMABLE_LANE_LAMBDA { return p.side[0][k + w]; });
      change = select(load<T>(p.weight + k) > 0.0, correction, error);
    }
    const T repulsion = select(r > 0.0, load<T>(p.stiffening + k) * r * r * r, T{});
    const T next = larger(f + change, none + repulsion), step = next - f;
    store(p.before + k, f);
    store(p.step + k, step);
    store(p.force + k, next * p.unit);
    return r * step;
  });
  return slope * p.length * p.unit;
}

template <class T>
DEFORMABLE_LANE_FUNCTION void remember_at(const PastArrays &p, int k, T x, double per_unit)
{
  const T last = load<T>(p.last + k);
  store(p.last + k, x);
  store(p.earlier[0] + k, select(last == UNKNOWN, T{}, (last - x) * per_unit));
}

static void remember(PairArrays p, int begin, int end)
{
  const double per_unit = 1.0 / p.unit;
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T zero = T{}, force = load<T>(p.force + k);
    const T virtual_force = smaller(imbalance_at<T>(p, k, zero), zero) * p.unit;
    remember_at(p.past, k, select(force > least_force<T>(p, k), force, virtual_force), per_unit);
  });
}

static void remember_values(PastArrays p, const double *x, int begin, int end)
{
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    remember_at(p, k, load<decltype(kind)>(x + k), 1.0);
  });
}

template <class T> DEFORMABLE_LANE_FUNCTION T within(T x, double most)
{
  return smaller(larger(x, T{} - most), T{} + most);
}

// The largest number that look(kind, k, worst) finds; kind is Lanes or double.
template <class Look> DEFORMABLE_LANE_FUNCTION double largest_of(int begin, int end, Look &&look)
{
  Lanes worst = Lanes{};
  double largest = 0.0;
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    if constexpr (sizeof(kind) == sizeof(Lanes))
      look(kind, k, worst);
    else
      look(kind, k, largest);
  });
  for (int w = 0; w < W; ++w) largest = larger(largest, worst[w]);
  return largest;
}

// x of the rings of a pair.
template <class T, class Arrays>
DEFORMABLE_LANE_FUNCTION Both<T> of_rings(const double *x, const Arrays &a, int k)
{
  return {gather<T>(x, [&](int w) DEFORMABLE_LANE_LAMBDA { return a.ring[0][k + w]; }),
          gather<T>(x, [&](int w) DEFORMABLE_LANE_LAMBDA { return a.ring[1][k + w]; })};
}

// 1/x of numbers without units, to single precision.
DEFORMABLE_LANE_FUNCTION double about_inverse(double x)
{
  return 1.0F / static_cast<float>(x);
}
DEFORMABLE_LANE_FUNCTION Lanes about_inverse(Lanes x)
{
  return __builtin_convertvector(1.0F / __builtin_convertvector(x, Singles), Lanes);
}

// What a line does to its outlines: f dtau, and the area that flows.
template <class T>
DEFORMABLE_LANE_FUNCTION void store_answer(const PairArrays &p, const LineArrays &a, int k,
                                           T change_of_sine, T flow)
{
  const T sine = load<T>(a.sine + k), pull = load<T>(p.force + k) * change_of_sine;
  store_both(a.answer + k, pull * (1.0 + 0.5 * sine * sine) * (1.0 / p.unit), flow);
}

// The force and the radii of curvature that a line bends by: f and Q or, of a film (contact_curve.h), g = f + h and
// Q cos(theta), whose tension is T_i cos(theta_i) + T_j cos(theta_j). The bend has sin(beta) sum of Q = g (1/p_j - 1/p_i)/2, with
// f + h cos(beta) in place of g.
template <class T> struct Bending {
  T force, Qi, Qj;
  T pull;    // h = 2 T sin(theta)
};

template <class T>
DEFORMABLE_LANE_FUNCTION Bending<T> bending(const PairArrays &p, const LineArrays &a, int k)
{
  const Both<T> Q = of_rings<T>(a.outline.free_radius, a, k);
  Bending<T> by = {load<T>(p.force + k), Q.first, Q.second, T{}};
  if (a.film_angle[0]) {
    const T ti = load<T>(a.film_angle[0] + k), tj = load<T>(a.film_angle[1] + k);
    const T u = load<T>(a.bend + k), u2 = u * u;
    by.Qi *= (1.0 - ti * ti) / (1.0 + ti * ti);
    by.Qj *= (1.0 - tj * tj) / (1.0 + tj * tj);
    by.pull = T{} - load<T>(p.least + k);
    by.force += by.pull * (1.0 - u2) / (1.0 + u2);
  }
  return by;
}

// What is left of the balance of a line, as a force. Of its torque d sin(tilt) - t_i - t_j, over d, nothing if the line is
// at an end of the range and would tilt further. Of its curvature, what the bend at rest for these forces does to overlaps: of all
// pairs of both rings, as the area (v/s) (change of sin beta) between the outlines changes their pressures, and of the own
// pair, (f - h) (1/p_j - 1/p_i) du/2, with half the chord s. As pressures follow what flows, a bend only gets as far as the part
// phi,
//   1/phi - 1 = v (bulk_i + bulk_j)/(T_i + T_j),   v = (2/3) s^3 - h s^2/p.
// The part of the stiffness against tilts that the outlines leave is not below STABLE.
static double find_lines(PairArrays p, LineArrays a, int begin, int end)
{
  constexpr double STABLE = 0.3, NOTHING = 1e-280;
  const double length = a.outline.length, per_length = 1.0 / length;
  const auto look = [&](auto kind, int k, auto &worst) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T zero = T{};
    const Both<T> pressure = of_rings<T>(a.pressure, a, k);
    const Bending<T> by = bending<T>(p, a, k);
    const T pi = pressure.first, pj = pressure.second, radii = by.Qi + by.Qj;
    const T tension = pi * by.Qi + pj * by.Qj, product = pi * pj;
    const T all = product * radii * tension;
    const T inverse = select(all > NOTHING, 1.0 / larger(all, zero + NOTHING), zero);
    const T per_tension = inverse * product * radii, per_radii = inverse * product * tension;
    const T per_product = inverse * radii * tension, wider = (pi - pj) * per_product,
            width = (pi + pj) * per_product;    // 1/p_j - 1/p_i, 1/p_i + 1/p_j

    const T sine = load<T>(a.sine + k), per_d = load<T>(a.per_distance + k);
    const T off = of_both<T>(a.slope, p, k) * per_d - sine;
    const T stiffness = 1.0 - of_both<T>(a.outline.rate, p, k) * (length * per_d);
    const T give = a.part * about_inverse(larger(stiffness, zero + STABLE));
    const T next = within(sine + give * off, LARGEST_SINE);
    store(a.next_sine + k, next);
    store(a.give + k, give * per_d * length);

    const T at_rest = within(0.5 * by.force * wider * per_radii, 0.5);
    const T u = load<T>(a.bend + k), square = u * u;
    const T change = (at_rest * (1.0 + square) - 2.0 * u) * (1.0 - square);
    const T chord = 0.25 * by.force * width + 0.5 * (by.Qi - by.Qj) * at_rest;
    const T s = larger(chord * per_length, zero),
            area = s * ((2.0 / 3.0) * s - 0.5 * by.pull * width * per_length);
    const Both<T> packed = of_rings<T>(a.outline.bulk_and_swell, a, k);
    const Both<T> of_i = both_of(packed.first), of_j = both_of(packed.second);
    const T bulk = area * s * per_tension * p.unit * (of_i.first + of_j.first);
    const T phi = about_inverse(larger(1.0 + bulk, zero + 0.5));
    const T own = 0.25 * (by.force - 2.0 * by.pull) * wider * per_length * change;
    store(a.first_flow + k, area * phi * change);
    store(a.flow_per_press + k, area * s * phi * per_tension * p.unit);
    store(a.curvature + k, (pi - pj) * per_tension * length);
    store(a.feedback + k, 1.0 - phi);
    store(a.left + k, load<T>(p.residual + k) - phi * own);
    store_answer<T>(p, a, k, next - sine, area * phi * change);

    const T of_bend = magnitude(area * change) * (of_i.second + of_j.second) + magnitude(own);
    const T of_tilt = magnitude(load<T>(p.force + k) * select(next == sine, zero, off));
    worst = larger(worst, larger(of_tilt, of_bend * magnitude(load<T>(p.weight + k)) * p.unit));
  };
  const int wall = larger(begin, smaller(end, a.wall));
  for (int k = wall; k < end; ++k) a.left[k] = p.residual[k];
  return largest_of(begin, wall, look);
}

// The next tilt for outlines that have followed.
template <class T>
DEFORMABLE_LANE_FUNCTION T next_tilt(const PairArrays &p, const LineArrays &a, int k)
{
  const T across = of_both<T>(a.outline.across, p, k);
  return within(load<T>(a.next_sine + k) + load<T>(a.give + k) * across, LARGEST_SINE);
}

static void answer(PairArrays p, LineArrays a, int begin, int end)
{
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T turn = next_tilt<T>(p, a, k) - load<T>(a.sine + k);
    const Both<T> change = of_rings<T>(a.outline.change, a, k);
    const Both<T> of_i = both_of(change.first), of_j = both_of(change.second);
    const T press =
        of_i.first - of_j.first - load<T>(a.curvature + k) * (of_i.second + of_j.second);
    const T kept = load<T>(a.feedback + k) * both_of(load<T>(a.answer + k)).second;
    store_answer<T>(p, a, k, turn,
                    load<T>(a.first_flow + k) + load<T>(a.flow_per_press + k) * press + kept);
  });
}

// sin beta = f (1/p_j - 1/p_i)/(2 (Q_i + Q_j)) with the pressures and tensions that have followed; u by a step of Newton's method.
static void settle(PairArrays p, LineArrays a, int begin, int end)
{
  constexpr double NOTHING = 1e-280;
  const double pressure_unit = p.unit / a.outline.length;
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    store(a.next_sine + k, next_tilt<T>(p, a, k));
    const Both<T> pressure = of_rings<T>(a.pressure, a, k),
                  change = of_rings<T>(a.outline.change, a, k);
    const Bending<T> by = bending<T>(p, a, k);
    const Both<T> of_i = both_of(change.first), of_j = both_of(change.second);
    const T pi = larger(pressure.first + pressure_unit * of_i.first, 0.5 * pressure.first);
    const T pj = larger(pressure.second + pressure_unit * of_j.first, 0.5 * pressure.second);
    const T Ti = pressure.first * by.Qi + p.unit * of_i.second;
    const T Tj = pressure.second * by.Qj + p.unit * of_j.second;
    const T sine =
        within(0.5 * by.force * (pi - pj) / larger(Ti * pj + Tj * pi, T{} + NOTHING), 0.5);
    const T u = load<T>(a.bend + k);
    const T bend = (sine * (1.0 + u * u) - 2.0 * u) * about_inverse(2.0 - 2.0 * sine * u);
    store(a.bend + k, within(u + a.part * bend, LARGEST_BEND));
  });
}

// By the angle between old and new tilt, whose sine is small but for the first lines of a solution.
static void turn_lines(LineArrays a, int begin, int end)
{
  constexpr double SMALL = 0.05;    // where the series has all digits
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T nx = load<T>(a.nx + k), ny = load<T>(a.ny + k);
    const T s = load<T>(a.sine + k), c = root(1.0 - s * s);
    const T sine = load<T>(a.next_sine + k), cosine = root(1.0 - sine * sine);
    const T z = sine * c - cosine * s, along = cosine * c + sine * s, z2 = z * z;
    const T x = along * nx - z * ny, y = along * ny + z * nx;
    T angle = load<T>(a.angle + k) +
              (z + z * z2 *
                       (1.0 / 6.0 +
                        z2 * (3.0 / 40.0 + z2 * (15.0 / 336.0 +
                                                 z2 * (105.0 / 3456.0 + z2 * (945.0 / 42240.0))))));
    angle = select(angle > PI, angle - 2.0 * PI, select(angle < -PI, angle + 2.0 * PI, angle));
    if (any(magnitude(z) > SMALL)) angle = select(magnitude(z) > SMALL, angle_of(x, y), angle);
    store(a.sine + k, sine);
    store(a.nx + k, x);
    store(a.ny + k, y);
    store(a.angle + k, angle);
    store(a.overlap + k, load<T>(a.overlap + k) + (c - cosine) / load<T>(a.per_distance + k));
  });
}

static double dot(const float *x, const float *y, int begin, int end)
{
  return sum_of(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    return load<T>(x + k) * load<T>(y + k);
  });
}

// Pairs whose films stick (contact_curve.h). With Tf = T_i + T_j - w:  tan^2(theta_i/2) = w (2 T_j - w)/[(2 T_i - w)(2 Tf + w)],
//   (2 Tf T sin theta)^2 = w (2 T_i - w)(2 T_j - w)(2 Tf + w);  of a wall  w/(2 T - w)  and  w (2 T - w).
// The imbalance: what the changes of angles do to the overlap, over the compliances G(0)/p of both rings.
static double find_films(FilmArrays p, int begin, int end)
{
  constexpr double NOTHING = 1e-280;
  const auto look = [&](auto kind, int k, auto &worst) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T zero = T{}, stated = load<T>(p.adhesion + k);
    const Both<T> pressure = of_rings<T>(p.pressure, p, k), q = of_rings<T>(p.free_radius, p, k);
    const T pi = pressure.first, pj = pressure.second, qi = q.first, qj = q.second;
    const T per_pi = select(pi > 0.0, 1.0 / larger(pi, zero + NOTHING), zero),
            per_pj = select(pj > 0.0, 1.0 / larger(pj, zero + NOTHING), zero);
    const T Ti = qi * pi, Tj = qj * pj;
    const T w = smaller(stated, LARGEST_ADHESION * smaller(Ti, Tj));
    const T two_i = 2.0 * Ti - w, two_j = 2.0 * Tj - w, film = Ti + Tj - w, all = 2.0 * film + w;
    const T ti = select(w > 0.0, root(w * two_j / (two_i * all)), zero),
            tj = select(w > 0.0, root(w * two_i / (two_j * all)), zero);
    const T pull2 = w * (two_i * two_j) * all;
    store(p.next_angle[0] + k, ti);
    store(p.next_angle[1] + k, tj);
    store(p.next_pull + k, select(w > 0.0, 0.5 * root(pull2) / film, zero));
    if (!any(w > 0.0)) return;

    const T per_i = 1.0 / (1.0 + ti * ti), per_j = 1.0 / (1.0 + tj * tj);
    const T of_i = magnitude(ti - load<T>(p.angle[0] + k)) * qi * ti * per_i * per_i,
            of_j = magnitude(tj - load<T>(p.angle[1] + k)) * qj * tj * per_j * per_j;
    const T off = select(w > 0.0, 4.0 * (of_i + of_j), zero);
    worst = larger(worst, off / (GREEN_AT_ZERO * larger(per_pi + per_pj, zero + NOTHING)));
  };
  const int middle = p.wall < end ? larger(p.wall, begin) : end;
  double worst = largest_of(begin, middle, look);
  for (int k = middle; k < end; ++k) {
    const double pressure = p.pressure[p.ring[0][k]], q = p.free_radius[p.ring[0][k]];
    const double per_p = pressure > 0.0 ? 1.0 / pressure : 0.0, tension = q * pressure;
    const double w = smaller(p.adhesion[k], LARGEST_ADHESION * tension);
    const double t = w > 0.0 ? root(w / (2.0 * tension - w)) : 0.0, per = 1.0 / (1.0 + t * t);
    const double change = magnitude(t - p.angle[0][k]);
    p.next_angle[0][k] = t;
    p.next_angle[1][k] = 0.0;
    p.next_pull[k] = w > 0.0 ? root(w * (2.0 * tension - w)) : 0.0;
    worst =
        larger(worst, 4.0 * change * q * t * per * per / (GREEN_AT_ZERO * larger(per_p, NOTHING)));
  }
  return worst;
}

static void take_films(FilmArrays p, int begin, int end)
{
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const auto take = [&](int side, const int *contact, T bend) DEFORMABLE_LANE_LAMBDA {
      const T t = load<T>(p.next_angle[side] + k);
      store(p.angle[side] + k, t);
      const FilmTerms<T> terms = film_terms(
          t, bend, [](T cosine, T sine) DEFORMABLE_LANE_LAMBDA { return angle_of(cosine, sine); });
      const T of[] = {terms.perimeter, terms.linear, terms.square, terms.depth};
      for (int n = 0; n < 4; ++n)
        for (int lane = 0; lane < static_cast<int>(sizeof(T) / sizeof(double)); ++lane) {
          double x[sizeof(T) / sizeof(double)];
          store(x, of[n]);
          p.terms[n][contact[k + lane]] = x[lane];
        }
    };
    const T bend = load<T>(p.bend + k);
    take(0, p.side[0], bend);
    take(1, p.side[1], -bend);
  });
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
