// How accurate the corrections of the forces have to be, and how the rings take their new shapes.

#include "force_solver.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

/* ----------------------------------------------------------------------
   Newton's method squares its relative error in each step: its direction need
   not be better than that, nor much better than the tolerance. The margin is
   for the energy: what is left acts in each of millions of steps.
------------------------------------------------------------------------- */

static constexpr double COARSE = 0.1, MARGIN = 0.1;    // of corrections

// The typical imbalance: the weighted root mean square of r, times the mean weight.
double ForceSolver::typical_of(const Evaluation &from) const
{
  return std::sqrt(from.norm2 * from.weights) / pairs_of_all * pairs->unit();
}

double ForceSolver::accuracy_of(const Evaluation &from) const
{
  constexpr double SQUARE = 10.0;
  const double most = SQUARE * typical_of(from) / from.largest;
  return std::min(COARSE, std::max(MARGIN * tolerance * from.largest / from.forces, most));
}

/* ----------------------------------------------------------------------
   Contacts that open or close in the first step of a call leave more than
   others. One step is enough but for a few blocks (relax_some, correct_some)
   if it brings what is usual below the tolerance. Where contacts change
   everywhere that fails: then all take a second step, and the first one need
   not be much better than what it leaves anyway.
------------------------------------------------------------------------- */

double ForceSolver::accuracy_of_first() const
{
  constexpr double FINE = 1e-5;
  if (!devices.first_step) return accuracy_of(first_evaluation);
  const double least = devices.learned && tries_coarse > 0 ? coarse : FINE;
  return std::min(
      COARSE,
      std::max(MARGIN * tolerance * first_evaluation.largest / first_evaluation.usual, least));
}

void ForceSolver::learn_from_first(double left, bool all_were_corrected)
{
  constexpr double LEAST = 1e-3, MOST = 0.01, WORSE = 2.5;
  constexpr int TRIES = 16, OFTEN = 2;
  if (tries_coarse > 0) {
    --tries_coarse;
  } else {
    failures = all_were_corrected ? failures + 1 : 0;
    if (failures >= OFTEN) tries_coarse = TRIES;
  }
  coarse = std::clamp(WORSE * left, LEAST, MOST);
}

// Returns how many iterations are left to do, in run.
int ForceSolver::begin_corrections(const Evaluation &from)
{
  if (from.norm2 > 0.0)
    return corrector.begin(*pairs, *batches, *remote, arrays(), from.norm2, accuracy_of(from));
  std::fill(batches->step.begin(), batches->step.end(), 0.0F);
  return 0;
}

// New shapes from small steps have the rounding of single precision, a part of the step: 6e-4 of the tolerance at most.
ForceSolver::Stage ForceSolver::shape_after(const Evaluation &from) const
{
  constexpr double SMALL_STEP = 1e4;
  return devices.adapt && from.forces <= SMALL_STEP * tolerance * from.largest ? Stage::ADAPT : Stage::SHAPE;
}
