#include "solver/ring_films.h"

#include "laws/contact_curve.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace deformable {

void RingFilms::arrange(ContactBatches &b, NearPairs &p, RemoteSides &r)
{
  Films::arrange(b, p, r);
  for (std::vector<double> *const v : {&next_angle[0], &next_angle[1], &next_pull})
    v->resize(p.size);
  last_gap.resize(b.particle.size());
}

FilmArrays RingFilms::arrays()
{
  NearPairs &p = *pairs;
  FilmArrays a;
  a.bend = p.bend.data();
  a.adhesion = p.adhesion.data();
  for (int end = 0; end < 2; ++end) a.side[end] = p.side[end].data();
  for (int n = 0; n < 2; ++n) a.ring[n] = p.ring[n].data();
  a.pressure = batches->pressure.data();
  a.free_radius = batches->free_radius_of.data();
  for (int n = 0; n < 2; ++n) {
    a.angle[n] = p.film_angle[n].data();
    a.next_angle[n] = next_angle[n].data();
  }
  a.next_pull = next_pull.data();
  for (int n = 0; n < 4; ++n) a.terms[n] = batches->film[n].data();
  a.wall = p.wall;
  return a;
}

// Angles need T = q p only: the tension stands for q, and 1 for p.
void RingFilms::begin()
{
  NearPairs &p = *pairs;
  std::fill(last_gap.begin(), last_gap.end(), 0.0);
  std::vector<double> one(batches->pressure.size(), 1.0), tension(one.size());
  for (int k = 0; k < p.size; ++k) p.adhesion[k] = p.attached[k] ? p.adhesion_if_attached[k] : 0.0;
  for (std::size_t ring = 0; ring < batches->particle.size(); ++ring) {
    if (batches->particle[ring] < 0) continue;
    tension[ring] = batches->film_tension[ring] = batches->tension_of(static_cast<int>(ring));
  }
  remote->exchange_rings(tension.data());
  FilmArrays a = arrays();
  a.pressure = one.data();
  a.free_radius = tension.data();
  kernels.find_films(a, 0, p.size);
}

double RingFilms::find(int begin, int end)
{
  return kernels.find_films(arrays(), begin, end);
}

void RingFilms::take(int begin, int end)
{
  NearPairs &p = *pairs;
  kernels.take_films(arrays(), begin, end);
  // a force that was at its lower bound is set to the new bound
  for (int k = begin; k < end; ++k) {
    const bool bears = p.force[k] > p.least[k];
    p.least[k] = -2.0 * next_pull[k];
    p.force[k] = bears ? std::max(p.force[k], p.least[k]) : p.least[k];
  }
}

double RingFilms::lag(const RingBatches &rings) const
{
  double worst = 0.0;
  for_tensions(rings, [&](int ring) { worst = std::max(worst, std::fabs(gap(ring))); });
  return worst;
}

// Forces respond to tensions, and tensions to forces: full steps of both may oscillate. So steps are full only where the gap has the
// sign that it had before.
void RingFilms::follow(const RingBatches &rings)
{
  constexpr double PART = 0.5;
  for_tensions(rings, [&](int ring) {
    const double now = gap(ring), part = now * last_gap[ring] > 0.0 ? 1.0 : PART;
    batches->film_tension[ring] += part * now;
    last_gap[ring] = now;
  });
}

int RingFilms::ring_of(int k, int side) const
{
  return batches->place[side == 0 ? pairs->i[k] : pairs->second(k)];
}

double RingFilms::length(int k, int side) const
{
  const NearPairs &p = *pairs;
  const int ring = ring_of(k, side);
  const double u = side == 0 ? p.bend[k] : -p.bend[k];
  const double L = p.force[k] * batches->per_pressure[ring];
  const double s = half_chord(L, batches->free_radius(ring), p.film_angle[side][k], u);
  return 2.0 * s * (1.0 + arc_terms(u).excess);
}

double RingFilms::energy(int k, int side) const
{
  const double w = pairs->adhesion[k];
  if (w == 0.0) return 0.0;
  return (k < pairs->wall ? -0.5 : -1.0) * w * length(k, side);
}

double RingFilms::energy() const
{
  double sum = 0.0;
  for (int k = 0; k < pairs->size; ++k) {
    sum += energy(k, 0);
    if (k < pairs->remote) sum += energy(k, 1);
  }
  return sum;
}

double RingFilms::free_arc(int i) const
{
  const NearPairs &p = *pairs;
  std::vector<std::array<double, 2>> ends;    // direction of each contact, and alpha
  for (int m = 0; m < batches->count[i]; ++m) {
    const int pair_side = batches->pair_side[batches->contact(batches->place[i], m)];
    const int k = pair_side >> 1, side = pair_side & 1;
    if (!p.attached[k] && !(p.force[k] > 0.0)) continue;
    const double u = side == 0 ? p.bend[k] : -p.bend[k];
    ends.push_back(
        {p.angle[k] + side * PI, 2.0 * (std::atan(p.film_angle[side][k]) + std::atan(u))});
    if (ends.back()[0] > PI) ends.back()[0] -= 2.0 * PI;
  }
  if (ends.empty()) return 2.0 * PI;
  std::sort(ends.begin(), ends.end());
  double least = 2.0 * PI;
  for (std::size_t m = 0; m < ends.size(); ++m) {
    const std::size_t next = m + 1 < ends.size() ? m + 1 : 0;
    const double turn = ends[next][0] - ends[m][0] + (next == 0 ? 2.0 * PI : 0.0);
    least = std::min(least, turn - ends[m][1] - ends[next][1]);
  }
  return least;
}

}    // namespace deformable
