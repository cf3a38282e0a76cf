// The ring law for particles of equal numbers of active contacts, side by side. Formulas are those of ring.h and
// soft_ring.h; what they do on rare branches is left to them.

#ifndef DEFORMABLE_RING_BATCH_H
#define DEFORMABLE_RING_BATCH_H

#include "kernels/lane_geometry.h"
#include "laws/green.h"
#include "laws/soft_ring.h"

namespace deformable::DEFORMABLE_LEVEL {

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

    const Lanes theta = angle_of(dx, dy);
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
  Lanes factors[N][N], per_pivot[N];    // lower triangle: L D L^T = G
  Mask odd = Mask{};
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) {
    const Lanes dx = of_places(at, m, &Place::dx), dy = of_places(at, m, &Place::dy);
    line[m] = contact_lines(dx, dy, radius, of_places(at, m, &Place::radius));
    angle[m] = angle_of(dx, dy);
    length[m] = line[m].indentation;
    odd |= ~(line[m].indentation < (1.0 - NEAREST_LINE) * radius);
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      const AngleLanes t = angles_between(angle[k], line[k], angle[m], line[m]);
      const Lanes slope = d_green(t.magnitude, t.sine, t.cosine);
      factors[m][k] = green(t.magnitude, t.sine, t.cosine);
      slopes[m][k] = select(t.negative, -slope, slope);
    }
    factors[m][m] = all(GREEN_AT_ZERO);
  }
  solve_dense(N, factors, length, per_pivot, [&](int, Mask vanishes) DEFORMABLE_LANE_LAMBDA {
    odd |= vanishes;
    return false;
  });

  const Lanes ring_radius = of_particles(p, &BlockParticle::ring_radius);
  const Lanes kA = of_particles(p, &Stiffness::kA);
  Lanes kP, rest, expansion = Lanes{};
  Mask soft = Mask{};
  if constexpr (CHANGES) {
    kP = of_particles(p, &Stiffness::kP);
    const Lanes ratio = kP / kA;
    soft = ratio < all(__builtin_inf());
    if constexpr (TENSE) rest = of_particles(p, &Stiffness::tension) / ring_radius;
    Lanes rate[N];
    BranchOf<Lanes> branch = {};
#pragma GCC unroll 8
    for (int m = 0; m < N; ++m) rate[m] = all(1.0);
    solve_factored(N, factors, per_pivot, rate);
#pragma GCC unroll 8
    for (int m = 0; m < N; ++m) {
      branch.deficit += 0.5 * line[m].indentation * length[m];
      branch.sum += length[m];
      branch.rate += rate[m];
    }
    if constexpr (TENSE)
      expansion = expansion_under_tension(branch, ring_radius, ratio, rest / kA, odd);
    else
      expansion = select(soft, expansion_of(branch, ring_radius, ratio, soft, odd), Lanes{});
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
