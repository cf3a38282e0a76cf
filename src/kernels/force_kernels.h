// Rings with given forces in batches, and the pairs that bear the forces: arrays, and what can be done with them. The
// functions are compiled for several levels of SIMD instructions (force_lanes.h, pair_lanes.h).

#ifndef DEFORMABLE_FORCE_KERNELS_H
#define DEFORMABLE_FORCE_KERNELS_H

#include "laws/stiffness.h"
#include "laws/trigonometry.h"

#include <cstddef>

namespace deformable {

// A batch has so many rings, with equal numbers of places for contacts, on every level. An array of contacts has the
// first contact of all rings of a batch, then the second one, and so on.
constexpr int LANES = 8;

// Pairs as rings and droplets see them. The direction is that from the first particle of a pair. One more than pairs: the last one,
// of places of contacts that are empty, bears nothing.
struct PairDirections {
  const double *force;
  const double *angle;           // in the plane
  const double *nx, *ny, *nz;    // nz: in space
  const double *bend;    // tan(beta/2), see contact_curve.h; null where contact lines are straight
  const double *
      least;    // of films: in the plane -2 T sin(theta), see contact_curve.h; null: no film sticks
};

// Rings: batch x LANES + lane.
struct RingArrays {
  const double *radius;    // of the ring without skin
  StiffnessArrays stiffness;
  double *pressure, *work, *total, *per_pressure;
  float *square;    // see ContactArrays
  // null unless rings are soft
  double *expansion;
  float *mixed, *rate;
  const double *skin;    // null where no ring has any
  double scale;          // compliances are in units of it, for the range of single precision
};

// Contacts, and G of each two contacts of a ring: the lower triangle by rows. Numbers in single precision are for
// iterations that only correct forces and mostly wait for memory. They have the compliances of
// RingCompliance in units in which nothing is large or small: v_c = (a_c + expansion)/(sum of contact lengths), and
//   p C_ck = G(theta_c - theta_k) + rate - mixed (v_c + v_k) - square v_c v_k.
// Droplets have the same with the forces as v, the tension as p, and an `own` of each contact in place of G(0).
struct ContactArrays {
  const int *pair_side;    // 2 x the index of the pair, + 1 for its second ring
  double *indentation;     // a
  float *compliance;       // da_c/df_c
  double *slope;           // of the outline
  float *share;            // v
  float *green;
  float *own;       // null: G(0) for all contacts
  void *scratch;    // for the rings that have more contacts than any kernel knows, aligned
};

// What films that stick do to rings: T of each, and FilmTerms of each contact (contact_curve.h).
struct StickArrays {
  const double *tension;    // null: no film sticks
  double *terms[4];
};

// Outlines at curved lines (contact_curve.h). Numbers in single precision have no units: pressures are in 1/scale, forces in
// length/scale.
struct OutlineArrays {
  // by ring, and behind those of this rank the second rings of remote pairs
  double *free_radius;    // Q; null: all lines are straight
  // two floats: p falls by `bulk` times an area that flows in; the largest dp/df
  double *bulk_and_swell;
  float *per_lengths;    // 1/(sum of contact lengths), as in ContactArrays
  // two floats: the changes of p and of p Q that follow from those of forces and lines
  double *change;
  // by contact
  float *nx, *ny;
  float *rate;      // dt/dtheta
  float *across;    // the change of t that follows
  float *turn;      // G'(theta_m - theta_k), in the order of `green`
  double length;
};

// Corrections of forces, by contact: the weight w, what is left of r, the direction d, the step so far, and the product
// C d of the contact's own ring. Both contacts of a pair have the same numbers, except products. So each ring finds its
// own side by side, and only products have to be fetched from the other ring.
struct CorrectionArrays {
  const int *partner;    // the other contact of the pair, or `none`
  int none;              // index of a dummy contact, whose product is always 0
  float *weight, *left, *direction, *step;
  // the same array, unless a kernel reads the last products and finds new ones
  float *product, *last_product;
  int products;    // with those of other ranks; there is room for two of each
};

struct RingBatches {
  int begin, end;    // the batches that are meant
  // contacts of a ring; begin of a batch in arrays of contacts and in `green`, also of `end`
  const int *size, *first;
  const std::size_t *first_green;
  bool soft;    // some ring does not conserve its perimeter
  RingArrays rings;
  ContactArrays contacts;
  CorrectionArrays corrections;
  StickArrays films;
  OutlineArrays outline;
};

// A quantity of pairs at the last call, x(-1) or UNKNOWN; and x(-2) - x(-1), x(-3) - x(-2), x(-4) - x(-3) in the pairs' unit.
constexpr double UNKNOWN = -1e300;
struct PastArrays {
  double *last;
  float *earlier[3];
};

// Pairs as DualSolver sees them. Numbers in single precision are in units in which nothing is large or small:
// residuals in `length`, weights in 1/scale, steps in unit = length/scale, and k in 1/(scale length^2).
struct PairArrays {
  const double *overlap;
  const float *stiffening;      // k
  const int *side[2];           // contacts of the pairs
  const double *indentation;    // by contact
  const float *compliance;
  const float *correction;    // of the force, by contact
  double *force;
  float *residual, *weight;    // 1/(C_i + C_j), negative where the pair takes no part
  float *step;
  double length, unit;
  PastArrays past;
  float *before;          // forces before the step
  const double *least;    // see least_force; null: 0
};

// The least force that a pair may bear; it bears one if its force is larger. 0, or below for films that stick.
template <class T> DEFORMABLE_INLINE T least_force(const PairArrays &p, int k)
{
  T least{};
  if (p.least) __builtin_memcpy(&least, p.least + k, sizeof least);
  return least;
}

// The next x(0) from the last ones, x(-1) to x(-4): x(-1) + slope D + bend D2 + twist D3, with the differences D = x(-1) - x(-2),
// D2 of D and D3 of D2. Where x has a kink, D3 is about as large as D2, not much smaller: then a straight line is best. Smaller D3
// than `smooth`, in `unit`, do not matter.
constexpr double KINK = 0.5;    // D3 over D2, at least
struct Extrapolation {
  double slope, bend, twist, smooth, unit, least;
};

// The largest imbalance, force, and r/length; over the pairs with a positive weight, sums of w r^2/length^2 and of the
// weights.
struct Residuals {
  double error = 0.0, force = 0.0, left = 0.0, norm2 = 0.0, weights = 0.0;
};

// What follows from positions, and what is needed for that.
struct PairPlaces {
  const int *i, *j;
  const double *x, *radius;    // of particles; three numbers for each place
  double *per_distance, *overlap, *angle, *nx, *ny;
};

// Contact lines that tilt and bend, see CurvedLines.
struct LineArrays {
  const double *per_distance;
  const int *ring[2];        // of the pairs
  const double *slope;       // t, by contact
  const double *pressure;    // by ring
  OutlineArrays outline;
  double *sine, *next_sine;             // of the tilt, and of the next one
  double *bend;                         // tan(beta/2)
  double *overlap, *angle, *nx, *ny;    // of the tilted line
  float *give;    // the sine of the tilt changes by `give` times the change of both slopes
  // two floats: f dtau, and the area that flows to the second ring as the line bends
  double *answer;
  // the area for forces as they are, and what differences of pressure add
  float *first_flow, *flow_per_press;
  float *curvature, *feedback;    // and the part that the own flow takes back
  float *left;    // residuals, without what bends that are not at rest do to their own pair
  double part;    // of the step to the next tilt and bend
  int wall;       // the first pair with a wall, whose lines stay
  const double *film_angle[2];    // tan(theta/2) of both sides; null: no film sticks
};

// Films that stick, of pairs that may: contact_curve.h. The second contact of a wall does not exist.
struct FilmArrays {
  const double *bend, *adhesion;           // w, 0 where a pair is free
  const int *side[2];                      // contacts of the pairs
  const int *ring[2];                      // rings of the pairs
  const double *pressure, *free_radius;    // by ring
  double *angle[2], *next_angle[2];        // tan(theta/2) of both sides
  double *next_pull;                       // T sin theta
  double *terms[4];                        // FilmTerms, by contact
  int wall;                                // the first pair with a wall
};

// Structures come by value: behind a reference, whatever a kernel stores might change them, and each use would load them
// again.
struct ForceKernels {
  // Shapes rings by the forces of pairs, and finds slopes if lines are curved. False: a ring does not exist.
  bool (*shape)(RingBatches, PairDirections);
  // The same after small changes of the forces; the changes are in this unit and in single precision.
  bool (*adapt)(RingBatches, const double *forces, const float *changes, double unit);
  // Slopes of outlines.
  void (*slopes)(RingBatches, PairDirections);

  // Iterations for C x = r of the pairs that have a positive weight w. Sums are over the contacts of this rank; each
  // pair of two rings has two of them.
  //   begin      takes residuals and weights, d = w r and C d; returns d C d
  //   go_on      the same after the step so far, whose products are known
  //   multiply   the same as begin for d = w r + conjugation d
  //   advance    a step of this length along d; returns w r^2 of all pairs
  double (*begin)(RingBatches, PairArrays);
  void (*go_on)(RingBatches, PairArrays, const float *residual);
  double (*multiply)(RingBatches, double conjugation);
  double (*advance)(RingBatches, double length);
  // In one: advance, then multiply; and the last two steps, of which the second one needs no product. Steps are `gain` times as
  // long as what is left knows.
  void (*advance_and_multiply)(RingBatches, double length, double conjugation, double gain);
  void (*advance_twice)(RingBatches, double length, double conjugation, double last, double gain);

  // How outlines follow: `across`, dp and dT after changes of forces, and of lines as of the last answer. The changes are `step` by
  // pair or, if that is null, the correction so far, whose products are kept, too.
  void (*follow)(RingBatches, LineArrays, const float *step);
  // What lines that answer do to indentations: products, with those of the correction so far unless it only begins.
  void (*respond)(RingBatches, LineArrays, bool begins);

  // Loops over pairs, from `begin` to before `end`.

  // Distances, directions and overlaps. Returns whether all contact lines lie between the centers:
  // d^2 > |R_i^2 - R_j^2|.
  bool (*locate)(PairPlaces, int begin, int end);

  // r and weights from the indentations.
  Residuals (*find_residuals)(PairArrays, int begin, int end);

  // Finds the indices of the pairs whose imbalance, to first order, is above `limit`; returns how many. `found` has room
  // for all pairs.
  int (*find_unbalanced)(PairArrays, double limit, int begin, int end, int *found);

  // What comes next, 0 of pairs without a past; not below the least value, of all or, unless that is null, of each pair. Also moves
  // `earlier` on, so that each pair has it once in a call.
  void (*extrapolate)(PastArrays, Extrapolation, const double *least, double *next, int begin,
                      int end);

  // Turns the change of forces into one that leaves no force negative, and takes it; alone: each pair changes for
  // itself, instead of Newton's method. Returns the slope of the dual energy along the step.
  double (*take_step)(PairArrays, bool alone, int begin, int end);

  // The forces become past ones; and so do other numbers of pairs.
  void (*remember)(PairArrays, int begin, int end);
  void (*remember_values)(PastArrays, const double *, int begin, int end);

  // Where lines are not at rest, and the next tilts by Newton's method for each line alone; returns the largest imbalance.
  double (*find_lines)(PairArrays, LineArrays, int begin, int end);
  // How lines follow outlines: for another correction; and in the end, to the next tilts and bends. Then lines turn.
  void (*answer)(PairArrays, LineArrays, int begin, int end);
  void (*settle)(PairArrays, LineArrays, int begin, int end);
  void (*turn_lines)(LineArrays, int begin, int end);

  // The next angles of films, and their largest imbalance. Films take their angles; both sides of a pair get their terms.
  double (*find_films)(FilmArrays, int begin, int end);
  void (*take_films)(FilmArrays, int begin, int end);

  double (*dot)(const float *, const float *, int begin, int end);
};

// Droplets: what they have beside the arrays of rings (droplets.cpp).

// What only droplets have, in units of R and g R unless it says more. By droplet (batch x LANES + lane), by contact, and by two
// contacts, as RingBatches; tx, ty, tz and damping have the contacts of other ranks, too, and one that is 0 for walls.
struct DropletArrays {
  const double *tension;
  const double *film_log, *per_radii;    // ln(lambda), 1/(R_i + R_j): 0, 0 of a wall
  double *load, *facet;                  // x, y: see droplet.h
  double *still_work, *still;    // W, and a [length], without films that turn and facets that move
  double *nx, *ny, *nz;          // outward
  double *force;                 // f
  double *tx, *ty, *tz;          // R t [length]
  double *damping;               // D of the contact's droplet
  double *torque_x, *torque_y, *torque_z;    // dW/dn [energy]
  float *taken;                              // by facets of others: sum f (dt/df)^2
  double *green, *green2, *d_green;          // G, G2 and G' of two contacts

  // Of films that stick, droplet_film.h. By contact: s and 1 - C, 0 of a free one, lambda, its logarithm, and 1 where the film is a
  // cap, else 0; null where none is.
  const double *sine, *rise, *lean, *lean_log, *is_cap;
  double *stretch, *cover,
      *bulge;             // by droplet: L, the part of it under films, and how far it may bulge
  double *film_radius;    // [length]
  double *curved_by_pressure;    // of caps: what they add to u_P
  double *pressure,
      *least;    // [energy/volume], [force], also of contacts of other ranks, and of walls
};

// RingBatches have W as `work`, the sum of forces as `total`, 1/tension as `per_pressure`, f as `share`, and about
//   g C_ck = `green` + rate - mixed (f_c + f_k) - square f_c f_k,   for c = k `own` in place of `green`.
// There are two of them: for droplets without films, and for such that may have some.
struct DropletKernels {
  // All droplets of the batches, from the forces of their pairs.
  void (*shape)(RingBatches, DropletArrays, PairDirections);
  // The same for other forces.
  void (*adapt)(RingBatches, DropletArrays, PairDirections);
  // Then, when their neighbors have shapes too: films that turn, and facets that move. Indentations and works.
  void (*turn)(RingBatches, DropletArrays);
  // The derivatives by the normals.
  void (*derive)(RingBatches, DropletArrays);
};

}    // namespace deformable

#endif
