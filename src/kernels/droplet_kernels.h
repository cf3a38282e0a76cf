// Droplets with given forces, eight side by side: arrays, and what can be done with them, beside those of force_kernels.h. The
// functions are compiled for several levels of SIMD instructions (droplet_lanes.h).

#ifndef DEFORMABLE_DROPLET_KERNELS_H
#define DEFORMABLE_DROPLET_KERNELS_H

#include "kernels/force_kernels.h"

namespace deformable {

// Pairs: the force, and the normal from the first droplet. One more than pairs: the last one, of empty places, bears
// nothing.
struct PairForces {
  const double *force, *nx, *ny, *nz;
};

// What only droplets have. By droplet (batch x LANES + lane), by contact, and by two contacts, as RingBatches.
struct DropletArrays {
  const double *tension;
  double *load, *facet;    // x, y: see droplet.h
  double *nx, *ny, *nz;    // outward
  double *force;           // f
  double *response;        // sum G f
  double *tx, *ty,
      *tz;           // sum over the others of dG/dm f n: a/R changes by dG/dm f n as n_c turns
  float *d_green;    // dG/dm of two contacts
};

// RingBatches have W as `work`, the sum of forces as `total`, 1/tension as `per_pressure`, f as `share`, and
//   g C_ck = G(m) + rate - mixed (f_c + f_k),   for c = k `own` in place of G.
struct DropletKernels {
  // All droplets of the batches, from the forces of their pairs.
  void (*shape)(RingBatches, DropletArrays, PairForces);
  // The same after small changes of the forces, from what `shape` has left; the changes are in this unit and in single
  // precision.
  void (*adapt)(RingBatches, DropletArrays, PairForces, const float *changes, double unit);
};

}    // namespace deformable

#endif
