// Rings with given forces in batches, and the pairs that bear the forces. Compiled for each level of SIMD instructions, see
// cmake/sources.cmake.

#include "kernels/correction_lanes.h"
#include "kernels/curve_lanes.h"
#include "kernels/force_lanes.h"
#include "kernels/pair_lanes.h"

namespace deformable::DEFORMABLE_LEVEL {

extern const ForceKernels force_kernels;

// A constant: nothing is computed where the plugin is loaded, which would use instructions of this level.
constexpr ForceKernels force_kernels = [] {
  ForceKernels k = {};
  k.shape = shape_rings;
  k.adapt = adapt_rings;
  k.slopes = slopes_of_rings;
  k.begin = begin_corrections;
  k.go_on = go_on;
  k.multiply = multiply;
  k.advance = advance;
  k.advance_and_multiply = advance_and_multiply;
  k.advance_twice = advance_twice;
  k.follow = follow_rings;
  k.respond = respond_rings;
  k.locate = locate_pairs;
  k.find_residuals = find_residuals;
  k.find_unbalanced = find_unbalanced;
  k.extrapolate = extrapolate;
  k.take_step = take_step;
  k.remember = remember;
  k.remember_values = remember_values;
  k.find_lines = find_lines;
  k.answer = answer;
  k.settle = settle;
  k.turn_lines = turn_lines;
  k.find_films = find_films;
  k.take_films = take_films;
  k.dot = dot;
  return k;
}();

}    // namespace deformable::DEFORMABLE_LEVEL
