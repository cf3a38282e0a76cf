// Droplets with given forces. Compiled for each level of SIMD instructions, see cmake/sources.cmake.

#include "kernels/droplet_lanes.h"

namespace deformable::DEFORMABLE_LEVEL {

extern const DropletKernels droplet_kernels;

const DropletKernels droplet_kernels = {shape_droplets, adapt_droplets};

}    // namespace deformable::DEFORMABLE_LEVEL
