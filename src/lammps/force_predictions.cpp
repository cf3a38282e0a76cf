// How the forces of the last calls predict those of the next one.

#include "force_solver.h"

#include <cmath>
#include <limits>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   At successive steps forces start from an extrapolation in time: a cubic one,
   behind a kink a straight line. Where a loose tolerance leaves errors that it
   would amplify it is one that is stable if each step corrects it (J. Kolafa, J.
   Comput. Chem. 25, 335 (2004)), and in a minimization a quadratic one.
   The error of a cubic one is even in time, so what the correction leaves of it
   neither heats nor cools. With a quadratic one energies drifted.
------------------------------------------------------------------------- */

deformable::Extrapolation ForceSolver::find_extrapolation() const
{
  constexpr double INFINITE = std::numeric_limits<double>::infinity();
  constexpr double SMOOTH = 300.0;    // of the tolerance
  // velocities jump in a minimization
  const bool is_cubic = devices.cubic && consecutive_calls == MOST && !must_correct && !minimizing();
  deformable::Extrapolation found;
  found.slope = consecutive_calls > 1 ? 1.0 : 0.0;
  found.bend = must_correct ? 0.5 : predicts() ? 1.0 : 0.0;
  found.twist = is_cubic ? 1.0 : 0.0;
  // after a prediction that no rings can bear, each kink counts
  const double largest = std::isfinite(first_evaluation.largest) ? first_evaluation.largest : 0.0;
  found.smooth = is_cubic && devices.kink ? SMOOTH * tolerance * largest / pairs->unit() : INFINITE;
  return found;
}
