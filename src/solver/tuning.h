// What is tuned in the solver. No member changes forces by more than the tolerance, each changes what they cost. In brackets:
// the range that was tried. benchmarks/devices.py measures what a device buys (benchmarks/results/devices.json), and
// tests/lammps/test_tuning.py that forces stay what they are.
//
// For both, the environment variable DEFORMABLE_TUNING sets members of the pair styles that are created later:
// DEFORMABLE_TUNING="margin=0.2 cubic=0".

#ifndef DEFORMABLE_TUNING_H
#define DEFORMABLE_TUNING_H

#include <string>

namespace deformable {

struct Tuning {
  // The list of near pairs: a large margin means more pairs, a small one more builds.
  double margin = 0.1;    // of the smallest radius [0.05, 0.2]
  double column = 3.0;    // width of columns of particles, in smallest radii [1.4, 6]

  // The first forces of a call
  double cubic = 1.0;       // 0: a quadratic
  double smooth = 300.0;    // of the tolerance: smaller third differences are no kink [0, 1e300]
  double planned = 1.0;     // 0: evaluate before it is known how far to correct

  // Pairs that are relaxed one by one before all are corrected (PairRelaxation)
  double relaxed = 1e3;    // of the tolerance: imbalances from here on at first [10, infinity]
  double relaxed_part = 0.04;    // of the pairs: later so many in a call [0.015, 0.15]
  double relaxed_to = 0.01;      // of the largest force: and up to here [0.001, 0.1]
  double crowd = 0.1;            // of the pairs: none, where so many are off
  double of_ring = 0.3;    // of what a particle bears: larger steps are left to the correction

  // The accuracy of a correction, over its length
  double coarse = 0.1;          // at most [0.01, 0.3]
  double of_tolerance = 0.3;    // not closer to the tolerance than that [0.1, 0.3]
  double of_square = 10.0;      // nor than so many squares, which Newton's method leaves [0.1, 10]
  double of_lines = 0.01;       // nor than what lines and films bring back of it [0.003, 0.1]
  double of_answers = 0.1;      // the largest part that lines undo of a solution, twice [0, 0.25]
  double of_films = 0.4;        // and that films under tension add to it [0, 0.6]

  // After small steps shapes are adapted in single precision
  double small_step = 1e4;    // of the tolerance; 0: never [0, 1e4]

  // Chebyshev's iteration
  double chebyshev = 0.6;    // of the decay of conjugate gradients: worth it; infinite: never
  double spectrum = 0.1;     // margin of the largest eigenvalue

  // Curved lines move with forces from this imbalance on
  double close = 0.02;    // of the largest force

  // 0: as many as LAMMPS has, but not more than cores (Threads); else so many
  double threads = 0.0;

  // Evaluations that do not halve the imbalance, after which steps are careful (DualSolver), and after which there may be no balance
  double astray = 10.0;    // [5, 50]
  double stuck = 200.0;

  Tuning changed_by(const std::string &given) const;    // words name=number
};

}    // namespace deformable

#endif
