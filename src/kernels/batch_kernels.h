// The contact laws for many particles at a time, compiled for several levels of SIMD instructions in one library.

#ifndef DEFORMABLE_BATCH_KERNELS_H
#define DEFORMABLE_BATCH_KERNELS_H

#include "kernels/contact_block.h"
#include "kernels/force_kernels.h"

#include <string>

namespace deformable {

// The largest number of active contacts that has kernels.
constexpr int MOST_IN_BATCH = 8;

// Shapes `count` particles with equal numbers of active contacts.
using BatchKernel = void (*)(BlockParticle *const *particles, int count, Place *places,
                             bool shapes);

// Kernels by the number of active contacts.
struct BatchKernels {
  const BatchKernel *sector;
  // Beyond MOST_IN_BATCH: rings that change their perimeter; beyond twice that: with a tension.
  const BatchKernel *ring;
  const ForceKernels &forces;
  const DropletKernels &droplets;
};

// The kernels of this level, or the fastest ones of this processor for an empty name. Null if the level is unknown, too high
// for this processor, or not compiled.
const BatchKernels *batch_kernels(const std::string &level);
// What to say then; `name`: of the setting that has this value.
std::string why_no_kernels(const char *name, const std::string &level);

}    // namespace deformable

#endif
