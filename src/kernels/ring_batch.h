// The ring law for particles of equal numbers of active contacts, side by side. Formulas are those of ring.h and
// soft_ring.h; what they do on rare branches is left to them.

#ifndef DEFORMABLE_RING_BATCH_H
#define DEFORMABLE_RING_BATCH_H

#include "kernels/lane_geometry.h"
#include "laws/green.h"

namespace deformable::DEFORMABLE_LEVEL {

template <int N> struct Factors {
  Lanes green[N][N], per_pivot[N];    // lower triangle: L D L^T = G
};

// As in ring_lcp.h: x = (D L^T)^-1 x
template <int N> DEFORMABLE_LANE_FUNCTION void back_substitute(const Factors<N> &f, Lanes *x)
{
#pragma GCC unroll 8
  for (int c = N - 1; c >= 0; --c) {
#pragma GCC unroll 8
    for (int r = c + 1; r < N; ++r) x[c] -= f.green[r][c] * x[r];
    x[c] *= f.per_pivot[c];
  }
}

// x = G^-1 x
template <int N> DEFORMABLE_LANE_FUNCTION void solve_lanes(const Factors<N> &f, Lanes *x)
{
#pragma GCC unroll 8
  for (int c = 0; c < N; ++c) {
    const Lanes scaled = x[c] * f.per_pivot[c];
#pragma GCC unroll 8
    for (int r = c + 1; r < N; ++r) x[r] -= f.green[r][c] * scaled;
  }
  back_substitute(f, x);
}

// Factors G in place and solves for x. Returns where G is singular.
template <int N> DEFORMABLE_LANE_FUNCTION Mask factor_lanes(Factors<N> &f, Lanes *x)
{
  constexpr double SMALLEST_PIVOT = 1e-13;    // as in solve_dense
  Mask singular = Mask{};
#pragma GCC unroll 8
  for (int c = 0; c < N; ++c) {
    singular |= f.green[c][c] < SMALLEST_PIVOT;
    f.per_pivot[c] = 1.0 / f.green[c][c];
#pragma GCC unroll 8
    for (int r = c + 1; r < N; ++r) {
      const Lanes scaled = f.green[r][c] * f.per_pivot[c];
      x[r] -= scaled * x[c];
#pragma GCC unroll 8
      for (int k = c + 1; k <= r; ++k) f.green[r][k] -= scaled * f.green[k][c];
    }
  }
  back_substitute(f, x);
  return singular;
}

// expansion_of of soft_ring.h. `odd` becomes true where it would leave the common path.
DEFORMABLE_LANE_FUNCTION Lanes expansions(Lanes deficit, Lanes sum, Lanes rate, Lanes radius,
                                          Lanes ratio, Mask soft, Mask &odd)
{
  const Lanes e = 1.0 - rate * (0.5 / PI), q0 = radius - sum * (0.5 / PI);
  const Lanes drive = deficit * q0, square = PI * q0 * q0 + e * deficit;
  odd |= soft & ~((q0 > 0.0) & (square > 0.0) & (drive > 0.0));
  Lanes near = Lanes{}, far = deficit / (PI * q0);
  const Lanes spring = 2.0 * PI * ratio;
  Lanes delta = smaller(far, drive / (spring + 2.0 * PI * q0 * q0));
  const Mask by_area = ratio == 0.0;
  delta = select(by_area, deficit / (PI * q0 + root(PI * square)), delta);
  Mask open = soft & ~by_area & ~odd;
  for (int iteration = 0; any(open); ++iteration) {
    if (iteration == 30) {
      odd |= open;
      break;
    }
    const Lanes q = q0 + e * delta, left = deficit - PI * delta * (q0 + q);
    const Lanes f = spring * delta - left * q;
    far = select(open & (f > 0.0), delta, far);
    near = select(open & ~(f > 0.0), delta, near);
    const Lanes next = delta - f / (spring + 2.0 * PI * q * q - e * left);
    const Mask inside = (near <= next) & (next <= far);
    const Lanes step = next - delta;
    delta = select(open, select(inside, next, 0.5 * (near + far)), delta);
    open &= ~(inside & (magnitude(step) <= 1e-8 * magnitude(delta)));
  }
  return select(soft, delta, Lanes{});
}

// expansion_under_tension of soft_ring.h.
DEFORMABLE_LANE_FUNCTION Lanes expansions_under_tension(Lanes deficit, Lanes sum, Lanes rate,
                                                        Lanes radius, Lanes ratio, Lanes rest,
                                                        Mask &odd)
{
  const Lanes e = 1.0 - rate * (0.5 / PI), shorter = sum * (0.5 / PI), q0 = radius - shorter;
  const Lanes square = PI * q0 * q0 + e * deficit, spring = 2.0 * PI * ratio;
  odd |= ~((q0 > 0.0) & (square > 0.0));
  const Lanes by_area = deficit / (PI * (q0 + root(select(odd, q0, square * (1.0 / PI)))));
  Lanes delta = by_area;
  Mask open = ~odd & ((ratio > 0.0) | (rest > 0.0));
  for (int iteration = 0; any(open); ++iteration) {
    const Lanes q = q0 + e * delta, left = deficit - PI * delta * (q0 + q);
    const Lanes f = spring * delta + rest * (shorter - e * delta) - left * q;
    const Lanes slope = spring + 2.0 * PI * q * q - e * (left + rest);
    const Mask fails = open & ~((slope > 0.0) & (q > 0.0));
    odd |= fails;
    open &= ~fails;
    if (iteration == 30) {
      odd |= open;
      break;
    }
    const Lanes step = f / slope;
    delta = select(open, delta - step, delta);
    open &= ~(magnitude(step) <= 1e-8 * (magnitude(delta) + magnitude(by_area)));
  }
  return delta;
}

// Looks at the candidates that are not active, for those particles that are settled otherwise. Sets the length of
// candidates to 1 that the outlines reach, and returns which particles have such.
template <int N>
DEFORMABLE_LANE_FUNCTION Mask reached(BlockParticle *const *p, Place *const *at, Place *places,
                                      const LineLanes *line, const Lanes *angle,
                                      const Lanes *length, Lanes radius, Lanes expansion,
                                      Mask settled, Mask &odd)
{
  int most = 0, count[W];
  for (int w = 0; w < W; ++w) {
    count[w] = p[w]->last - p[w]->others;
    most = count[w] > most ? count[w] : most;
  }
  Mask which = Mask{};
  for (int o = 0; o < most; ++o) {
    Place *other[W];
    Mask exists = settled;
    for_each_lane([&](int w) DEFORMABLE_LANE_LAMBDA {
      if (o >= count[w]) exists[w] = 0;
      other[w] = o < count[w] ? places + p[w]->others + o : at[w];
    });
    const Lanes dx = of_places(other, 0, &Place::dx), dy = of_places(other, 0, &Place::dy);
    const LineLanes at_other = contact_lines(dx, dy, radius, of_places(other, 0, &Place::radius));
    odd |= exists & ~(at_other.indentation < (1.0 - NEAREST_LINE) * radius);
    Lanes gap = at_other.indentation;
#pragma GCC unroll 8
    for (int m = 0; m < N; ++m)
      gap -= length[m] * green_bound(line[m].nx * at_other.nx + line[m].ny * at_other.ny);
    if (!any(exists & (gap > -expansion))) continue;

    const Lanes theta = angle_of_lanes(dx, dy);
    gap = at_other.indentation;
#pragma GCC unroll 8
    for (int m = 0; m < N; ++m) {
      const AngleLanes t = angles_between(angle[m], line[m], theta, at_other);
      gap -= length[m] * green(t.magnitude, t.sine, t.cosine);
    }
    const Mask reaches = exists & (gap > -expansion);
    if (!any(reaches)) continue;
    which |= reaches;
    for (int w = 0; w < W; ++w)
      if (reaches[w]) other[w]->length = 1.0;
  }
  return which;
}

// What all particles of a batch have in common; SOFT: some of them do not conserve their perimeter.
enum class Perimeter { CONSERVED, SOFT, TENSE };

// W particles with N active contacts each. `shapes`: whether lengths and perimeters are asked for.
template <int N, Perimeter KIND>
DEFORMABLE_LANE_FUNCTION void ring_batch(BlockParticle *const *p, Place *places, bool shapes)
{
  constexpr bool CHANGES = KIND != Perimeter::CONSERVED, TENSE = KIND == Perimeter::TENSE;
  Place *at[W];
  for_each_lane([&](int w) DEFORMABLE_LANE_LAMBDA { at[w] = places + p[w]->first; });
  const Lanes radius = of_particles(p, &BlockParticle::radius);

  LineLanes line[N];
  Lanes angle[N], length[N], slopes[N][N];
  Factors<N> factors;
  Mask odd = Mask{};
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) {
    const Lanes dx = of_places(at, m, &Place::dx), dy = of_places(at, m, &Place::dy);
    line[m] = contact_lines(dx, dy, radius, of_places(at, m, &Place::radius));
    angle[m] = angle_of_lanes(dx, dy);
    length[m] = line[m].indentation;
    odd |= ~(line[m].indentation < (1.0 - NEAREST_LINE) * radius);
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      const AngleLanes t = angles_between(angle[k], line[k], angle[m], line[m]);
      const Lanes slope = d_green(t.magnitude, t.sine, t.cosine);
      factors.green[m][k] = green(t.magnitude, t.sine, t.cosine);
      slopes[m][k] = select(t.negative, -slope, slope);
    }
    factors.green[m][m] = all(GREEN_AT_ZERO);
  }
  odd |= factor_lanes(factors, length);

  const Lanes ring_radius = of_particles(p, &BlockParticle::ring_radius);
  const Lanes kA = of_particles(p, &Stiffness::kA);
  Lanes kP, rest, expansion = Lanes{};
  Mask soft = Mask{};
  if constexpr (CHANGES) {
    kP = of_particles(p, &Stiffness::kP);
    const Lanes ratio = kP / kA;
    soft = ratio < all(__builtin_inf());
    if constexpr (TENSE) rest = of_particles(p, &Stiffness::tension) / ring_radius;
    Lanes rate[N], deficit = Lanes{}, sum = Lanes{}, sum_rate = Lanes{};
#pragma GCC unroll 8
    for (int m = 0; m < N; ++m) rate[m] = all(1.0);
    solve_lanes(factors, rate);
#pragma GCC unroll 8
    for (int m = 0; m < N; ++m) {
      deficit += 0.5 * line[m].indentation * length[m];
      sum += length[m];
      sum_rate += rate[m];
    }
    if constexpr (TENSE)
      expansion =
          expansions_under_tension(deficit, sum, sum_rate, ring_radius, ratio, rest / kA, odd);
    else
      expansion = expansions(deficit, sum, sum_rate, ring_radius, ratio, soft, odd);
#pragma GCC unroll 8
    for (int m = 0; m < N; ++m) {
      line[m].indentation += expansion;
      length[m] += expansion * rate[m];
    }
  }

  Mask retry = Mask{};
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) retry |= ~(length[m] >= 0.0);
  const Mask settled = ~(odd | retry);
  retry |= reached<N>(p, at, places, line, angle, length, radius, expansion, settled, odd);

  Lanes sum = Lanes{}, twice_deficit = Lanes{}, mx = Lanes{}, my = Lanes{}, d_angle[N];
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) {
    d_angle[m] = Lanes{};
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      const Lanes pair = length[m] * length[k] * slopes[m][k];
      d_angle[m] -= pair;
      d_angle[k] += pair;
    }
    sum += length[m];
    twice_deficit += line[m].indentation * length[m];
    mx += length[m] * line[m].nx;
    my += length[m] * line[m].ny;
  }
  const Lanes mean = ring_radius + expansion - sum * (0.5 / PI);
  Lanes deficit = 0.5 * twice_deficit, excess = Lanes{};
  Lanes pressure = kA * deficit, energy = 0.5 * kA * deficit * deficit;
  if constexpr (TENSE) {    // as in tense_ring
    excess = 2.0 * PI * expansion;
    const Lanes less = deficit - PI * expansion * (2.0 * ring_radius + expansion);
    const Mask by_tension = (kA == all(__builtin_inf())) |
                            (less * (ring_radius + expansion) <= magnitude(mean) * deficit);
    const Lanes stretched = kP * excess;
    const Lanes laplace = (stretched + rest * (sum * (0.5 / PI) - expansion)) / mean;
    const Lanes above = select(by_tension, laplace, kA * less), change = above / kA;
    energy =
        rest * (deficit - PI * expansion * expansion) + 0.5 * (above * change + stretched * excess);
    pressure = rest + above;
    deficit = change;
  } else if constexpr (CHANGES) {    // as in soft_ring_shape
    excess = 2.0 * PI * expansion;
    const Lanes less = deficit - PI * expansion * (2.0 * ring_radius + expansion);
    const Mask by_tension = less * (ring_radius + expansion) <= magnitude(mean) * deficit;
    pressure = select(soft, select(by_tension, kP * excess / mean, kA * less), pressure);
    deficit = select(soft, pressure / kA, deficit);
    energy = select(soft, 0.5 * (pressure * deficit + kP * excess * excess), energy);
  }
  odd |= ~(magnitude(pressure) < all(__builtin_inf()));
  if constexpr (CHANGES) odd |= pressure > of_particles(p, &Stiffness::yield);
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) {
    const Lanes by_indentation = pressure * length[m];
    const ForceLanes force = force_of(line[m], by_indentation, pressure * d_angle[m]);
    to_places(at, m, &Place::fx, force.x);
    to_places(at, m, &Place::fy, force.y);
    if (shapes) to_places(at, m, &Place::force, by_indentation);
  }

  to_particles(p, &BlockParticle::energy, energy);
  to_particles(p, &BlockParticle::pressure, pressure);
  to_particles(p, &BlockParticle::arc_radius, mean - root(mx * mx + my * my) * (1.0 / PI));
  to_particles(p, &BlockParticle::area_deficit, deficit);
  if (shapes) to_particles(p, &BlockParticle::perimeter_excess, excess);
  if (shapes || any(retry)) {
#pragma GCC unroll 8
    for (int m = 0; m < N; ++m) to_places(at, m, &Place::length, length[m]);
  }
  set_outcome(p, retry, Outcome::RETRY);
  set_outcome(p, odd, Outcome::ODD);
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
