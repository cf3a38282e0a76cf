// The contact laws for many particles at a time, compiled for several levels of SIMD instructions in one library.
//
// Particles come in blocks: small enough for the cache, large enough for batches of particles with equal numbers of contacts.

#ifndef DEFORMABLE_BATCH_KERNELS_H
#define DEFORMABLE_BATCH_KERNELS_H

#include "kernels/force_kernels.h"
#include "laws/stiffness.h"

#include <string>

namespace deformable {

// A contact from one of its sides: what the law needs, and what it finds. A flat wall is the mirror image of the
// particle.
struct Place {
  double dx, dy;    // from the center of the particle to that of its partner
  double radius;    // of the partner
  double fx, fy;    // force of this side on the particle; the opposite force acts on the partner
  double length;    // 0 without contact
  double force;     // dU/da
  int partner;      // a number for the caller
};

enum class Outcome : char {
  DONE,
  RETRY,    // other contacts are active: those whose length is now positive
  ODD       // not for batches
};

// A particle and its places, `first` to `last`. In front are the contacts that are assumed to be active. At the end,
// from `others` on, are lines outside of the circle that the outline may reach. Places between them are not used.
struct BlockParticle {
  double radius, ring_radius;    // R, and R - c with the thickness c of the skin
  Stiffness stiffness;
  int first, active, others, last;
  int name;    // a number for the caller
  Outcome outcome;
  bool moved;    // other contacts are active than the caller has put in front
  double energy, pressure;
  double area_deficit, perimeter_excess, arc_radius;

  // The shape that no line touches.
  void circle()
  {
    outcome = Outcome::DONE;
    energy = area_deficit = perimeter_excess = 0.0;
    pressure = stiffness.tension > 0.0 ? stiffness.rest_pressure(ring_radius) : 0.0;
    arc_radius = ring_radius;
  }
};

// The largest number of active contacts that has kernels.
constexpr int MOST_IN_BATCH = 8;

// Shapes `count` particles with equal numbers of active contacts.
using BatchKernel = void (*)(BlockParticle *const *particles, int count, Place *places,
                             bool shapes);

// A front of a Cholesky factor, see fronts.cpp: its columns from those of the matrix, and what they subtract from `left`, a square
// matrix of the rows below; and both halves of a solution, where y has the numbers of the columns, then those of the rows below. Behind
// y, and behind the last column, are FRONT_MARGIN numbers more.
constexpr int FRONT_MARGIN = 8;
struct FrontKernels {
  void (*factorize)(float *lower, int width, int height, float *left);
  void (*forward)(const float *lower, int width, int height, float *y);
  void (*backward)(const float *lower, int width, int height, float *y);
};

// All kernels of a level. Those of contact laws are in the order of their numbers of active contacts.
struct BatchKernels {
  const BatchKernel *sector;
  // Beyond MOST_IN_BATCH: rings that change their perimeter; beyond twice that: with a tension.
  const BatchKernel *ring;
  const ForceKernels &forces;
  const DropletKernels &droplets, &sticking_droplets;
  const FrontKernels &fronts;
};

// The kernels of this level, or the fastest ones of this processor for an empty name. Null if the level is unknown, too high
// for this processor, or not compiled.
const BatchKernels *batch_kernels(const std::string &level);
// What to say then; `name`: of the setting that has this value.
std::string why_no_kernels(const char *name, const std::string &level);

}    // namespace deformable

#endif
