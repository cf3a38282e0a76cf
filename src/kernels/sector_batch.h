// The sector law for particles of equal numbers of contacts, side by side: sectors that keep their perimeter.
// Formulas are those of sector.h.

#ifndef DEFORMABLE_SECTOR_BATCH_H
#define DEFORMABLE_SECTOR_BATCH_H

#include "kernels/lane_geometry.h"
#include "laws/sector.h"

namespace deformable::DEFORMABLE_LEVEL {

// Pairs to exchange if they are out of order, so that N numbers become sorted.
// K. E. Batcher, AFIPS Conf. Proc. 32, 307 (1968).
template <int N> struct SortingNetwork {
  int size = 0;
  int low[N * N] = {}, high[N * N] = {};
  constexpr SortingNetwork()
  {
    for (int p = 1; p < N; p *= 2)
      for (int k = p; k >= 1; k /= 2)
        for (int j = k % p; j + k < N; j += 2 * k)
          for (int i = j; i < j + k && i + k < N; ++i)
            if (i / (2 * p) == (i + k) / (2 * p)) {
              low[size] = i;
              high[size++] = i + k;
            }
  }
};

struct SectorContact {
  Lanes angle, dx, dy, radius;
  Mask place;
};

DEFORMABLE_LANE_FUNCTION void sort_two(SectorContact &a, SectorContact &b)
{
  const SectorContact x = a, y = b;
  const Mask swap = y.angle < x.angle;
  a = {select(swap, y.angle, x.angle), select(swap, y.dx, x.dx), select(swap, y.dy, x.dy),
       select(swap, y.radius, x.radius), swap ? y.place : x.place};
  b = {select(swap, x.angle, y.angle), select(swap, x.dx, y.dx), select(swap, x.dy, y.dy),
       select(swap, x.radius, y.radius), swap ? x.place : y.place};
}

// sector_coefficients of sector.h; `odd` becomes true where the angle is close to a full turn.
DEFORMABLE_LANE_FUNCTION SectorCoefficients<Lanes>
coefficients_of(Lanes phi, Lanes complement, Lanes sine, Lanes cosine, Mask &odd)
{
  odd |= complement < 1.0;
  const Lanes versine = 1.0 - cosine, per_d = 1.0 / (2.0 * versine - phi * sine);
  SectorCoefficients<Lanes> w = {(sine - phi * cosine) * per_d, (phi - sine) * per_d,
                                 versine * per_d};
  const Mask small = phi < 0.5;
  if (!any(small)) return w;
  const Lanes x2 = phi * phi, per_phi = 1.0 / phi;
  const Lanes per_small = per_phi / taylor::TWO_VERSINES_MINUS_X_SINE(x2);
  w.alpha = select(small, taylor::SINE_MINUS_X_COSINE(x2) * per_small, w.alpha);
  w.beta = select(small, taylor::X_MINUS_SINE(x2) * per_small, w.beta);
  w.gamma = select(small, taylor::VERSINE(x2) * per_small * per_phi, w.gamma);
  return w;
}

// W particles with N contacts each, as sector_shape. `shapes`: whether lengths are asked for.
template <int N>
DEFORMABLE_LANE_FUNCTION void sector_batch(BlockParticle *const *p, Place *places, bool shapes)
{
  Place *at[W];
  for_each_lane([&](int w) DEFORMABLE_LANE_LAMBDA { at[w] = places + p[w]->first; });
  SectorContact contact[N];
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) {
    const Lanes dx = of_places(at, m, &Place::dx), dy = of_places(at, m, &Place::dy);
    contact[m] = {angle_of(dx, dy), dx, dy, of_places(at, m, &Place::radius), Mask{} + m};
  }
  constexpr SortingNetwork<N> network;
#pragma GCC unroll 32
  for (int s = 0; s < network.size; ++s)
    sort_two(contact[network.low[s]], contact[network.high[s]]);

  const Lanes radius = of_particles(p, &BlockParticle::radius);
  Mask odd = Mask{};
  LineLanes line[N];
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) {
    line[m] = contact_lines(contact[m].dx, contact[m].dy, radius, contact[m].radius);
    odd |= ~(line[m].indentation < (1.0 - NEAREST_LINE) * radius);
  }

  Lanes length[N], d_angle[N];
  Lanes length_before = Lanes{}, d_before = Lanes{}, twice_deficit = Lanes{}, shrinkage = Lanes{};
#pragma GCC unroll 8
  for (int i = 0; i < N; ++i) {
    const bool last = i + 1 == N;
    const int k = last ? 0 : i + 1;
    const Lanes difference = contact[k].angle - contact[i].angle;
    const Lanes phi = last ? 2.0 * PI + difference : difference;
    const Lanes complement = last ? -difference : 2.0 * PI - difference;
    const SectorCoefficients<Lanes> w =
        coefficients_of(phi, complement, line[i].nx * line[k].ny - line[i].ny * line[k].nx,
                        line[i].nx * line[k].nx + line[i].ny * line[k].ny, odd);
    const Lanes ai = line[i].indentation;
    const SectorPart<Lanes> part = sector(w, ai, line[k].indentation);
    const Lanes d_opening =
        0.5 * (ai * (2.0 * part.shrinkage - ai) - part.length_i * part.length_i);
    length[i] = length_before + part.length_i;
    d_angle[i] = d_before - d_opening;
    twice_deficit += ai * length[i];
    shrinkage = larger(shrinkage, part.shrinkage);
    length_before = part.length_k;
    d_before = d_opening;
  }
  length[0] += length_before;
  d_angle[0] += d_before;
  const Lanes deficit = 0.5 * (twice_deficit + line[0].indentation * length_before);
  odd |= ~(magnitude(deficit) < all(__builtin_inf()));

  const Lanes kA = of_particles(p, &Stiffness::kA), pressure = kA * deficit;
#pragma GCC unroll 8
  for (int m = 0; m < N; ++m) {
    const Lanes by_indentation = pressure * length[m];
    const ForceLanes force = force_of(line[m], by_indentation, pressure * d_angle[m]);
    for_each_lane([&](int w) DEFORMABLE_LANE_LAMBDA {
      Place &place = at[w][contact[m].place[w]];
      place.fx = force.x[w];
      place.fy = force.y[w];
    });
    if (shapes)
      for_each_lane([&](int w) DEFORMABLE_LANE_LAMBDA {
        at[w][contact[m].place[w]].length = length[m][w];
        at[w][contact[m].place[w]].force = by_indentation[w];
      });
  }
  to_particles(p, &BlockParticle::energy, 0.5 * kA * deficit * deficit);
  to_particles(p, &BlockParticle::pressure, pressure);
  to_particles(p, &BlockParticle::arc_radius, radius - shrinkage);
  to_particles(p, &BlockParticle::area_deficit, deficit);
  set_outcome(p, odd, Outcome::ODD);
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
