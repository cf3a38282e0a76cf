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
    const T square = dx * dx + dy * dy, d = root(square), per_d = 1.0 / d, sum = ri + rj;
    apart &= all_true(square > nearest_square(sum, magnitude(ri - rj)));
    store(p.per_distance + k, per_d);
    store(p.overlap + k, sum - d);
    store(p.nx + k, dx * per_d);
    store(p.ny + k, dy * per_d);
    store(p.angle + k, angle_of_lanes(dx, dy));
  });
  return apart;
}

// x of both contacts of a pair. The sum is the same to the last bit on both ranks of the pair.
template <class T, class Number, class Arrays>
DEFORMABLE_LANE_FUNCTION T of_both(const Number *x, const Arrays &p, int k)
{
  return gather<T>(x, [&](int w) DEFORMABLE_LANE_LAMBDA { return p.first[k + w]; }) +
         gather<T>(x, [&](int w) DEFORMABLE_LANE_LAMBDA { return p.second[k + w]; });
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

static void extrapolate(PairArrays p, Extrapolation by, int begin, int end)
{
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T last = load<T>(p.earlier[0] + k), second = load<T>(p.earlier[1] + k), zero = T{};
    const T bend = last - second, twist = bend - (second - load<T>(p.earlier[2] + k));
    const T most = larger(KINK * magnitude(bend), zero + by.smooth);
    const T curve = select(magnitude(twist) > most, zero, by.bend * bend + by.twist * twist);
    const T change = -(by.slope * last + curve);
    store(p.force + k, larger(load<T>(p.past + k) + change * p.unit, least_force<T>(p, k)));
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
          gather<T>(p.correction, [&](int w) DEFORMABLE_LANE_LAMBDA { return p.first[k + w]; });
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

static void remember(PairArrays p, int begin, int end)
{
  const double per_unit = 1.0 / p.unit;
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T zero = T{}, force = load<T>(p.force + k), past = load<T>(p.past + k);
    const T virtual_force = smaller(imbalance_at<T>(p, k, zero), zero) * p.unit;
    const T f = select(force > least_force<T>(p, k), force, virtual_force);
    store(p.past + k, f);
    store(p.earlier[0] + k, select(past == UNKNOWN_FORCE, zero, (past - f) * per_unit));
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

// What is left of the balance of a line, as a force. Of its torque d sin(tilt) - t_i - t_j, over d, nothing if the line is
// at an end of the range and would tilt further. Of its curvature, what the change of the half angle b would do to the
// overlap, f (1/p_i - 1/p_j) db/4, over the compliances G(0)/p of both rings. The part of the stiffness against tilts
// that the outlines leave is not below STABLE.
static double find_lines(LineArrays p, int begin, int end)
{
  constexpr double STABLE = 0.3, NOTHING = 1e-280;
  const auto look = [&](auto kind, int k, auto &worst) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T force = load<T>(p.force + k), sine = load<T>(p.sine + k), zero = T{};
    const T per_d = load<T>(p.per_distance + k), slope = of_both<T>(p.slope, p, k);
    const T rate = of_both<T>(p.outline.slope_rate, p, k);
    const T off = slope * per_d - sine, stiffness = 1.0 - rate * per_d / root(1.0 - sine * sine);
    const T next = within(sine + p.part * off / larger(stiffness, zero + STABLE), LARGEST_SINE);
    store(p.next_sine + k, next);

    const T radii = of_both<T>(p.outline.free_radius, p, k);
    const double *const per_p = p.outline.per_pressure;
    const T first = gather<T>(per_p, [&](int w) DEFORMABLE_LANE_LAMBDA { return p.first[k + w]; }),
            second =
                gather<T>(per_p, [&](int w) DEFORMABLE_LANE_LAMBDA { return p.second[k + w]; });
    const T width = first + second, wider = second - first;
    const T bent = within(0.5 * force * wider / larger(radii, zero + NOTHING), 0.5);
    const T bend = load<T>(p.bend + k);
    T change = bent / (1.0 + root(1.0 - bent * bent)) - bend;
    if (p.adhesion) change = select(load<T>(p.adhesion + k) > 0.0, zero, change);    // find_films
    store(p.next_bend + k, bend + p.part * change);
    const T part = wider / larger(width, zero + NOTHING);
    const T of_tilt = magnitude(select(next == sine, zero, off));
    worst = larger(worst, magnitude(force) *
                              larger(of_tilt, magnitude(part * change) * (0.5 / GREEN_AT_ZERO)));
  };
  return largest_of(begin, end, look);
}

static void take_lines(LineArrays p, int begin, int end)
{
  for_pairs(begin, end, [&](auto kind, int k) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T nx = load<T>(p.nx + k), ny = load<T>(p.ny + k);
    const T s = load<T>(p.sine + k), c = root(1.0 - s * s);
    const T sine = load<T>(p.next_sine + k), cosine = root(1.0 - sine * sine);
    const T ex = c * nx + s * ny, ey = c * ny - s * nx;    // from center to center
    const T x = cosine * ex - sine * ey, y = cosine * ey + sine * ex;
    store(p.sine + k, sine);
    store(p.nx + k, x);
    store(p.ny + k, y);
    store(p.angle + k, angle_of_lanes(x, y));
    store(p.overlap + k, load<T>(p.overlap + k) + (c - cosine) / load<T>(p.per_distance + k));
    store(p.bend + k, load<T>(p.next_bend + k));
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
// The bend has
//   sin(beta + psi) = f (1/p_j - 1/p_i)/(2 c),   (c cos psi, c sin psi) = (q_i cos theta_i + q_j cos theta_j,
//   q_i sin theta_i - q_j sin theta_j).
// The imbalance: what the changes of angles do to the overlap, over the compliances G(0)/p of both rings.
static double find_films(FilmArrays p, int begin, int end)
{
  constexpr double NOTHING = 1e-280;
  const auto look = [&](auto kind, int k, auto &worst) DEFORMABLE_LANE_LAMBDA {
    using T = decltype(kind);
    const T zero = T{}, stated = load<T>(p.adhesion + k);
    const auto of = [&](const double *x, const int *side) DEFORMABLE_LANE_LAMBDA {
      return gather<T>(x, [&](int lane) DEFORMABLE_LANE_LAMBDA { return side[k + lane]; });
    };
    const T qi = of(p.outline.free_radius, p.first), qj = of(p.outline.free_radius, p.second);
    const T per_pi = of(p.outline.per_pressure, p.first),
            per_pj = of(p.outline.per_pressure, p.second);
    const T Ti = qi / larger(per_pi, zero + NOTHING), Tj = qj / larger(per_pj, zero + NOTHING);
    const T w = smaller(stated, LARGEST_ADHESION * smaller(Ti, Tj));
    const T two_i = 2.0 * Ti - w, two_j = 2.0 * Tj - w, film = Ti + Tj - w, all = 2.0 * film + w;
    const T ti = select(w > 0.0, root(w * two_j / (two_i * all)), zero),
            tj = select(w > 0.0, root(w * two_i / (two_j * all)), zero);
    const T pull2 = w * (two_i * two_j) * all;
    store(p.next_angle[0] + k, ti);
    store(p.next_angle[1] + k, tj);
    store(p.next_pull + k, select(w > 0.0, 0.5 * root(pull2) / film, zero));
    if (!any_true(w > 0.0)) return;    // CurvedLines has the bend

    const T per_i = 1.0 / (1.0 + ti * ti), per_j = 1.0 / (1.0 + tj * tj);
    const T across = 2.0 * (qi * ti * per_i - qj * tj * per_j);
    const T along = qi * (1.0 - ti * ti) * per_i + qj * (1.0 - tj * tj) * per_j;
    const T c = larger(root(across * across + along * along), zero + NOTHING), per_c = 1.0 / c;
    const T sine = within(0.5 * load<T>(p.force + k) * (per_pj - per_pi) * per_c, 1.0);
    const T cosine = root(1.0 - sine * sine);
    const T sin_b = within(per_c * (sine * along - cosine * across), 0.5);
    const T bend = load<T>(p.bend + k), change = sin_b / (1.0 + root(1.0 - sin_b * sin_b)) - bend;
    store(p.next_bend + k, select(w > 0.0, bend + p.part * change, load<T>(p.next_bend + k)));
    const T of_i = magnitude(ti - load<T>(p.angle[0] + k)) * qi * ti * per_i * per_i,
            of_j = magnitude(tj - load<T>(p.angle[1] + k)) * qj * tj * per_j * per_j;
    const T arc = 0.5 * load<T>(p.force + k) * (per_pj - per_pi) + across;
    const T off = select(w > 0.0, 4.0 * (of_i + of_j) + magnitude(change * arc), zero);
    worst = larger(worst, off / (GREEN_AT_ZERO * larger(per_pi + per_pj, zero + NOTHING)));
  };
  const int middle = p.wall < end ? larger(p.wall, begin) : end;
  double worst = largest_of(begin, middle, look);
  for (int k = middle; k < end; ++k) {
    const double per_p = p.outline.per_pressure[p.first[k]];
    const double q = p.outline.free_radius[p.first[k]], tension = q / larger(per_p, NOTHING);
    const double w = smaller(p.adhesion[k], LARGEST_ADHESION * tension);
    const double t = w > 0.0 ? root(w / (2.0 * tension - w)) : 0.0, per = 1.0 / (1.0 + t * t);
    const double change = magnitude(t - p.angle[0][k]);
    p.next_angle[0][k] = t;
    p.next_angle[1][k] = p.next_bend[k] = 0.0;
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
      const FilmTerms<T> terms = film_terms(t, bend, [](T cosine, T sine) DEFORMABLE_LANE_LAMBDA {
        return angle_of_lanes(cosine, sine);
      });
      const T of[] = {terms.perimeter, terms.linear, terms.square, terms.depth};
      for (int n = 0; n < 4; ++n)
        for (int lane = 0; lane < static_cast<int>(sizeof(T) / sizeof(double)); ++lane) {
          double x[sizeof(T) / sizeof(double)];
          store(x, of[n]);
          p.terms[n][contact[k + lane]] = x[lane];
        }
    };
    const T bend = load<T>(p.bend + k);
    take(0, p.first, bend);
    take(1, p.second, -bend);
  });
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
