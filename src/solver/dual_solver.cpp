#include "solver/dual_solver.h"

#include "styles/all_ranks.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace deformable {

static Tuning with_environment(const Tuning &tuned, LAMMPS *lmp)
{
  try {
    return tuned.changed_by(environment(lmp, "DEFORMABLE_TUNING"));
  } catch (const std::invalid_argument &wrong) {
    lmp->error->all(FLERR, wrong.what());
  }
}

DualSolver::DualSolver(LAMMPS *lmp, const ForceKernels &kernels, bool in_space, bool curved,
                       double bulge_per_overlap, double most_bulge, double tolerance,
                       int max_evaluations, const Tuning &tuned)
    : Pointers(lmp),
      tolerance(tolerance),
      kernels(kernels),
      tuning(with_environment(tuned, lmp)),
      list(lmp, kernels, tuning, in_space, curved, bulge_per_overlap, most_bulge),
      max_evaluations(max_evaluations),
      linear(kernels, tuning)
{
  if (curved) lines = std::make_unique<CurvedLines>(kernels);
}

const char *Summary::why() const
{
  switch (termination) {
    case Termination::BALANCED: return "";
    case Termination::STUCK:
      return "Further evaluations do not reduce that, as where particles are beyond the model";
    case Termination::NO_SHAPE: return "Some particle has no shape under the forces on it";
    case Termination::OUT_OF_EVALUATIONS: return "Allow more evaluations, or a larger tolerance";
  }
  return "";
}

void DualSolver::warn_unbalanced(const char *style)
{
  if (are_balanced || warned_unbalanced || is_meaningless()) return;
  warned_unbalanced = true;
  if (comm->me == 0)
    error->warning(FLERR,
                   "Contacts are not balanced: after {} evaluations forces are off by up to {:.2g} "
                   "of the largest, with a tolerance of {:.2g}. {} (pair_style {} balance)",
                   summary.evaluations, summary.imbalance, tolerance, summary.why(), style);
}

bool DualSolver::is_meaningless() const
{
  constexpr double MOST = 0.1;
  return !are_balanced && summary.imbalance > MOST && !minimizing();
}

void DualSolver::check_balance(const char *style) const
{
  if (is_meaningless())
    error->all(FLERR,
               "Contacts are not balanced: after {} evaluations forces are off by {:.2g} of the "
               "largest. {}. Begin with 'minimize', or compress less (pair_style {} balance)",
               summary.evaluations, summary.imbalance, summary.why(), style);
}

/* ----------------------------------------------------------------------
   A force call. Outlines may bulge so far that the list of near pairs is not
   sufficient: then pairs are found again. Films that come or go change the
   forces of others, which may let others come or go.
------------------------------------------------------------------------- */

bool DualSolver::solve(const Particles &p, const Push &push)
{
  constexpr int MOST_LISTS = 20, MOST_CHANGES = 100;
  const bool adhesion_begins = p.films && !list.pairs.adhesive;    // an adhesion has grown from 0
  if (!find_pairs(p)) return false;

  predict();
  if (films) films->begin_call();
  const bool moves = update->whichflag == 1 && !update->setupflag;
  double before = 0.0, part = 1.0;
  int changes = 0;
  for (int lists = 0;; ++lists) {
    are_balanced = balance(p);
    if (!has_room()) return false;
    find_bulges(p);
    bool refused = p.refusals->any_here();
    const bool sufficient = list.is_sufficient_after(p, refused);
    if (refused) return false;
    if (!sufficient && lists < MOST_LISTS) {
      remember();
      list.build(p, false);
      arrange(p, false);
      list.locate(p);
      continue;
    }
    // forces that do not balance may be those of films that should have gone
    if (films && changes < MOST_CHANGES && films->would_change(are_balanced)) {
      if (changes++ == 0) {
        before = total_energy();
        // In a run a pair that attaches or lets go in this step pushes with the mean of its forces before and after: energy plus
        // lost energy is then constant to second order in the time step.
        if (moves) push(0, list.pairs.size, part = 0.5, false);
      }
      films->change(are_balanced);
      list.store_films(p);    // for lists that are made anew in this call, too
      begin_again();
      continue;
    }
    break;
  }
  warn(p, changes > 0);
  lost = changes > 0 ? before - total_energy() : 0.0;
  if (films && (p.new_list || adhesion_begins)) list.store_films(p);
  finish(push, part);
  if (is_meaningless()) forget();
  return true;
}

bool DualSolver::find_pairs(const Particles &p)
{
  if (p.new_list || (p.films && !list.pairs.adhesive)) {
    list.build(p, p.new_list);
    arrange(p, p.new_list);
  } else if (p.radii_vary || p.new_material || p.materials->vary()) {
    set_material(p, false);
  }
  bool refused = locate(p);
  if (p.new_list) {
    refused = list.remote_sides.largest(refused) > 0.0;
  } else if (!list.is_sufficient(p, refused) && !refused) {
    list.build(p, false);
    arrange(p, false);
    refused = list.remote_sides.largest(locate(p)) > 0.0;
  }
  return !refused;
}

// Whether this rank goes no further.
bool DualSolver::locate(const Particles &p)
{
  wrong = list.locate(p);
  return wrong >= 0 || p.refusals->any_here();
}

// Contacts are new.
void DualSolver::arrange(const Particles &p, bool new_list)
{
  NearPairs &pairs = list.pairs;
  batches.arrange(list.order(*p.list), p.list->inum, atom->nlocal, pairs, atom->tag,
                  has_own_compliances());
  list.remote_sides.arrange(pairs.side[0].data() + pairs.remote, batches.contacts);
  blocks.arrange(batches, pairs);
  relaxation.arrange(batches, pairs);
  set_material(p, true);
  batches.scale = pairs.scale;
  batches.length = pairs.length;
  // nothing happens in the last one, which stays zero
  for (LargeVector<float> *v : {&residual, &weight, &step}) v->assign(pairs.size + 1, 0.0F);
  pairs_of_all = 1.0 + sum_over_pairs([](int begin, int end) { return end - begin; });
  if (lines) lines->arrange(batches, pairs, list.remote_sides);
  if (new_list) linear.invalidate_bounds();
}

double DualSolver::total_energy() const
{
  double sum = energy();
  for (int k = 0; k < list.pairs.size; ++k) sum += list.pairs.part(k) * energy_left(k);
  return list.remote_sides.sum(sum);
}

bool DualSolver::minimizing() const
{
  return update->whichflag == 2;
}

// Minimizers go from line to line, but for the damped dynamics of fire and quickmin.
bool DualSolver::searches_lines() const
{
  return minimizing() && !utils::strmatch(update->minimize_style, "^fire") &&
         !utils::strmatch(update->minimize_style, "^quickmin");
}

/* ----------------------------------------------------------------------
   Predict: a polynomial through the last calls at successive time steps, at
   most a cubic. The error of a cubic is even in time, so what corrections
   leave of it neither heats nor cools. With a quadratic energies drift. In
   damped dynamics velocities jump, and a quadratic is as good. Along lines
   there are no velocities, and forces begin with the last ones. Behind a kink,
   which the force of a contact has that opened or closed, a cubic goes astray:
   there a straight line is taken.
------------------------------------------------------------------------- */

void DualSolver::predict()
{
  NearPairs &p = list.pairs;
  const bigint now = update->ntimestep;
  successive_calls =
      now == last_step + 1 && !searches_lines() ? std::min(successive_calls + 1, CUBIC) : 0;
  last_step = now;
  const double slope = successive_calls >= LINEAR ? 1.0 : 0.0,
               bend = successive_calls >= QUADRATIC ? 1.0 : 0.0;
  const bool is_cubic = successive_calls == CUBIC && !minimizing() && tuning.cubic != 0.0;
  // third differences of forces that are no kink; after forces that no particle could bear each one counts
  const double small = limit(planned_from) / p.unit();
  const double smooth = std::isfinite(small) ? tuning.smooth * small : 0.0;
  batches.scale = p.scale;
  batches.length = p.length;
  Extrapolation by = {slope,
                      bend,
                      is_cubic ? 1.0 : 0.0,
                      is_cubic ? smooth : std::numeric_limits<double>::infinity(),
                      p.unit(),
                      0.0};
  kernels.extrapolate(p.past[FORCE].arrays(), by, p.least.empty() ? nullptr : p.least.data(),
                      p.force.data(), 0, p.size);
  if (lines) {
    by.unit = 1.0;
    by.least = -1.0;
    if (is_cubic) by.smooth = tuning.smooth * tolerance;
    lines->predict(by);
  }
  summary.evaluations = 0;
  problems = 0;
  is_corrected = false;
  allowed = max_evaluations;
}

// Another solution of this call begins with the last forces. It is at the same time: the next call continues its forces by the
// changes of the first one.
void DualSolver::take_past()
{
  const PairArrays a = arrays();
  const LargeVector<double> &past = list.pairs.past[FORCE].last;
  for (int k = 0; k < list.pairs.size; ++k)
    a.force[k] = past[k] == UNKNOWN ? 0.0 : std::max(past[k], least_force<double>(a, k));
  if (lines) lines->take_past();
  for (int kind = 0; kind < list.pairs.kinds(); ++kind)
    changes[kind] = list.pairs.past[kind].earlier[0];
  --summary.evaluations;    // the next one repeats the last one, and does not count
}

/* ----------------------------------------------------------------------
   The overlaps of both ranks of a pair differ by the rounding of ghosts'
   positions, and their first forces by their pasts: both take the mean.
   Otherwise the residuals of both would never vanish together, and the
   difference of their forces would grow from call to call: no residual
   depends on it.
------------------------------------------------------------------------- */

void DualSolver::average_over_ranks()
{
  if (comm->nprocs == 1) return;
  NearPairs &p = list.pairs;
  const int own = batches.contacts, *const side = p.side[0].data() + p.remote;
  const int count = p.wall - p.remote;
  // an evaluation replaces them
  double *const here = batches.indentation.data(), *const there = here + own;
  const auto take_means = [&](LargeVector<double> &of_pairs) {
    double *const value = of_pairs.data() + p.remote;
    for (int c = 0; c < count; ++c) here[side[c]] = value[c];
    list.remote_sides.exchange(here);
    for (int c = 0; c < count; ++c) value[c] = 0.5 * (value[c] + there[c]);
  };
  take_means(p.overlap);
  take_means(p.force);
  if (p.curved) take_means(p.per_distance);
}

/* ----------------------------------------------------------------------
   The loop. Pairs know their overlaps. May be called again in the same call,
   with other pairs, after `remember`. Returns whether forces are balanced.
------------------------------------------------------------------------- */

bool DualSolver::balance(const Particles &p)
{
  if (problems++ > 0) take_past();
  average_over_ranks();
  if (lines) lines->begin();
  const bool is_planned = may_plan();
  Evaluation now = is_planned ? evaluate_and_correct() : evaluate();
  if (problems == 1 && !is_planned) planned_from = now;

  // Beyond confluence there may be no balance, and lines may lead astray.
  enum { PREDICTED, ANEW, STRAIGHT, LET_GO, HELD };
  constexpr double FAR = 1e-3;    // from balance, over the largest force
  int attempt = PREDICTED;
  double halved = std::numeric_limits<double>::infinity();
  int since = summary.evaluations;
  is_careful = false;
  // From no forces, even beyond maxeval; with lines that may turn, with straight ones, and from these with lines that may turn again.
  const auto begin = [&](int next) {
    attempt = next;
    halved = std::numeric_limits<double>::infinity();
    since = summary.evaluations;
    is_careful = false;
    if (attempt != LET_GO) std::fill(list.pairs.force.begin(), list.pairs.force.end(), 0.0);
    linear.invalidate_bounds();
    if (attempt == LET_GO) {
      lines->let_go();
    } else if (lines) {
      locate(p);    // lines may be nowhere
      average_over_ranks();
      lines->straighten(attempt != ANEW);
    }
    if (attempt != ANEW) allowed = summary.evaluations + max_evaluations;
    now = evaluate();
  };
  for (;;) {
    if (!now.exists && (attempt == PREDICTED || (lines && (attempt == ANEW || attempt == LET_GO))))
      begin(attempt + 1);
    if (is_balanced(now)) {
      summary.termination = Termination::BALANCED;
      if (attempt != STRAIGHT) break;
      begin(LET_GO);
      continue;
    }
    const bool is_far = now.worst() > FAR * now.force;
    if (!may_go_on()) {
      summary.termination = Termination::OUT_OF_EVALUATIONS;
      if (attempt != LET_GO || !is_far) break;
      begin(HELD);
      continue;
    }
    if (now.worst() < 0.5 * halved) {
      halved = now.worst();
      since = summary.evaluations;
    } else if (!is_careful && summary.evaluations > since + tuning.astray) {
      is_careful = true;
      since = summary.evaluations;
    } else if (summary.evaluations > since + tuning.stuck) {
      summary.termination = Termination::STUCK;
      are_balanced = false;
      const bool may_turn = lines && !lines->held;
      if (may_turn && attempt == LET_GO && is_far)
        begin(HELD);
      else if (may_turn && attempt != LET_GO && !has_room())
        begin(STRAIGHT);
      else if (attempt == PREDICTED && is_far)
        begin(ANEW);
      else
        break;
      continue;
    }
    if (!std::isfinite(now.force)) break;
    now = correct(now);
  }
  if (!now.exists) summary.termination = Termination::NO_SHAPE;
  if (lines) lines->count_limited();
  shapes_exist = now.exists;
  summary.imbalance = !now.exists ? 1.0 : now.worst() > 0.0 ? now.worst() / now.force : 0.0;
  return now.exists && now.worst() <= limit(now);
}

// In a minimization each call makes a correction at least, so that contact forces converge with the total forces.
bool DualSolver::is_balanced(const Evaluation &now) const
{
  return now.exists && now.worst() <= limit(now) &&
         (!minimizing() || is_corrected || now.imbalance == 0.0);
}

// Whether the last calls tell how far to correct: not in minimizations.
bool DualSolver::may_plan() const
{
  return tuning.planned != 0.0 && problems == 1 && successive_calls >= QUADRATIC && !minimizing() &&
         linear.knows_bounds() && planned_from.exists && planned_from.norm2 > 0.0 &&
         planned_from.force > 0.0 && (!lines || lines_answer(planned_from));
}

// Lines turn with the forces where these are close to balance.
bool DualSolver::lines_move(const Evaluation &from) const
{
  return lines && !lines->held && from.imbalance <= tuning.close * from.force;
}

bool DualSolver::lines_answer(const Evaluation &from) const
{
  return lines_move(from) && lines->answers && linear.knows_bounds() && from.norm2 > 0.0;
}

/* ----------------------------------------------------------------------
   In motion each call needs about the same correction as the last one: it is
   one more sweep if nobody waits for the imbalance before it.
------------------------------------------------------------------------- */

Evaluation DualSolver::evaluate_and_correct()
{
  is_corrected = true;
  Steps steps;
  add_shape(steps, Stage::SHAPE);
  if (!lines && relaxation.begin(tuning, tolerance, planned_from.force)) {
    std::fill(step.begin(), step.end(), 0.0F);
    steps.insert(steps.end(), {Stage::WAIT, Stage::RELAX});
    add_shape(steps, Stage::RESHAPE);
  }
  if (lines) {
    const Steps correction = with_lines(accuracy(planned_from));
    steps.insert(steps.end(), correction.begin(), correction.end());
    const Evaluation now = run(steps, &planned_from);
    return planned_from.exists ? accept_with_lines(now, planned_from) : now;
  }
  add_solution(steps, linear.plan(accuracy(planned_from)));
  const Stage shape = shape_after(planned_from);
  steps.push_back(Stage::STEP);
  add_shape(steps, shape);
  Evaluation now = run(steps, &planned_from);
  if (!planned_from.exists) return now;
  if (shape == Stage::ADAPT && shape_after(planned_from) != shape) {    // larger than planned
    const double slope = now.slope;
    now = evaluate();
    now.slope = slope;
  }
  return line_search(accept(now, planned_from, true, true), BETTER * planned_from.imbalance);
}

Evaluation DualSolver::correct(const Evaluation &from)
{
  is_corrected = true;
  if (lines_answer(from)) return accept_with_lines(run(with_lines(accuracy(from))), from);
  const bool moves = lines_move(from);
  int corrections = 0;
  if (from.norm2 > 0.0)
    corrections = linear.begin(batches, list.remote_sides, arrays(), from.norm2, accuracy(from));
  else    // only particles without force touch
    std::fill(batches.step.begin(), batches.step.end(), 0.0F);
  Steps steps;
  add_solution(steps, corrections);
  steps.push_back(Stage::STEP);
  const bool follows = moves && (films || lines->answers);
  if (!follows) add_shape(steps, shape_after(from));
  const Evaluation stepped = accept(run(steps), from, corrections > 0, !follows);
  if (!moves) return line_search(stepped, is_careful ? 0.0 : BETTER * from.imbalance);
  lines->adapt(follows ? from.line_imbalance : stepped.line_imbalance);
  if (!follows) lines->forget_answers();    // by outlines as they are
  run(follows ? Steps{Stage::FOLLOW_STEP, Stage::TURN} : Steps{Stage::TURN});
  Evaluation now = evaluate();
  now.slope = stepped.slope;
  lines->answers &= now.exists && now.worst() <= std::max(BETTER * from.worst(), limit(now));
  // between films lines alone seldom make it worse: iterations may diverge slowly
  if (films && now.imbalance > from.imbalance) linear.invalidate_bounds();
  return line_search(now, NO_WORSE * std::max(from.worst(), stepped.worst()));
}

/* ----------------------------------------------------------------------
   A correction with lines that answer: all in one sweep. Small ones need one
   solution, others a second one, between films also a third one, for what lines
   have left of those before. Lines undo up to `of_answers` of a solution with C
   at fixed curvature, and films under tension add up to `of_films` to it: steps
   are multiplied as in Chebyshev's iteration between these bounds.
------------------------------------------------------------------------- */

DualSolver::Steps DualSolver::with_lines(double accuracy)
{
  const int solutions = accuracy >= tuning.coarse ? 1 : films ? 3 : 2;
  const int iterations = linear.plan(std::pow(accuracy, 1.0 / solutions));
  const double low = films ? 1.0 - tuning.of_films : 1.0, high = 1.0 + tuning.of_answers;
  Steps steps;
  for (int solution = 0; solution < solutions; ++solution) {
    if (solution > 0) steps.insert(steps.end(), {Stage::FOLLOW, Stage::ANSWER});
    steps.push_back(Stage::RESPOND);
    steps.back().goes_on = solution > 0;
    const double root = std::cos(PI * (solution + 0.5) / solutions);
    add_solution(steps, iterations, 2.0 / (high + low + (high - low) * root), true);
  }
  steps.insert(steps.end(),
               {Stage::STEP, Stage::FOLLOW_STEP, Stage::TURN, Stage::SHAPE, Stage::RESIDUAL});
  return steps;
}

// The step is along no line of the dual energy: only the imbalance tells whether it leads astray, or slowly to nowhere. Then lines
// take steps for themselves, which may be shorter.
Evaluation DualSolver::accept_with_lines(Evaluation now, const Evaluation &from)
{
  lines->answers = now.exists && now.worst() <= std::max(BETTER * from.worst(), limit(now));
  if (lines->answers || (now.exists && now.worst() <= NO_WORSE * from.worst())) return now;
  linear.invalidate_bounds();
  move(1.0, 0.0);
  return evaluate();
}

/* ----------------------------------------------------------------------
   Newton's method squares its relative error in each step: its direction need
   not be better than that, nor much better than the tolerance. The margin is
   for the energy: what is left acts in each of millions of steps. Lines that
   follow bring back about `of_lines` of a correction.
------------------------------------------------------------------------- */

double DualSolver::accuracy(const Evaluation &from) const
{
  // the weighted root mean square of r, times the mean weight
  const double typical = std::sqrt(from.norm2 * from.weights) / pairs_of_all * list.pairs.unit();
  // facets that move are left out, too; but few conjugate gradients do not find the bounds of the spectrum
  const bool leaves_more = lines || (has_facets() && linear.knows_bounds());
  const double most =
      std::max(tuning.of_square * typical / from.force, leaves_more ? tuning.of_lines : 0.0);
  return std::min(tuning.coarse, std::max(tuning.of_tolerance * limit(from) / from.worst(), most));
}

// New shapes from small steps have the rounding of single precision, a part of the step: 6e-4 of the tolerance at most.
// They know straight lines only.
DualSolver::Stage DualSolver::shape_after(const Evaluation &from) const
{
  return !lines && from.imbalance <= tuning.small_step * limit(from) ? Stage::ADAPT : Stage::SHAPE;
}

/* ----------------------------------------------------------------------
   Accept: the state after a step; where that leads astray, the one before it,
   or one after a step of each pair alone.
------------------------------------------------------------------------- */

Evaluation DualSolver::accept(Evaluation now, const Evaluation &from, bool iterated,
                              bool has_shapes)
{
  if (iterated && !linear.is_sound(now.slope, from.norm2 * unit_of_energy())) {
    linear.invalidate_bounds();
    move(1.0, 0.0);
    return evaluate();
  }
  if (now.slope > 0.0) return now;
  // single precision is not enough
  move(1.0, 0.0);
  if (has_shapes) evaluate();
  const double slope = step_alone();
  if (has_shapes) now = evaluate();
  now.slope = slope;
  return now;
}

/* ----------------------------------------------------------------------
   The dual energy is concave along the step. A step that is much too long
   has a negative slope at its end, and the search looks for the place where
   the slope vanishes. What single precision leaves of a small step is far
   below the tolerance.
------------------------------------------------------------------------- */

Evaluation DualSolver::line_search(Evaluation now, double enough)
{
  const double small_slope = is_careful ? 0.1 : 0.5;
  const double slope = now.slope;
  if (!(slope > 0.0)) return now;    // no step
  double low = 0.0, low_slope = slope, high = 1.0, at = 1.0;
  for (;;) {
    if (now.exists && now.imbalance <= std::max(enough, limit(now))) return now;
    linear.invalidate_bounds();
    const double here = now.exists ? slope_at_end() : -std::numeric_limits<double>::infinity();
    if (here >= -small_slope * slope && (at == 1.0 || here <= small_slope * slope)) return now;
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
    move(at, next);
    at = next;
    now = evaluate();
  }
}

// Along the last step, from this part of it to that one. From the smaller one of the force before and its change: single
// precision has only that precisely enough.
void DualSolver::move(double from, double to)
{
  const PairArrays a = arrays();
  for (int k = 0; k < list.pairs.size; ++k) {
    const double before = a.before[k], change = a.step[k], force = a.force[k];
    const bool is_small = std::fabs(change) < std::fabs(before);
    const double moved = is_small    ? force + (to - from) * change * a.unit
                         : to == 0.0 ? before * a.unit
                                     : (before + to * change) * a.unit;
    a.force[k] = std::max(moved, least_force<double>(a, k));
  }
}

double DualSolver::slope_at_end()
{
  return unit_of_energy() * sum_over_pairs([this](int begin, int end) {
           return kernels.dot(residual.data(), step.data(), begin, end);
         });
}

// A step of each pair for itself, instead of Newton's method. Returns the slope where it begins.
double DualSolver::step_alone()
{
  return sum_over_pairs(
      [this](int begin, int end) { return kernels.take_step(arrays(), true, begin, end); });
}

/* ----------------------------------------------------------------------
   Remember
------------------------------------------------------------------------- */

void DualSolver::remember()
{
  kernels.remember(arrays(), 0, list.pairs.size);
  remember_lines();
}

// After the forces.
void DualSolver::remember_lines()
{
  if (lines) lines->remember();
  if (problems > 1)
    for (int kind = 0; kind < list.pairs.kinds(); ++kind)
      list.pairs.past[kind].earlier[0] = changes[kind];
}

// The next solution of this call is another problem: it may take as many evaluations.
void DualSolver::begin_again()
{
  remember();
  allowed = summary.evaluations + max_evaluations;
}

void DualSolver::forget()
{
  NearPairs &p = list.pairs;
  const auto fill = [](auto value, auto &...v) { (std::fill(v.begin(), v.end(), value), ...); };
  for (NearPairs::Past &past : p.past) {
    fill(UNKNOWN, past.last);
    fill(0.0F, past.earlier[0], past.earlier[1], past.earlier[2]);
  }
}

// The forces are past ones, outlines have slopes, and pairs push.
void DualSolver::finish(const Push &push, double part)
{
  RingBatches here = batches.arrays();
  const auto work = [&](int block, int stage) {
    blocks.choose(here, block);
    if (stage == 1 && !lines) find_slopes(here);    // those have slopes
    blocks.for_pairs(block, [&](int begin, int end, double) {
      if (stage == 2)
        push(begin, end, part, true);
      else
        kernels.remember(arrays(), begin, end);
    });
  };
  blocks.run(2, work, [](int) {});
  remember_lines();
}

/* ----------------------------------------------------------------------
   Stages: what happens to particles and pairs, block by block.
------------------------------------------------------------------------- */

PairArrays DualSolver::arrays()
{
  NearPairs &p = list.pairs;
  PairArrays a;
  a.overlap = p.overlap.data();
  a.stiffening = p.stiffening.data();
  a.first = p.side[0].data();
  a.second = p.side[1].data();
  a.indentation = batches.indentation.data();
  a.compliance = batches.compliance.data();
  a.correction = batches.step.data();
  a.force = p.force.data();
  a.residual = residual.data();
  a.weight = weight.data();
  a.step = step.data();
  a.length = p.length;
  a.unit = p.unit();
  a.past = p.past[FORCE].arrays();
  a.before = a.past.earlier[0];
  a.least = p.least.empty() ? nullptr : p.least.data();
  return a;
}

// Shapes, and then the residuals.
void DualSolver::add_shape(Steps &steps, Stage shape) const
{
  steps.push_back(shape);
  if (has_facets()) steps.push_back(Stage::TILT);
  steps.push_back(Stage::RESIDUAL);
}

void DualSolver::add_solution(Steps &steps, int iterations, double gain, bool goes_on)
{
  for (int k = 1; k <= iterations; ++k) {
    steps.push_back(Stage::CORRECT);
    Step &step = steps.back();
    step.iteration = k;
    step.last = iterations;
    step.gain = gain;
    step.goes_on = goes_on;
  }
}

Evaluation DualSolver::evaluate()
{
  Steps steps;
  add_shape(steps, Stage::SHAPE);
  return run(steps);
}

// Returns what the last stage RESIDUAL has found in all blocks; in `before`, unless null, what the last one before the
// corrections has.
Evaluation DualSolver::run(const Steps &steps, Evaluation *before)
{
  const RingBatches rings = batches.arrays();
  RingBatches here = rings;    // of the block that has its turn
  const auto corrects = [](const Step &step) {
    return step.stage == Stage::CORRECT || step.stage == Stage::RESPOND;
  };
  const int first =    // of them, from 0; steps count from 1
      static_cast<int>(std::find_if(steps.begin(), steps.end(), corrects) - steps.begin());
  of_blocks.assign((before ? 2 : 1) * blocks.count(), {});
  bool exist = true;
  blocks.run(
      static_cast<int>(steps.size()),
      [&](int block, int number) {
        const bool is_before = before && number <= first;
        blocks.choose(here, block);
        work(steps[number - 1], block, here, of_blocks[is_before ? blocks.count() + block : block],
             exist);
      },
      [&](int number) {
        const Step &done = steps[number - 1];
        const bool shaped = done.stage == Stage::SHAPE || done.stage == Stage::ADAPT;
        if (corrects(done) && (done.stage == Stage::RESPOND || done.iteration < done.last)) {
          list.remote_sides.exchange(LinearSolver::products(rings, done.iteration));
        } else if (shaped && has_facets()) {
          exchange_facets();
        } else if (shaped || done.stage == Stage::TILT) {
          list.remote_sides.exchange(batches.indentation.data(), batches.compliance.data());
          if (lines) lines->exchange_outlines();
        } else if (done.stage == Stage::FOLLOW || done.stage == Stage::FOLLOW_STEP) {
          lines->exchange_answers();
        }
      });
  if (steps.back().stage == Stage::RESIDUAL) ++summary.evaluations;
  if (before) {
    ++summary.evaluations;
    *before = sum_up(blocks.count(), true);
  }
  return sum_up(0, exist);
}

void DualSolver::work(const Step &now, int block, RingBatches &here, OfBlock &found, bool &exist)
{
  const PairArrays loop = arrays();
  switch (now.stage) {
    case Stage::SHAPE: exist &= shape(here); break;
    case Stage::ADAPT: exist &= adapt(here, step.data(), loop.unit); break;
    case Stage::TILT: turn_facets(here); break;
    case Stage::RESIDUAL:
      blocks.for_pairs(block, [&](int begin, int end, double part) {
        found.add(kernels.find_residuals(loop, begin, end), part);
        if (lines) found.line = std::max(found.line, lines->find(loop, begin, end));
      });
      if (films) found.line = std::max(found.line, films->tension_imbalance(here));
      break;
    case Stage::WAIT: break;
    case Stage::RELAX:
      found = {};
      relaxation.relax(block, kernels, blocks, list.pairs, batches, loop);
      break;
    case Stage::RESHAPE:
      relaxation.for_changed(here, [&](const RingBatches &changed) {
        exist &= reshape(changed, step.data(), loop.unit);
      });
      break;
    case Stage::CORRECT:
      linear.iterate(here, loop, now.iteration, now.last,
                     now.goes_on ? lines->arrays().left : nullptr, now.gain);
      break;
    case Stage::FOLLOW: kernels.follow(here, lines->arrays(), nullptr); break;
    case Stage::FOLLOW_STEP: kernels.follow(here, lines->arrays(), step.data()); break;
    case Stage::ANSWER:
      blocks.for_pairs(block,
                       [&](int begin, int end, double) { lines->find_answers(loop, begin, end); });
      break;
    case Stage::RESPOND: kernels.respond(here, lines->arrays(), !now.goes_on); break;
    case Stage::TURN:
      blocks.for_pairs(block, [&](int begin, int end, double) { lines->settle(loop, begin, end); });
      if (films) films->follow_tensions(here);
      break;
    case Stage::STEP:
      blocks.for_pairs(block, [&](int begin, int end, double part) {
        found.slope += part * kernels.take_step(loop, false, begin, end);
      });
  }
}

void DualSolver::OfBlock::add(const Residuals &r, double part)
{
  error = std::max(error, r.error);
  force = std::max(force, r.force);
  left = std::max(left, r.left);
  norm2 += part * r.norm2;
  weights += part * r.weights;
}

// What the blocks have found, from this place on.
Evaluation DualSolver::sum_up(int first, bool exist) const
{
  double largest[5] = {0.0, 0.0, 0.0, exist ? 0.0 : 1.0, 0.0}, sum[3] = {};
  for (int block = first; block < first + blocks.count(); ++block) {
    const OfBlock &found = of_blocks[block];
    largest[0] = std::max(largest[0], found.error);
    largest[1] = std::max(largest[1], found.force);
    largest[2] = std::max(largest[2], found.left);
    largest[4] = std::max(largest[4], found.line);
    sum[0] += found.norm2;
    sum[1] += found.weights;
    sum[2] += found.slope;
  }
  if (comm->nprocs > 1) {
    MPI_Allreduce(MPI_IN_PLACE, largest, 5, MPI_DOUBLE, MPI_MAX, world);
    MPI_Allreduce(MPI_IN_PLACE, sum, 3, MPI_DOUBLE, MPI_SUM, world);
  }
  // Overlaps are not known better than this.
  constexpr double ROUNDING = 8.0 * std::numeric_limits<double>::epsilon();
  Evaluation now;
  now.imbalance = largest[2] <= ROUNDING ? 0.0 : largest[0];
  now.line_imbalance = largest[4];
  now.force = std::max(largest[1], std::isinf(largest[2]) ? largest[2] : 0.0);
  now.exists = largest[3] == 0.0 && std::isfinite(now.force);
  now.norm2 = sum[0];
  now.weights = sum[1];
  now.slope = sum[2];
  return now;
}

double DualSolver::memory_usage() const
{
  return list.memory_usage() + batches.bytes() + blocks.bytes() + relaxation.bytes() +
         bytes_of(residual, weight, step, of_blocks, changes[0], changes[1], changes[2]) +
         (lines ? lines->bytes() : 0.0) + (films ? films->bytes() : 0.0);
}

}    // namespace deformable
