// Droplets with given forces, eight side by side: arrays, and what can be done with them. The functions are compiled for
// several levels of SIMD instructions (droplet_lanes.h).

#ifndef DEFORMABLE_DROPLET_KERNELS_H
#define DEFORMABLE_DROPLET_KERNELS_H

#include "kernels/force_kernels.h"

#include <cstddef>

namespace deformable {

// Pairs: the force, and the normal from the first droplet. One more than pairs: the last one, of empty places, bears
// nothing.
struct PairForces {
  const double *force, *nx, *ny, *nz;
};

// Droplets: batch x LANES + lane. Places of their contacts: (first[batch] + contact) x LANES + lane; a batch has as many as its
// droplet with the most contacts, and those of the others are empty. Two contacts c and k < c of a droplet:
// (first_green[batch] + c (c - 1)/2 + k) x LANES + lane.
struct DropletArrays {
  const int *first;                  // one more than batches
  const std::size_t *first_green;    // of each batch
  const double *radius, *tension;
  double *load, *facet, *work;    // x, y, and W = g R^2 w
  float *slope, *bend;            // see DropletLoad; bend: times `squares`

  const int *seat;         // 2 x the pair, + 1 for its second droplet
  double *nx, *ny, *nz;    // outward
  double *force;           // f
  float *rounded;          // f
  double *response;        // sum G f
  double *indentation;     // a, a length
  double *tx, *ty,
      *tz;              // sum over the others of dG/dm f n: a/R changes by dG/dm f n as n_c turns
  float *compliance;    // da/dF for the force of the place alone
  float *green, *d_green;    // G and dG/dm of two contacts
  float *scratch;            // SCRATCH numbers for each place of the largest batch
};

struct DropletKernels {
  static constexpr int SCRATCH = 8;
  // All droplets of the batches begin to end, from the forces of their pairs.
  void (*evaluate)(const DropletArrays &, const PairForces &, int begin, int end);
  // The same after a small step to these forces of the pairs, from what evaluate has left. Products with the step are in
  // single precision.
  void (*adapt)(const DropletArrays &, const PairForces &, const float *step, int begin, int end);
  // What a step of the forces of the pairs changes to first order: da by place.
  void (*multiply)(const DropletArrays &, const float *step, float *product, int begin, int end);
};

}    // namespace deformable

#endif
