#include "near_pairs.h"

#include "trigonometry.h"
#include "vector_loops.h"

#include <cmath>

using namespace LAMMPS_NS;

// A vector that grows by itself may take twice the memory that it needs.
void NearPairs::clear(int expected)
{
  const std::size_t most = expected + expected / 16 + 16;
  remote = wall = size = 0;
  for (std::vector<int> *v : {&i, &j, &second}) {
    v->clear();
    v->reserve(most);
  }
  for (std::vector<double> &v : past) {
    v.clear();
    v.reserve(most);
  }
  for (std::vector<double> &v : past_tilt) {
    v.clear();
    if (tilts) v.reserve(most);
  }
}

void NearPairs::make_room()
{
  const std::size_t pairs = size, one_more = pairs + 1;
  for (std::vector<double> *v : {&touching, &least_square, &stiffening}) v->assign(pairs, 0.0);
  for (std::vector<double> *v : {&force, &overlap, &per_distance, &angle, &ny})
    v->assign(one_more, 0.0);
  nx.assign(one_more, 1.0);
  tilt.assign(tilts ? one_more : 0, 0.0);
  for (std::vector<int> &v : side) v.assign(pairs, 0);
}

DEFORMABLE_CLONES int LAMMPS_NS::locate_pairs(const double *x, NearPairs &p)
{
  const int n = p.wall;
  const int *const i = p.i.data(), *const j = p.j.data();
  const double *const touching = p.touching.data(), *const least = p.least_square.data();
  double *const per_distance = p.per_distance.data(), *const overlap = p.overlap.data();
  double *const angle = p.angle.data(), *const nx = p.nx.data(), *const ny = p.ny.data();
  int wrong = 0;
  DEFORMABLE_INDEPENDENT
  for (int k = 0; k < n; ++k) {
    const double dx = x[3 * j[k]] - x[3 * i[k]], dy = x[3 * j[k] + 1] - x[3 * i[k] + 1];
    const double square = dx * dx + dy * dy, d = std::sqrt(square), per_d = 1.0 / d;
    wrong += !(square > least[k]);
    per_distance[k] = per_d;
    overlap[k] = touching[k] - d;
    nx[k] = dx * per_d;
    ny[k] = dy * per_d;
    angle[k] = deformable::angle_of(dx, dy);
  }
  if (wrong == 0) return -1;
  for (int k = 0; k < n; ++k) {
    const double d = touching[k] - overlap[k];
    if (!(d * d > least[k])) return k;
  }
  return -1;
}

DEFORMABLE_CLONES void LAMMPS_NS::tilt_lines(NearPairs &p, const double *to)
{
  const int n = p.wall;
  const double *const touching = p.touching.data(), *const per_distance = p.per_distance.data();
  double *const overlap = p.overlap.data(), *const tilt = p.tilt.data();
  double *const angle = p.angle.data(), *const nx = p.nx.data(), *const ny = p.ny.data();
  DEFORMABLE_INDEPENDENT
  for (int k = 0; k < n; ++k) {
    const double s = tilt[k], c = std::sqrt(1.0 - s * s);
    const double sine = to[k], cosine = std::sqrt(1.0 - sine * sine);
    const double ex = c * nx[k] + s * ny[k], ey = c * ny[k] - s * nx[k];
    const double x = cosine * ex - sine * ey, y = cosine * ey + sine * ex;
    tilt[k] = sine;
    nx[k] = x;
    ny[k] = y;
    angle[k] = deformable::angle_of(x, y);
    overlap[k] = touching[k] - cosine / per_distance[k];
  }
}
