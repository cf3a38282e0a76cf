// Droplets with given forces: arrays, and what can be done with them. The functions are compiled for several levels of SIMD
// instructions (droplet_lanes.h).

#ifndef DEFORMABLE_DROPLET_KERNELS_H
#define DEFORMABLE_DROPLET_KERNELS_H

#include <cstddef>

namespace deformable {

// A droplet has places for its contacts, a multiple of these.
constexpr int PLACES = 8;

// Pairs: the force, and the normal from the first droplet. One more than pairs: the last one, of empty places, bears
// nothing.
struct PairForces {
  const double *force, *nx, *ny, *nz;
};

// By droplet, and by place from first[droplet] on.
struct DropletArrays {
  const int *first, *contacts;    // `first` has one more than droplets
  const std::size_t *matrix;      // first of the matrices of a droplet, contacts x places
  const double *radius, *tension;
  double *load, *work;    // x, and W = g R^2 w
  float *slope, *bend;    // see DropletLoad; bend: times `squares`

  const int *seat;         // 2 x the pair, + 1 for its second droplet
  double *nx, *ny, *nz;    // outward
  double *force;           // f
  float *rounded;          // f
  double *response;        // sum G f
  double *indentation;     // a, a length
  double *tx, *ty,
      *tz;              // sum over the others of dG/dm f n: a/R changes by dG/dm f n as n_c turns
  float *compliance;    // da/dF for the force of the place alone
  float *green, *d_green;    // matrices
  float *scratch;            // for the largest droplet
};

struct DropletKernels {
  // All of the droplets begin to end, from the forces of their pairs.
  void (*evaluate)(const DropletArrays &, const PairForces &, int begin, int end);
  // The same after a small step to these forces of the pairs, from what evaluate has left. Products with the step are in
  // single precision.
  void (*adapt)(const DropletArrays &, const PairForces &, const float *step, int begin, int end);
  // What a step of the forces of the pairs changes to first order: da by place.
  void (*multiply)(const DropletArrays &, const float *step, float *product, int begin, int end);
};

}    // namespace deformable

#endif
