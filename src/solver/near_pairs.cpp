#include "solver/near_pairs.h"

#include "laws/contact.h"

#include <cmath>

using namespace LAMMPS_NS;

// A vector that grows by itself may take twice the memory that it needs.
void NearPairs::clear(const KnownPairs &old)
{
  const std::size_t most = old.size + old.size / 64 + 16;
  static_cast<KnownPairs &>(*this) = KnownPairs();
  curved = old.curved;
  sticks = old.sticks;
  scale = old.scale;
  length = old.length;
  const auto make_room = [most](auto &...v) { (v.reserve(most), ...); };
  make_room(i, j, past, earlier[0], earlier[1], earlier[2]);
  if (curved)
    for (int n = 0; n < PastForces::LINES; ++n) make_room(past_tilt[n], past_bend[n]);
}

void NearPairs::set_units(double scale_, double length_)
{
  const double before = unit();
  scale = scale_;
  length = length_;
  if (unit() == before) return;
  const double ratio = before / unit();
  for (LargeVector<float> &v : earlier)
    for (float &change : v) change = static_cast<float>(change * ratio);
}

void NearPairs::make_room()
{
  const std::size_t pairs = size, one_more = pairs + 1;
  stiffening.assign(pairs, 0.0F);
  for (LargeVector<double> *v : {&force, &overlap, &per_distance, &angle, &ny})
    v->assign(one_more, 0.0);
  nx.assign(one_more, 1.0);
  for (LargeVector<double> *v : {&tilt, &bend}) v->assign(curved ? one_more : 0, 0.0);
  for (LargeVector<int> &v : side) v.assign(pairs, 0);
  attached.assign(sticks ? pairs : 0, 0);
  for (LargeVector<double> *v : {&sticking, &adhesion, &film_angle[0], &film_angle[1], &least})
    v->assign(sticks ? one_more : 0, 0.0);
}

deformable::PairPlaces NearPairs::places(const double *x, const double *radius)
{
  return {i.data(),       j.data(),     x,         radius,   per_distance.data(),
          overlap.data(), angle.data(), nx.data(), ny.data()};
}

// The kernel that has found one compares squares of distances, which round differently.
int NearPairs::first_behind(const double *radius) const
{
  constexpr double ROUNDING = 1e-14;
  for (int k = 0; k < wall; ++k) {
    const double ri = radius[i[k]], rj = radius[j[k]], d = 1.0 / per_distance[k];
    const double least = deformable::nearest_square(ri + rj, std::fabs(ri - rj));
    if (!(d * d > (1.0 + ROUNDING) * least)) return k;
  }
  return -1;
}
