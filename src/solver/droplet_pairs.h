// Pairs of droplets that bear a force or may do so soon, and those of droplets and walls: one unknown each.

#ifndef DEFORMABLE_DROPLET_PAIRS_H
#define DEFORMABLE_DROPLET_PAIRS_H

#include "geometry/surface.h"
#include "kernels/droplet_kernels.h"
#include "solver/large_vector.h"
#include "solver/near_pairs.h"
#include "solver/vector_bytes.h"

#include <cmath>
#include <vector>

namespace LAMMPS_NS {

// Pairs with both droplets on this rank come first, then those whose second droplet is a ghost from another rank, then droplets
// and walls.
struct DropletPairs {
  int remote = 0, wall = 0, size = 0;    // first remote pair, first pair with a wall, end

  LargeVector<int> i, j;     // local indices, as in the neighbor list; of a wall: its code < 0
  LargeVector<int> owned;    // by local index: the particle of this rank whose image it is, or -1
  // local index of j's particle, or of the one whose image it is; -1 if that is on another rank
  int second(int k) const { return k < remote ? owned[j[k]] : -1; }
  // Both ranks have a pair with a remote side.
  double part(int k) const { return k >= remote && k < wall ? 0.5 : 1.0; }

  // Forces of the last call, and their differences further and further back: see PastForces.
  LargeVector<double> past, earlier[3];
  PastForces past_of(int k) const
  {
    PastForces found;
    found.force = past[k];
    for (int n = 0; n < 3; ++n) found.earlier[n] = earlier[n][k];
    return found;
  }

  // one more than pairs: the last one stands for places of contacts that are empty
  LargeVector<double> force, overlap, distance;      // of a wall: its distance from the center
  LargeVector<double> nx, ny, nz;                    // from i to j
  std::vector<deformable::SurfacePoint> surfaces;    // from the first pair with a wall on
  deformable::Vector3 normal(int k) const { return {nx[k], ny[k], nz[k]}; }
  deformable::PairForces forces() const { return {force.data(), nx.data(), ny.data(), nz.data()}; }

  void add(int i_, int j_, const PastForces &past_)
  {
    i.push_back(i_);
    j.push_back(j_);
    past.push_back(past_.force);
    for (int n = 0; n < 3; ++n) earlier[n].push_back(past_.earlier[n]);
    ++size;
  }
  void make_room()    // for the arrays that add() does not fill
  {
    for (auto *const v : {&force, &overlap, &distance, &nx, &ny, &nz}) v->assign(size + 1, 0.0);
    surfaces.resize(size - wall);
  }

  // Of a pair with a wall.
  void place(int k, double radius, const deformable::SurfacePoint &point)
  {
    surfaces[k - wall] = point;
    distance[k] = point.height;
    nx[k] = point.n.x;
    ny[k] = point.n.y;
    nz[k] = point.n.z;
    overlap[k] = radius - point.height;
  }

  // Distances, normals and overlaps of pairs of droplets. Returns a pair whose direction is not known, or -1.
  int locate(const double *x, const double *radius)
  {
    int wrong = -1;
    for (int k = 0; k < wall; ++k) {
      const double *const xi = x + 3 * i[k], *const xj = x + 3 * j[k];
      const double dx = xj[0] - xi[0], dy = xj[1] - xi[1], dz = xj[2] - xi[2];
      const double d = std::sqrt(dx * dx + dy * dy + dz * dz), over = 1.0 / d;
      distance[k] = d;
      nx[k] = over * dx;
      ny[k] = over * dy;
      nz[k] = over * dz;
      overlap[k] = radius[i[k]] + radius[j[k]] - d;
      if (!(d > 0.0 && d < HUGE_VAL)) wrong = k;
    }
    return wrong;
  }

  double bytes() const
  {
    return bytes_of(i, j, owned, past, earlier[0], earlier[1], earlier[2], force, overlap, distance,
                    nx, ny, nz, surfaces);
  }
};

}    // namespace LAMMPS_NS

#endif
