#include "solver/near_pairs.h"

#include "laws/contact.h"
#include "laws/trigonometry.h"

#include <atomic>
#include <cmath>

namespace deformable {

// A vector that grows by itself may take twice the memory that it needs.
void NearPairs::clear(const KnownPairs &old)
{
  const std::size_t most = old.size + old.size / 64 + 16;
  static_cast<KnownPairs &>(*this) = KnownPairs();
  in_space = old.in_space;
  curved = old.curved;
  adhesive = old.adhesive;
  scale = old.scale;
  length = old.length;
  const auto reserve = [most](auto &...v) { (v.reserve(most), ...); };
  reserve(i, j);
  for (int kind = 0; kind < kinds(); ++kind) {
    Past &p = past[kind];
    reserve(p.last, p.earlier[0], p.earlier[1], p.earlier[2]);
  }
}

void NearPairs::set_units(double scale_, double length_)
{
  const double before = unit();
  scale = scale_;
  length = length_;
  if (unit() == before) return;
  const double ratio = before / unit();
  for (LargeVector<float> &v : past[FORCE].earlier)
    for (float &change : v) change = static_cast<float>(change * ratio);
}

void NearPairs::make_room()
{
  const std::size_t pairs = size, one_more = pairs + 1;
  stiffening.assign(pairs, 0.0F);
  for (LargeVector<double> *v : {&force, &overlap, &per_distance, &ny}) v->assign(one_more, 0.0);
  nx.assign(one_more, 1.0);
  nz.assign(in_space ? one_more : 0, 0.0);
  angle.assign(in_space ? 0 : one_more, 0.0);
  surfaces.resize(in_space ? size - wall : 0);
  for (LargeVector<double> *v : {&tilt, &bend}) v->assign(curved ? one_more : 0, 0.0);
  for (LargeVector<int> &v : side) v.assign(pairs, 0);
  for (LargeVector<int> &v : ring) v.assign(curved ? pairs : 0, 0);
  attached.assign(adhesive ? pairs : 0, 0);
  for (LargeVector<double> *v :
       {&adhesion_if_attached, &adhesion, &film_angle[0], &film_angle[1], &least})
    v->assign(adhesive ? one_more : 0, 0.0);
}

int NearPairs::locate(const ForceKernels &kernels, Threads &threads, const double *x,
                      const double *radius)
{
  if (!in_space) {
    PairPlaces places = {};
    places.i = i.data();
    places.j = j.data();
    places.x = x;
    places.radius = radius;
    places.per_distance = per_distance.data();
    places.overlap = overlap.data();
    places.angle = angle.data();
    places.nx = nx.data();
    places.ny = ny.data();
    std::atomic<bool> are_right = true;
    threads.share(wall, [&](int begin, int end) {
      if (!kernels.locate(places, begin, end)) are_right = false;
    });
    if (are_right) return -1;
    int nearest = -1;    // line, as part of the smaller radius
    double most = 0.0;
    for (int k = 0; k < wall; ++k) {
      const double small = std::fmin(radius[i[k]], radius[j[k]]),
                   large = std::fmax(radius[i[k]], radius[j[k]]), d = 1.0 / per_distance[k];
      const double part = contact_line(d, per_distance[k], small, large).indentation / small;
      if (part <= most) continue;
      nearest = k;
      if (std::isnan(part)) break;
      most = part;
    }
    return nearest;
  }
  std::atomic<int> wrong = -1;
  threads.share(wall, [&](int begin, int end) {
    const int found = locate_in_space(x, radius, begin, end);
    for (int last = wrong; found > last && !wrong.compare_exchange_weak(last, found);) {
    }
  });
  return wrong;
}

int NearPairs::locate_in_space(const double *x, const double *radius, int begin, int end)
{
  int wrong = -1;
  for (int k = begin; k < end; ++k) {
    const double *const xi = x + 3 * i[k], *const xj = x + 3 * j[k];
    const double dx = xj[0] - xi[0], dy = xj[1] - xi[1], dz = xj[2] - xi[2];
    const double d = std::sqrt(dx * dx + dy * dy + dz * dz), over = 1.0 / d;
    per_distance[k] = over;
    nx[k] = over * dx;
    ny[k] = over * dy;
    nz[k] = over * dz;
    overlap[k] = radius[i[k]] + radius[j[k]] - d;
    if (!(d > 0.0 && d < HUGE_VAL)) wrong = k;
  }
  return wrong;
}

void NearPairs::locate_wall(int k, double radius, const SurfacePoint &point)
{
  overlap[k] = radius - point.height;
  nx[k] = point.n.x;
  ny[k] = point.n.y;
  per_distance[k] = point.turn;
  if (in_space) {
    nz[k] = point.n.z;
    surfaces[k - wall] = point;
  } else {
    angle[k] = angle_of(point.n.x, point.n.y);
  }
}

double NearPairs::bytes() const
{
  double of_past = 0.0;
  for (const Past &p : past) of_past += bytes_of(p.last, p.earlier[0], p.earlier[1], p.earlier[2]);
  return of_past + bytes_of(i, j, owned, stiffening, force, overlap, per_distance, angle, nx, ny,
                            nz, tilt, bend, side[0], side[1], ring[0], ring[1], surfaces, attached,
                            adhesion_if_attached, adhesion, film_angle[0], film_angle[1], least);
}

}    // namespace deformable
