#include "force_solver.h"

#include "comm.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using deformable::PairArrays;

void ForceSolver::begin_call(NearPairs &p, ForceBatches &b, const deformable::PairPlaces *places)
{
  pairs = &p;
  batches = &b;
  consecutive_calls =
      update->ntimestep == last_step + 1 ? std::min(consecutive_calls + 1, MOST) : 0;
  last_step = update->ntimestep;
  must_correct = devices.kolafa && predicts() && tolerance > LOOSE;
  extrapolation = find_extrapolation();
  make_room();
  kernels.extrapolate(arrays(), extrapolation, places ? p.remote : 0, p.size);
  if (p.tilts) LineTilts::predict(p, extrapolation);
  evaluations = 0;
  first_solution = true;
  is_remembered = false;
  is_apart = true;
  unlocated = places;
}

bool ForceSolver::minimizing() const
{
  return update->whichflag == 2;
}

void ForceSolver::make_room()
{
  batches->scale = pairs->scale;
  // nothing happens in the last one, which stays zero
  const std::size_t one_more = pairs->size + 1;
  for (LargeVector<float> *v : {&residual, &weight, &step})
    if (v->size() != one_more) v->assign(one_more, 0.0F);
}

void ForceSolver::arrange(const ForceBatches &b, const NearPairs &p, bool new_list)
{
  blocks.arrange(b, p);
  relaxation.arrange(b, p);
  in_vain = 0;
  if (new_list) corrector.doubt_bounds();
}

/* ---------------------------------------------------------------------- */

bool ForceSolver::solve(RemoteSides &r)
{
  NearPairs &p = *pairs;
  remote = &r;
  make_room();
  if (!first_solution)
    for (int k = 0; k < p.size; ++k) p.force[k] = std::max(p.past[k], 0.0);
  if (comm->nprocs > 1) agree();
  if (p.tilts) tilts.start(p, *batches, kernels);

  pairs_of_all = 1.0 + sum_over_pairs([](int a, int z) { return z - a; });

  if (!first_solution) --evaluations;    // of the same forces as the last one
  Evaluation now;
  const bool in_one =
      devices.one_run && (unlocated || !devices.in_blocks) && !p.tilts && predicts() && needs_correction && !minimizing() && corrector.knows_bounds();
  if (in_one) {
    now = evaluate_and_correct();
  } else {
    now = evaluate();
    if (first_solution) first_evaluation = now;
    unlocated = nullptr;
  }
  if (!is_apart) return false;
  bool anew = false;
  // steps need the memory of what the forces of the last call were
  const auto forget = [this] {
    if (is_remembered) consecutive_calls = 0;
    is_remembered = false;
  };
  const auto begin_anew = [&] {
    anew = true;
    forget();
    std::fill(p.force.begin(), p.force.end(), 0.0);
    now = evaluate();
  };
  if (!now.exists) begin_anew();
  // The forces of a minimizer vanish. Those of contacts go on with them below the tolerance if each call corrects them.
  must_correct |= first_solution && minimizing();
  needs_correction = first_evaluation.usual > tolerance * first_evaluation.largest;
  first_solution = false;
  local_corrections = 0;
  has_relaxed = false;
  const double left = now.forces / first_evaluation.forces;
  bool all_were_corrected = false;
  // beyond confluence, tilted lines may have no balance: so many evaluations that do not halve the imbalance are enough
  constexpr int STUCK = 200;
  double halved = std::numeric_limits<double>::infinity();
  int since = evaluations;
  while (!is_balanced(now) && evaluations < max_evaluations && std::isfinite(now.largest)) {
    if (now.worst() < 0.5 * halved) {
      halved = now.worst();
      since = evaluations;
    } else if (evaluations > since + STUCK)
      break;
    forget();
    if (!relax_some(now) && !correct_some(now)) {
      all_were_corrected = true;
      now = correct(now);
    }
    // forces that were extrapolated too far may lead to rings that do not exist
    if (!now.exists && !anew && evaluations < max_evaluations) begin_anew();
  }
  if (in_one && left >= 0.0) learn_from_first(left, all_were_corrected);
  if (p.tilts && !now.knows_torques) now.torques = find_torques();
  if (p.tilts) tilts.remember(p);
  imbalance = now.relative();
  return now.exists && now.worst() <= tolerance * now.largest;
}

// Along the last step, from this part of it to that one. Single precision has the smaller one of two numbers well.
void ForceSolver::move(double from, double to, int begin, int end)
{
  const PairArrays loop = arrays();
  for (int k = begin; k < end; ++k) {
    const double before = loop.before[k], change = loop.step[k], force = loop.force[k];
    const bool is_small = std::fabs(change) < before;
    const double moved = is_small    ? force + (to - from) * change * loop.unit
                         : to == 0.0 ? before * loop.unit
                                     : (before + to * change) * loop.unit;
    loop.force[k] = std::max(moved, 0.0);
  }
}

// Torques count only where forces balance: before, they are not worth their evaluation.
bool ForceSolver::is_balanced(Evaluation &now)
{
  if (!now.exists || now.forces > tolerance * now.largest || (must_correct && now.forces > 0.0))
    return false;
  if (!pairs->tilts) return true;
  now.torques = find_torques();
  now.knows_torques = true;
  return now.torques <= tolerance * now.largest;
}

ForceSolver::Evaluation ForceSolver::correct(const Evaluation &from)
{
  constexpr double CLOSE = 0.05;
  if (from.knows_torques) {    // only tilts are missing
    tilts.turn(*pairs, *batches, kernels);
    return evaluate();
  }
  must_correct = false;
  const int corrections = begin_corrections(from);
  const bool turns = pairs->tilts && from.forces <= CLOSE * from.largest;
  std::vector<Stage> stages(corrections, Stage::CORRECT);
  stages.push_back(Stage::STEP);
  if (!turns) {
    stages.push_back(shape_after(from));
    stages.push_back(Stage::LOOK);
  }
  const Evaluation now = accept(run(stages), from, corrections > 0, turns);
  if (!turns) return line_search(now, from, false);
  const double slope = now.slope;
  Evaluation before = from;
  before.torques = find_torques();
  tilts.adapt(before.torques);
  tilts.turn(*pairs, *batches, kernels);
  Evaluation turned = evaluate();
  turned.slope = slope;
  return line_search(turned, before, true);
}

// The state after a step; where that leads astray, the one before it, or one after a step of each pair alone.
ForceSolver::Evaluation ForceSolver::accept(Evaluation now, const Evaluation &from, bool iterated,
                                            bool turns)
{
  if (iterated) {
    const double most = corrector.largest_slope(from.norm2) * pairs->length * pairs->unit();
    if (!(now.slope > 0.0 && now.slope <= most)) {    // outside of the bounds iterations diverge
      corrector.doubt_bounds();
      move(1.0, 0.0);
      return evaluate();
    }
  }
  if (now.slope > 0.0) return now;
  // single precision is not enough
  move(1.0, 0.0);
  if (!turns) evaluate();
  const double slope =
      sum_over_pairs([this](int a, int z) { return kernels.take_step(arrays(), true, a, z); });
  if (!turns) now = evaluate();
  now.slope = slope;
  return now;
}

/* ----------------------------------------------------------------------
   In motion nearly each call needs a correction, as the last one did: it is
   one more run through the blocks if nobody waits for the imbalance before it.
------------------------------------------------------------------------- */

ForceSolver::Evaluation ForceSolver::evaluate_and_correct()
{
  constexpr double RELAXED = 1e3;    // of the tolerance
  evaluations = 1;
  const bool relaxes = devices.relax_before && relaxation.begin(RELAXED * tolerance, first_evaluation.largest);
  const int corrections = corrector.plan(accuracy_of_first());
  std::vector<Stage> stages = {Stage::SHAPE, Stage::LOOK};
  if (unlocated) stages.insert(stages.begin(), Stage::LOCATE);
  if (relaxes) stages.insert(stages.end(), {Stage::WAIT, Stage::RELAX, Stage::TURN, Stage::LOOK});
  stages.insert(stages.end(), corrections, Stage::CORRECT);
  const Stage shape = shape_after(first_evaluation);
  stages.insert(stages.end(), {Stage::STEP, shape, Stage::LOOK});
  Evaluation now = run(stages, &first_evaluation);
  unlocated = nullptr;
  must_correct = false;
  if (!is_apart || !first_evaluation.exists) return now;
  if (shape == Stage::ADAPT &&
      shape_after(first_evaluation) != shape) {    // a larger step this time
    const double slope = now.slope;
    now = evaluate();
    now.slope = slope;
  }
  return line_search(accept(now, first_evaluation, true, false), first_evaluation, false);
}

/* ---------------------------------------------------------------------- */

PairArrays ForceSolver::arrays()
{
  NearPairs &p = *pairs;
  const ForceBatches &b = *batches;
  return {p.overlap.data(),
          p.stiffening.data(),
          p.side[0].data(),
          p.side[1].data(),
          b.indentation.data(),
          b.compliance.data(),
          b.step.data(),
          p.force.data(),
          residual.data(),
          weight.data(),
          step.data(),
          p.length,
          p.unit(),
          p.past.data(),
          {p.earlier[0].data(), p.earlier[1].data(), p.earlier[2].data()},
          p.earlier[0].data()};
}

/* ----------------------------------------------------------------------
   Both ranks of a pair take the mean of their overlaps, which differ by the
   rounding of ghosts' positions, and of their first forces. Otherwise the
   residuals of both would never vanish together, and the difference of their
   forces would grow from call to call: no residual depends on it.
------------------------------------------------------------------------- */

void ForceSolver::agree()
{
  NearPairs &p = *pairs;
  const int own = batches->contacts, *const side = p.side[0].data() + p.remote;
  double *const overlap = p.overlap.data() + p.remote, *const force = p.force.data() + p.remote;
  // evaluate replaces them
  double *const overlaps = batches->indentation.data(), *const forces = batches->slope.data();
  const int count = p.wall - p.remote;
  for (int c = 0; c < count; ++c) {
    overlaps[side[c]] = overlap[c];
    forces[side[c]] = force[c];
  }
  remote->exchange(side, own, overlaps, forces);
  for (int c = 0; c < count; ++c) {
    overlap[c] = 0.5 * (overlap[c] + overlaps[own + c]);
    force[c] = 0.5 * (force[c] + forces[own + c]);
  }
  if (!p.tilts) return;
  double *const per_distance = p.per_distance.data() + p.remote;
  for (int c = 0; c < count; ++c) overlaps[side[c]] = per_distance[c];
  remote->exchange(side, own, overlaps);
  for (int c = 0; c < count; ++c) per_distance[c] = 0.5 * (per_distance[c] + overlaps[own + c]);
}

// Pairs that two ranks share count half on each.
template <class Sum> double ForceSolver::sum_over_pairs(Sum &&sum) const
{
  return remote->sum(sum(0, pairs->remote) + 0.5 * sum(pairs->remote, pairs->wall) +
                     sum(pairs->wall, pairs->size));
}

/* ----------------------------------------------------------------------
   The dual energy is concave along the step. A step that is much too long
   has a negative slope at its end, and the search looks for the place where
   the slope vanishes. What single precision leaves of a small step is far
   below the tolerance.
------------------------------------------------------------------------- */

ForceSolver::Evaluation ForceSolver::line_search(Evaluation now, const Evaluation &from,
                                                 bool turned)
{
  constexpr double BETTER = 0.5, NO_WORSE = 2.0, SMALL_SLOPE = 0.5;
  const double imbalance = from.worst(), slope = now.slope;
  if (!(slope > 0.0)) return now;    // no step
  double low = 0.0, low_slope = slope, high = 1.0, at = 1.0;
  for (;;) {
    const double good = std::max((turned ? NO_WORSE : BETTER) * imbalance, tolerance * now.largest);
    if (now.exists && now.forces <= good) return now;
    corrector.doubt_bounds();
    double here = -std::numeric_limits<double>::infinity();
    if (now.exists)
      here = sum_over_pairs(
                 [this](int a, int z) { return kernels.dot(residual.data(), step.data(), a, z); }) *
             pairs->length * pairs->unit();
    if (here >= -SMALL_SLOPE * slope && (at == 1.0 || here <= SMALL_SLOPE * slope)) return now;
    if (evaluations >= max_evaluations) return now;

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
    move(at, next);
    at = next;
    now = evaluate();
  }
}

double ForceSolver::memory_usage() const
{
  return bytes_of(residual, weight, step) + tilts.bytes() + blocks.bytes() + relaxation.bytes() +
         bytes_of(of_blocks);
}
