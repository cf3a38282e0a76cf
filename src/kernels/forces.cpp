// Rings with given forces in batches, and the pairs that bear the forces. Compiled for each level of SIMD instructions, see
// cmake/sources.cmake.

#include "kernels/correction_lanes.h"
#include "kernels/curve_lanes.h"
#include "kernels/force_lanes.h"
#include "kernels/pair_lanes.h"

namespace deformable::DEFORMABLE_LEVEL {

extern const ForceKernels force_kernels;

const ForceKernels force_kernels = {
    shape_rings,   adapt_rings,  slopes_of_rings,      begin_corrections, go_on,
    multiply,      advance,      advance_and_multiply, advance_twice,     follow_rings,
    respond_rings, locate_pairs, find_residuals,       find_unbalanced,   extrapolate,
    take_step,     remember,     remember_values,      find_lines,        answer,
    settle,        turn_lines,   find_films,           take_films,        dot};

}    // namespace deformable::DEFORMABLE_LEVEL
