// The linear equations of a step of Newton's method: C x = r to an accuracy, for the pairs that take part. C are the
// compliances of the particles, r what is left of the overlaps, w the weights of pairs (see PairArrays). C is an operator, never
// a matrix of all pairs: kernels multiply, particle by particle.
//
// Where the bounds of the spectrum are known, Chebyshev's iteration, whose coefficients follow from them alone: without sums
// over all pairs, ranks wait for their neighbors only, and each block of particles may run ahead of the others (BlockLevels).
// Conjugate gradients find the bounds.

#ifndef DEFORMABLE_LINEAR_SOLVER_H
#define DEFORMABLE_LINEAR_SOLVER_H

#include "solver/contact_batches.h"
#include "solver/remote_sides.h"
#include "solver/tuning.h"

#include <vector>

namespace deformable {

class LinearSolver {
 public:
  LinearSolver(const ForceKernels &kernels, const Tuning &tuning) : kernels(kernels), tuning(tuning)
  {
  }

  void invalidate_bounds() { are_invalid = true; }    // then conjugate gradients come next

  // Returns the number of iterations that are still to be done: 0 if conjugate gradients have solved the equations already.
  // norm2: the sum of w r^2/length^2. In the end x is in `batches.step`.
  int begin(ContactBatches &batches, RemoteSides &, const PairArrays &, double norm2,
            double accuracy);

  bool knows_bounds() const { return highest > 0.0 && !are_invalid; }
  int plan(double accuracy);    // the same without conjugate gradients

  // Whether a step x may have this slope r x. Within the bounds of the spectrum none has another one, but for what steps do to
  // pairs that open or close; outside of them iterations diverge. norm2: in units of the slope.
  bool is_sound(double slope, double norm2) const
  {
    return slope > 0.0 && slope <= 2.0 * norm2 / lowest;
  }

  // Iteration k of `last` of some rings, from 1 on, and the products that it leaves, by contact. Steps are `gain` times as long.
  // `left`, unless null: the step so far goes on; this is what it has left of the residuals, before products(.., 0) are subtracted.
  void iterate(RingBatches, const PairArrays &, int k, int last, const float *left = nullptr,
               double gain = 1.0) const;
  static float *products(const RingBatches &, int k);

 private:
  const ForceKernels &kernels;
  const Tuning &tuning;
  // bounds of the eigenvalues of C, with the weights; if highest = 0, Chebyshev's iteration is not worth it
  double lowest = 0.0, highest = 0.0;
  bool are_invalid = true;
  std::vector<double> alpha, beta;    // of each iteration

  void conjugate_gradients(ContactBatches &, RemoteSides &, const PairArrays &, double norm2,
                           double accuracy);
  double decay() const;
  bool find_bounds(const std::vector<double> &alpha, const std::vector<double> &beta);
};

}    // namespace deformable

#endif
