// Rings with given forces in batches, and the pairs that bear the forces: arrays, and what can be done with them. The
// functions are compiled for several levels of SIMD instructions (force_lanes.h, pair_lanes.h).

#ifndef DEFORMABLE_FORCE_KERNELS_H
#define DEFORMABLE_FORCE_KERNELS_H

namespace deformable {

// A batch has so many rings, with equal numbers of places for contacts, on every level. An array of contacts has the
// first contact of all rings of a batch, then the second one, and so on.
constexpr int LANES = 8;

// Pairs as rings see them. The direction is that from the first ring of a pair. One more than pairs: the last one, of
// places of contacts that are empty, bears nothing.
struct PairDirections {
  const double *force, *angle, *nx, *ny;
};

// Rings: batch x LANES + lane.
struct RingArrays {
  const double *radius, *kA, *kP;    // of the ring without skin
  double *pressure, *expansion, *work, *total;
  double *per_pressure, *mixed, *square, *rate;    // compliance, see RingCompliance
};

// Contacts, and G of each two contacts of a ring: the lower triangle by rows. What is in single precision is for
// conjugate gradients, which only correct forces and mostly wait for memory.
struct ContactArrays {
  const int *seat;                     // 2 x the index of the pair, + 1 for its second ring
  double *indentation, *compliance;    // a and da_c/df_c
  double *slope;                       // of the outline
  float *product;                      // C x
  float *green;
  double *scratch;    // for the rings that have more contacts than any kernel knows, aligned
};

struct RingBatches {
  int batches;
  const int *size, *first, *first_green;    // contacts of a ring; begin of a batch in ContactArrays
  bool soft;                                // some ring does not conserve its perimeter
  RingArrays rings;
  ContactArrays contacts;
};

// Pairs as ForceSolver sees them.
struct PairArrays {
  const double *overlap, *stiffening;
  const int *first, *second;                 // contacts of the pairs
  const double *indentation, *compliance;    // by contact
  const float *contact_product;              // C x, by contact
  double *force, *residual, *error;
  float *weight, *step, *left, *direction, *product;
  double
      scale;    // weights, steps and directions are in units of 1/scale, for the range of single precision
  double *begin;      // forces before the step
  double *past[3];    // forces of the last calls, the latest first
};

constexpr double UNKNOWN_FORCE = -1e300;

struct Largest {
  double error, force;
};

// What follows from positions, and what is needed for that.
struct PairPlaces {
  const int *i, *j;
  const double *radius;    // of particles
  double *per_distance, *overlap, *angle, *nx, *ny;
};

// Contact lines that tilt.
struct LineArrays {
  const double *per_distance, *force;
  const int *first, *second;            // contacts of the pairs
  const double *slope, *slope_rate;     // t and dt/dtheta, by contact
  double *sine, *next;                  // of the tilt, and of the next one
  double *overlap, *angle, *nx, *ny;    // of the tilted line
  double part;                          // of the step to the next tilt
};

struct ForceKernels {
  // Shapes rings by the forces of pairs. False: a ring does not exist.
  bool (*shape)(const RingBatches &, const PairDirections &);
  void (*multiply)(const RingBatches &, const float *x, double scale);    // C x/scale, x by pair
  // Slopes of outlines; also how they change as contacts turn (tilt.h), by contact, unless null.
  void (*slopes)(const RingBatches &, const PairDirections &, double *slope_rate);

  // Loops over pairs, from `begin` to before `end`.

  // Distances, directions and overlaps; x: positions, three numbers a particle. Returns whether all contact lines lie
  // between the centers: d^2 > |R_i^2 - R_j^2|.
  bool (*locate)(const double *x, const PairPlaces &, int begin, int end);

  // r, imbalances and weights from the indentations. The largest imbalance and force.
  Largest (*find_residuals)(const PairArrays &, int begin, int end);

  // Conjugate gradients: the first direction, the product of both rings, the step along the direction, the next
  // direction. Sums of products, in this order: r.w.r, the curvature, left.w.left.
  double (*begin_gradients)(const PairArrays &, int begin, int end);
  double (*add_products)(const PairArrays &, int begin, int end);
  double (*advance)(const PairArrays &, double length, int begin, int end);
  void (*turn)(const PairArrays &, double conjugation, int begin, int end);

  // Replaces the oldest of the past forces by the extrapolation c[0] past[0] + c[1] past[1] + c[2] past[2].
  void (*extrapolate)(const PairArrays &, const double *c, int begin, int end);

  // Turns the change of forces into one that leaves no force negative, and takes it; alone: each pair changes for
  // itself, instead of Newton's method. Returns the slope of the dual energy along the step.
  double (*take_step)(const PairArrays &, bool alone, int begin, int end);

  // The forces become past ones, also those that are not known.
  void (*remember)(const PairArrays &, int begin, int end);

  // The next tilts, by Newton's method for each line alone; returns the largest imbalance. Lines take their next tilts.
  double (*find_tilts)(const LineArrays &, int begin, int end);
  void (*turn_lines)(const LineArrays &, int begin, int end);

  double (*sum)(const float *, int begin, int end);
  double (*dot)(const double *, const float *, int begin, int end);
};

}    // namespace deformable

#endif
