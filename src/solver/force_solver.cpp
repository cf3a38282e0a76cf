#include "solver/force_solver.h"

#include "update.h"

#include <cmath>
#include <limits>

using namespace LAMMPS_NS;

ForceSolver::ForceSolver(LAMMPS *lmp, const deformable::ForceKernels &kernels, bool curved,
                         double tolerance, int max_evaluations)
    : Pointers(lmp),
      tolerance(tolerance),
      max_evaluations(max_evaluations),
      pipeline(lmp, kernels)
{
  if (curved) lines = std::make_unique<CurvedLines>(kernels);
}

void ForceSolver::arrange(ForceBatches &b, NearPairs &p, RemoteSides &r, bool new_list)
{
  pairs = &p;
  pipeline.arrange(b, p, r);
  if (lines) lines->arrange(b, p, r);
  if (new_list) pipeline.corrector.doubt_bounds();
}

void ForceSolver::begin_call()
{
  constexpr double SMOOTH = 300.0;    // of the tolerance
  predictor.begin_call(update->ntimestep);
  pipeline.begin_call();
  const deformable::Extrapolation next =
      predictor.next(minimizing(), SMOOTH * limit(planned_from) / pairs->unit());
  pipeline.extrapolate(next);
  if (lines) lines->predict(next.slope);
  is_first = true;
  is_remembered = is_corrected = false;
  allowed = max_evaluations;
}

void ForceSolver::begin_again()
{
  remember();
  allowed = evaluations() + max_evaluations;
}

bool ForceSolver::minimizing() const
{
  return update->whichflag == 2;
}

void ForceSolver::remember()
{
  if (!is_remembered) pipeline.remember();
  is_remembered = true;
}

// A step overwrites what the forces of the last call were.
void ForceSolver::forget()
{
  if (is_remembered) predictor.forget();
  is_remembered = false;
}

/* ---------------------------------------------------------------------- */

bool ForceSolver::solve()
{
  if (!is_first) pipeline.take_past();
  pipeline.agree();
  if (lines) lines->begin();
  Evaluation now = first_evaluation();

  local_corrections = 0;
  int anew = 0;
  // beyond confluence, curved lines may have no balance: so many evaluations that do not halve the imbalance are enough
  constexpr int STUCK = 200;
  double halved = std::numeric_limits<double>::infinity();
  int since = evaluations();
  for (;;) {
    // Forces were extrapolated too far: anew, even beyond maxeval. Where curved lines lead astray once more, straight ones.
    if (!now.exists && anew < (lines ? 2 : 1)) {
      ++anew;
      halved = std::numeric_limits<double>::infinity();
      since = evaluations();
      forget();
      pipeline.start_from_nothing();
      if (lines) lines->straighten(anew == 2);
      if (anew == 2) allowed = evaluations() + max_evaluations;
      now = pipeline.evaluate();
    }
    if (is_balanced(now) || !may_go_on() || !std::isfinite(now.force)) break;
    if (now.worst() < 0.5 * halved) {
      halved = now.worst();
      since = evaluations();
    } else if (evaluations() > since + STUCK) {
      break;
    }
    forget();
    if (!correct_some(now)) now = correct(now);
  }
  if (lines) {
    if (now.of_lines < 0.0) now.of_lines = lines->imbalance();
    lines->remember();
  }
  exists = now.exists;
  imbalance = !now.exists ? 1.0 : now.worst() > 0.0 ? now.worst() / now.force : 0.0;
  return now.exists && now.worst() <= limit(now);
}

// The forces of a minimizer vanish. Those of contacts go on with them below the tolerance if each call corrects them.
// Lines count only where forces balance: before, they are not worth their evaluation.
bool ForceSolver::is_balanced(Evaluation &now)
{
  if (!now.exists || now.imbalance > limit(now)) return false;
  if (minimizing() && !is_corrected && now.imbalance > 0.0) return false;
  if (lines && now.of_lines < 0.0) now.of_lines = lines->imbalance();
  return now.of_lines <= limit(now);
}

/* ---------------------------------------------------------------------- */

Evaluation ForceSolver::first_evaluation()
{
  const bool is_planned = is_first && predictor.predicts() && !minimizing() && !lines &&
                          pipeline.corrector.knows_bounds() && planned_from.exists &&
                          planned_from.norm2 > 0.0 && planned_from.force > 0.0;
  if (is_planned) {
    is_first = false;
    return evaluate_and_correct();
  }
  const Evaluation now = pipeline.evaluate();
  if (is_first) planned_from = now;
  is_first = false;
  return now;
}

/* ----------------------------------------------------------------------
   In motion each call needs about the same correction as the last one: it is
   one more run through the blocks if nobody waits for the imbalance before it.
------------------------------------------------------------------------- */

Evaluation ForceSolver::evaluate_and_correct()
{
  constexpr double RELAXED = 1e3;    // of the tolerance
  is_corrected = true;
  Stages stages = {Stage::SHAPE, Stage::LOOK};
  if (pipeline.relaxation.begin(RELAXED * tolerance, planned_from.force))
    stages.insert(stages.end(), {Stage::WAIT, Stage::RELAX, Stage::TURN, Stage::LOOK});
  stages.insert(stages.end(), pipeline.corrector.plan(accuracy(planned_from)), Stage::CORRECT);
  const Stage shape = shape_after(planned_from);
  stages.insert(stages.end(), {Stage::STEP, shape, Stage::LOOK});
  Evaluation now = pipeline.run(stages, &planned_from);
  if (!planned_from.exists) return now;
  if (shape == Stage::ADAPT &&
      shape_after(planned_from) != shape) {    // a larger step than planned
    const double slope = now.slope;
    now = pipeline.evaluate();
    now.slope = slope;
  }
  return line_search(accept(now, planned_from, true, true), BETTER * planned_from.imbalance);
}

// False: all have to be corrected. The state may be another one then too.
bool ForceSolver::correct_some(Evaluation &now)
{
  constexpr double NO_WORSE = 2.0;
  constexpr int OFTEN = 4;
  if (local_corrections == OFTEN || evaluations() + 2 >= allowed || lines ||
      !pipeline.corrector.knows_bounds() || !now.exists || now.imbalance <= limit(now) ||
      now.norm2 == 0.0)    // only rings without force touch
    return false;
  BlockLevels::Choice chosen;
  if (!pipeline.are_few(limit(now), chosen)) return false;

  ++local_corrections;
  const Evaluation from = now;
  Stages stages(pipeline.corrector.plan(accuracy(from)), Stage::CORRECT);
  stages.insert(stages.end(), {Stage::STEP, shape_after(from)});
  now = pipeline.run_alone(chosen, stages);
  if (now.exists && is_sound(now, from) && now.imbalance <= NO_WORSE * from.imbalance) return true;
  pipeline.take_back(chosen);
  now = pipeline.evaluate();
  local_corrections = OFTEN;
  return false;
}

Evaluation ForceSolver::correct(const Evaluation &from)
{
  constexpr double CLOSE = 0.05, NO_WORSE = 2.0;
  if (from.of_lines > 0.0) {    // only lines are missing
    lines->take();
    return pipeline.evaluate();
  }
  is_corrected = true;
  const bool moves = lines && from.imbalance <= CLOSE * from.force;
  const int corrections = pipeline.begin_corrections(from, accuracy(from));
  Stages stages(corrections, Stage::CORRECT);
  stages.push_back(Stage::STEP);
  if (!moves) stages.insert(stages.end(), {shape_after(from), Stage::LOOK});
  const Evaluation stepped = accept(pipeline.run(stages), from, corrections > 0, !moves);
  if (!moves) return line_search(stepped, BETTER * from.imbalance);
  const double of_lines = lines->imbalance();
  lines->adapt(of_lines);
  lines->take();
  Evaluation now = pipeline.evaluate();
  now.slope = stepped.slope;
  // between films lines alone seldom make it worse: iterations may diverge slowly
  if (lines->films && now.imbalance > from.imbalance) pipeline.corrector.doubt_bounds();
  return line_search(now, NO_WORSE * std::max(from.imbalance, of_lines));
}

/* ----------------------------------------------------------------------
   Newton's method squares its relative error in each step: its direction need
   not be better than that, nor much better than the tolerance. The margin is
   for the energy: what is left acts in each of millions of steps. Lines that
   follow bring back about OF_LINES of a correction.
------------------------------------------------------------------------- */

double ForceSolver::accuracy(const Evaluation &from) const
{
  constexpr double COARSE = 0.1, MARGIN = 0.1, SQUARE = 10.0, OF_LINES = 0.03;
  const double most =
      std::max(SQUARE * pipeline.imbalance_per_pair(from) / from.force, lines ? OF_LINES : 0.0);
  return std::min(COARSE, std::max(MARGIN * limit(from) / from.imbalance, most));
}

// New shapes from small steps have the rounding of single precision, a part of the step: 6e-4 of the tolerance at most.
// They know straight lines only.
ForceSolver::Stage ForceSolver::shape_after(const Evaluation &from) const
{
  constexpr double SMALL_STEP = 1e4;
  return !lines && from.imbalance <= SMALL_STEP * limit(from) ? Stage::ADAPT : Stage::SHAPE;
}

// Within the bounds of the spectrum no step has another slope; outside of them iterations diverge.
bool ForceSolver::is_sound(const Evaluation &now, const Evaluation &from) const
{
  const double most = pipeline.corrector.largest_slope(from.norm2) * pipeline.unit_of_energy();
  return now.slope > 0.0 && now.slope <= most;
}

// The state after a step; where that leads astray, the one before it, or one after a step of each pair alone.
Evaluation ForceSolver::accept(Evaluation now, const Evaluation &from, bool iterated,
                               bool has_shapes)
{
  if (iterated && !is_sound(now, from)) {
    pipeline.corrector.doubt_bounds();
    pipeline.move(1.0, 0.0);
    return pipeline.evaluate();
  }
  if (now.slope > 0.0) return now;
  // single precision is not enough
  pipeline.move(1.0, 0.0);
  if (has_shapes) pipeline.evaluate();
  const double slope = pipeline.step_alone();
  if (has_shapes) now = pipeline.evaluate();
  now.slope = slope;
  return now;
}

/* ----------------------------------------------------------------------
   The dual energy is concave along the step. A step that is much too long
   has a negative slope at its end, and the search looks for the place where
   the slope vanishes. What single precision leaves of a small step is far
   below the tolerance.
------------------------------------------------------------------------- */

Evaluation ForceSolver::line_search(Evaluation now, double enough)
{
  constexpr double SMALL_SLOPE = 0.5;
  const double slope = now.slope;
  if (!(slope > 0.0)) return now;    // no step
  double low = 0.0, low_slope = slope, high = 1.0, at = 1.0;
  for (;;) {
    if (now.exists && now.imbalance <= std::max(enough, limit(now))) return now;
    pipeline.corrector.doubt_bounds();
    const double here =
        now.exists ? pipeline.slope_at_end() : -std::numeric_limits<double>::infinity();
    if (here >= -SMALL_SLOPE * slope && (at == 1.0 || here <= SMALL_SLOPE * slope)) return now;
    if (!may_go_on()) return now;

    double next;
    if (here > 0.0) {
      low = at;
      low_slope = here;
      next = 0.5 * (low + high);
    } else {
      high = at;
      next = low + (high - low) * (std::isinf(here) ? 0.25 : low_slope / (low_slope - here));
    }
    next = std::clamp(next, low + 0.1 * (high - low), high - 0.1 * (high - low));
    if (!(next > low && next < high) || high - low < 1e-10) return now;
    pipeline.move(at, next);
    at = next;
    now = pipeline.evaluate();
  }
}
