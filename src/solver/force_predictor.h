// How the forces of the last calls predict those of the next one: by a polynomial in time through the last calls at
// successive steps, at most a cubic. Where that is a cubic, forces behind a kink, which a contact has that opened or closed,
// are predicted by a straight line.
//
// The error of a cubic is even in time, so what corrections leave of it neither heats nor cools. With a quadratic energies
// drifted. In a minimization velocities jump, and a quadratic is as good.

#ifndef LMP_FORCE_PREDICTOR_H
#define LMP_FORCE_PREDICTOR_H

#include "lmptype.h"

#include "kernels/force_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace LAMMPS_NS {

class ForcePredictor {
 public:
  // A new force call, at this time step.
  void begin_call(bigint step)
  {
    calls = step == last_step + 1 ? std::min(calls + 1, CUBIC) : 0;
    last_step = step;
  }

  // The forces of the last calls are not those of successive steps any more.
  void forget() { calls = 0; }

  // Forces are known well before they are corrected.
  bool predicts() const { return calls >= QUADRATIC; }

  // smooth: third differences of forces that are no kink, in the unit of the differences. After a prediction that no rings
  // could bear it is infinite: then each kink counts.
  deformable::Extrapolation next(bool minimizing, double smooth) const
  {
    constexpr double INFINITE = std::numeric_limits<double>::infinity();
    const bool is_cubic = calls == CUBIC && !minimizing;
    const double no_kink = std::isfinite(smooth) ? smooth : 0.0;
    return {calls >= LINEAR ? 1.0 : 0.0, calls >= QUADRATIC ? 1.0 : 0.0, is_cubic ? 1.0 : 0.0,
            is_cubic ? no_kink : INFINITE};
  }

 private:
  static constexpr int LINEAR = 2, QUADRATIC = 3, CUBIC = 4;
  int calls = 0;    // at successive steps before this one
  bigint last_step = -2;
};

}    // namespace LAMMPS_NS

#endif
