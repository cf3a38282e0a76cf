#include "solver/dual_solver.h"

#include "styles/all_ranks.h"

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "modify.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace deformable {

// What LargestAndSums has of an evaluation.
enum { ERROR, LARGEST_FORCE, LEFT, NO_SHAPE, OF_LINE };
enum { NORM2, WEIGHTS, SLOPE };

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
      linear(kernels, tuning),
      is_traced(!environment(lmp, "DEFORMABLE_TRACE").empty())
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

bool DualSolver::solve(const ForceCall &call, const Push &push)
{
  constexpr int MOST_LISTS = 20, MOST_CHANGES = 100;
  const bool adhesion_begins =
      call.films && !list.pairs.adhesive;    // an adhesion has grown from 0
  if (!find_pairs(call)) return false;

  predict();
  if (films) films->begin_call();
  const bool moves = update->whichflag == 1 && !update->setupflag;
  double energy_before = 0.0, part = 1.0;
  int changes = 0, lists = 0;
  for (;;) {
    are_balanced = balance(call);
    if (!has_room()) return false;
    find_bulges(call);
    bool refused = call.refusals->any_here();
    const bool sufficient = list.is_sufficient_after(call, refused);
    if (refused) return false;
    if (!sufficient && lists++ < MOST_LISTS) {
      remember();
      list.build(call, false);
      arrange(call, false);
      list.locate(call, threads);    // of the same positions: none is refused
      continue;
    }
    // Only balanced forces let pairs attach. Others may be those of films that should have gone.
    if (films && changes < MOST_CHANGES && films->would_change(are_balanced)) {
      if (changes++ == 0) {
        energy_before = total_energy();
        // In a run a pair that attaches or lets go in this step pushes with the mean of its forces before and after: energy plus
        // lost energy is then constant to second order in the time step.
        if (moves) push_all(call, push, part = 0.5, false);
      }
      films->change(are_balanced);
      list.store_films(call);    // for lists that are made anew in this call, too
      begin_again();
      continue;
    }
    break;
  }
  warn(call, changes > 0);
  summary.lost_energy = changes > 0 ? energy_before - total_energy() : 0.0;
  if (films && (call.new_list || adhesion_begins)) list.store_films(call);
  finish(call, push, part);
  if (is_meaningless()) forget();
  return true;
}

bool DualSolver::find_pairs(const ForceCall &call)
{
  if (call.new_list || (call.films && !list.pairs.adhesive)) {
    list.build(call, call.new_list);
    arrange(call, call.new_list);
  } else if (call.radii_vary || call.new_material || call.materials->vary()) {
    set_material(call, false);
  }
  bool refused = locate(call);
  if (call.new_list) {
    refused = list.remote_sides.largest(refused) > 0.0;
  } else if (!list.is_sufficient(call, threads, refused) && !refused) {
    list.build(call, false);
    arrange(call, false);
    refused = list.remote_sides.largest(locate(call)) > 0.0;
  }
  return !refused;
}

// Whether this rank goes no further.
bool DualSolver::locate(const ForceCall &call)
{
  refused = list.locate(call, threads);
  return refused >= 0 || call.refusals->any_here();
}

void DualSolver::choose_threads()
{
  const int wanted = tuning.threads > 0.0 ? static_cast<int>(tuning.threads)
                     : wanted_threads > 0 ? wanted_threads
                                          : comm->nthreads;
  if (wanted == last_wanted) return;
  last_wanted = wanted;
  int number = wanted;
  if (number > 1 && tuning.threads == 0.0)
    number = std::clamp(Threads::usable_cores() / ranks_of_machine(world), 1, wanted);
  threads.set_count(number);
  if (comm->me != 0 || wanted == 1) return;
  utils::logmesg(lmp, "  {} thread(s) share the balance of contacts\n", number);
  // those of OpenMP spin between its loops, and do not leave the cores to others
  const char *const waits = std::getenv("OMP_WAIT_POLICY");
  if (number > 1 && modify->get_fix_by_id("package_omp") &&
      (!waits || utils::lowercase(waits) != "passive"))
    error->warning(FLERR,
                   "Threads of 'package omp' spin while those of pair_style deformable/* work: "
                   "set the environment variable OMP_WAIT_POLICY=passive, or use the "
                   "keyword 'threads' in place of the package");
}

// Contacts are new.
void DualSolver::arrange(const ForceCall &call, bool new_list)
{
  choose_threads();
  NearPairs &pairs = list.pairs;
  batches.threads = threads.count();
  batches.arrange(list.order(*call.list), call.list->inum, atom->nlocal, pairs, atom->tag,
                  has_own_compliances());
  list.remote_sides.arrange(pairs.side[0].data() + pairs.remote, batches.contacts);
  blocks.arrange(batches, pairs);
  relaxation.arrange(batches, pairs);
  set_material(call, true);
  batches.scale = pairs.scale;
  batches.length = pairs.length;
  // nothing happens in the last one, which stays zero
  for (LargeVector<float> *v : {&residual, &weight, &before, &step})
    v->assign(pairs.size + 1, 0.0F);
  find_images();
  pairs_of_all = 1.0 + sum_over_pairs([](int begin, int end) { return end - begin; });
  if (lines)
    lines->arrange(batches, pairs, list.remote_sides);
  else if (films)
    films->arrange(batches, pairs, list.remote_sides);
  if (new_list) linear.invalidate_bounds();
}

void DualSolver::find_adhesions(const ForceCall &call)
{
  NearPairs &p = list.pairs;
  for (int k = 0; k < p.size; ++k)
    p.adhesion_if_attached[k] =
        k < p.wall ? call.adhesions->between(atom->type[p.i[k]], atom->type[p.j[k]])
                   : wall_of(p.j[k], *call.walls).adhesion();
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

// Differences of earlier calls move on, once a call.
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
  threads.share(p.size, [&](int begin, int end) {
    kernels.extrapolate(p.past[FORCE].arrays(), by, p.least.empty() ? nullptr : p.least.data(),
                        p.force.data(), begin, end);
  });
  if (lines) {
    by.unit = 1.0;
    by.least = -1.0;
    if (is_cubic) by.smooth = tuning.smooth * tolerance;
    threads.share(p.wall, [&](int begin, int end) { lines->predict(by, begin, end); });
  }
  summary.evaluations = 0;
  solutions = 0;
  is_corrected = false;
  allowed_evaluations = max_evaluations;
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
  // of normals and angles, which also round differently, each particle needs those of its own rank only
  take_means(p.overlap);
  take_means(p.force);
  if (p.curved) take_means(p.per_distance);
}

/* ----------------------------------------------------------------------
   The loop. Pairs know their overlaps. May be called again in the same call,
   with other pairs, after `remember`. Returns whether forces are balanced.
------------------------------------------------------------------------- */

bool DualSolver::balance(const ForceCall &call)
{
  if (solutions++ > 0) take_past();
  average_over_ranks();
  if (lines)
    lines->begin();
  else if (films)
    films->begin();
  outcome = Outcome::NONE;
  const bool is_planned = may_plan();
  Evaluation now = is_planned ? evaluate_and_correct() : evaluate();
  if (solutions == 1 && !is_planned) planned_from = now;

  Attempt attempt = Attempt::PREDICTED;
  begin_attempt();
  for (;;) {
    summary.termination = iterate(now, attempt);
    const Attempt next = next_attempt(attempt, now);
    if (next == attempt) break;
    attempt = next;
    now = begin(attempt, call);
  }
  if (lines) lines->count_limited();
  shapes_exist = now.exists;
  summary.imbalance = !now.exists ? 1.0 : now.worst() > 0.0 ? now.worst() / now.force : 0.0;
  return now.exists && now.worst() <= limit(now);
}

// Newton's method, until it ends.
Termination DualSolver::iterate(Evaluation &now, Attempt attempt)
{
  for (;; now = correct(now)) {
    if (is_traced) trace(attempt, now);
    if (!now.exists && (has_another(attempt) || !std::isfinite(now.force)))
      return Termination::NO_SHAPE;
    // straight lines are let go afterwards, and films follow their tensions only then
    const double worst = attempt == Attempt::STRAIGHT ? now.imbalance : now.worst();
    if (is_balanced(now, worst)) return Termination::BALANCED;
    if (!may_go_on()) return now.exists ? Termination::OUT_OF_EVALUATIONS : Termination::NO_SHAPE;
    if (gets_nowhere(worst)) return now.exists ? Termination::STUCK : Termination::NO_SHAPE;
  }
}

// Steps that do not halve the imbalance become careful, and then they end.
bool DualSolver::gets_nowhere(double imbalance)
{
  const int evaluations = summary.evaluations - progress.evaluations;
  if (imbalance < 0.5 * progress.imbalance) {
    progress.imbalance = imbalance;
    progress.evaluations = summary.evaluations;
  } else if (!progress.is_careful && evaluations > tuning.astray) {
    progress.is_careful = true;
    progress.evaluations = summary.evaluations;
  } else if (evaluations > tuning.stuck) {
    return true;
  }
  return false;
}

// After one that finds no shapes.
bool DualSolver::has_another(Attempt attempt) const
{
  return attempt == Attempt::PREDICTED ||
         (lines && (attempt == Attempt::ANEW || attempt == Attempt::LET_GO));
}

// The same one: it is the last.
DualSolver::Attempt DualSolver::next_attempt(Attempt attempt, const Evaluation &now)
{
  constexpr double FAR = 1e-3;    // from balance, over the largest force
  const bool is_far = now.worst() > FAR * now.force, lets_go = attempt == Attempt::LET_GO;
  switch (summary.termination) {
    case Termination::BALANCED: return attempt == Attempt::STRAIGHT ? Attempt::LET_GO : attempt;
    case Termination::NO_SHAPE:
      if (!has_another(attempt)) return attempt;
      return attempt == Attempt::PREDICTED ? Attempt::ANEW
             : lets_go                     ? Attempt::HELD
                                           : Attempt::STRAIGHT;
    case Termination::OUT_OF_EVALUATIONS: return lets_go && is_far ? Attempt::HELD : attempt;
    case Termination::STUCK:
      are_balanced = false;    // has_room looks only then
      if (lines && !lines->held) {
        if (lets_go && is_far) return Attempt::HELD;
        if (!lets_go && !has_room()) return Attempt::STRAIGHT;
      }
      return attempt == Attempt::PREDICTED && is_far ? Attempt::ANEW : attempt;
  }
  return attempt;
}

void DualSolver::begin_attempt()
{
  progress = {};
  progress.evaluations = summary.evaluations;
}

// Even beyond maxeval.
Evaluation DualSolver::begin(Attempt attempt, const ForceCall &call)
{
  begin_attempt();
  outcome = Outcome::NONE;
  linear.invalidate_bounds();
  if (attempt == Attempt::LET_GO) {
    lines->let_go();
  } else {
    std::fill(list.pairs.force.begin(), list.pairs.force.end(), 0.0);
    if (lines) {
      locate(call);    // lines may be nowhere
      average_over_ranks();
      lines->straighten(attempt != Attempt::ANEW);
    }
  }
  if (attempt != Attempt::ANEW) allowed_evaluations = summary.evaluations + max_evaluations;
  return evaluate();
}

// One row of each evaluation that a step leads to.
void DualSolver::trace(Attempt attempt, const Evaluation &now) const
{
  if (comm->me != 0) return;
  static constexpr const char *ATTEMPTS[] = {"predicted", "anew", "straight", "let go", "held"};
  static constexpr const char *OUTCOMES[] = {"", "taken", "shortened", "alone", "undone"};
  utils::logmesg(
      lmp, "Trace: step {} evaluation {} {} imbalance {:.3g} of lines {:.3g} force {:.6g}{}{} {}\n",
      update->ntimestep, summary.evaluations, ATTEMPTS[static_cast<int>(attempt)], now.imbalance,
      now.line_imbalance, now.force, now.exists ? "" : " no shape",
      progress.is_careful ? " careful" : "", OUTCOMES[static_cast<int>(outcome)]);
}

// In a minimization each call makes a correction at least, so that contact forces converge with the total forces.
bool DualSolver::is_balanced(const Evaluation &now, double worst) const
{
  return now.exists && worst <= limit(now) &&
         (!minimizing() || is_corrected || now.imbalance == 0.0);
}

// Whether the last calls tell how far to correct: not in minimizations.
bool DualSolver::may_plan() const
{
  return tuning.planned != 0.0 && solutions == 1 && successive_calls >= QUADRATIC &&
         !minimizing() && linear.knows_bounds() && planned_from.exists &&
         planned_from.norm2 > 0.0 && planned_from.force > 0.0 &&
         (!lines || lines_answer(planned_from));
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
  found_before.assign(blocks.count(), {});
  Steps steps;
  add_shape(steps, Stage::SHAPE, true);
  if (!lines && relaxation.begin(tuning, tolerance, planned_from.force)) {
    sweep(steps);
    relax_pairs();
    steps.clear();
    add_shape(steps, Stage::RESHAPE, true);
  }
  if (lines) {
    const Steps correction = with_lines(accuracy(planned_from));
    steps.insert(steps.end(), correction.begin(), correction.end());
    const Evaluation now = run(steps, &planned_from);
    return std::isfinite(planned_from.force) ? accept_with_lines(now, planned_from) : now;
  }
  add_solution(steps, linear.plan(accuracy(planned_from)));
  const Stage shape = shape_after(planned_from);
  steps.push_back(Stage::STEP);
  add_shape(steps, shape);
  Evaluation now = run(steps, &planned_from);
  if (!std::isfinite(planned_from.force)) return now;
  if (shape == Stage::ADAPT && shape_after(planned_from) != shape)    // larger than planned
    now = evaluate();
  return line_search(accept(now, planned_from, true, true),
                     LineSearch::BETTER * planned_from.imbalance);
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
  // Lines that do not move: shapes and a line search. Lines that move: they turn after the step, by outlines as they are then, or,
  // with films or where they have answered, by outlines that follow the step to first order.
  Steps steps;
  add_solution(steps, corrections);
  steps.push_back(Stage::STEP);
  const bool follows = moves && (films || lines->answers);
  if (!follows) add_shape(steps, shape_after(from));
  const Evaluation stepped = accept(run(steps), from, corrections > 0, !follows);
  if (!moves || outcome == Outcome::UNDONE)
    return line_search(stepped, progress.is_careful ? 0.0 : LineSearch::BETTER * from.imbalance);
  lines->adapt(follows ? from.line_imbalance : stepped.line_imbalance);
  if (!follows) lines->forget_answers();    // by outlines as they are
  run(follows ? Steps{Stage::FOLLOW_STEP, Stage::TURN} : Steps{Stage::TURN});
  const Evaluation now = evaluate();
  lines->answers &=
      now.exists && now.worst() <= std::max(LineSearch::BETTER * from.worst(), limit(now));
  // between films lines alone seldom make it worse: iterations may diverge slowly
  if (films && now.imbalance > from.imbalance) linear.invalidate_bounds();
  return line_search(now, LineSearch::NO_WORSE * std::max(from.worst(), stepped.worst()));
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
  lines->answers =
      now.exists && now.worst() <= std::max(LineSearch::BETTER * from.worst(), limit(now));
  outcome = Outcome::TAKEN;
  if (lines->answers || (now.exists && now.worst() <= LineSearch::NO_WORSE * from.worst()))
    return now;
  return undo();
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

Evaluation DualSolver::accept(const Evaluation &now, const Evaluation &from, bool iterated,
                              bool has_shapes)
{
  if (iterated && !linear.is_sound(step_slope, from.norm2 * unit_of_energy())) return undo();
  outcome = Outcome::TAKEN;
  if (step_slope > 0.0) return now;
  // single precision is not enough
  outcome = Outcome::ALONE;
  move(1.0, 0.0);
  if (has_shapes) evaluate();
  step_slope = step_alone();
  return has_shapes ? evaluate() : now;
}

// The last step leads astray, as the bounds of the spectrum are wrong: conjugate gradients come next.
Evaluation DualSolver::undo()
{
  outcome = Outcome::UNDONE;
  linear.invalidate_bounds();
  move(1.0, 0.0);
  step_slope = 0.0;
  return evaluate();
}

/* ----------------------------------------------------------------------
   The dual energy is concave along the step. A step that is much too long
   has a negative slope at its end, and the search looks for the place where
   the slope vanishes. What single precision leaves of a small step is far
   below the tolerance.
------------------------------------------------------------------------- */

Evaluation DualSolver::line_search(Evaluation now, double target)
{
  const double slope = step_slope;
  if (!(slope > 0.0)) return now;    // no step
  const double flat =
      slope * (progress.is_careful ? LineSearch::FLAT_IF_CAREFUL : LineSearch::FLAT);
  double low = 0.0, low_slope = slope, high = 1.0, at = 1.0;
  for (;;) {
    if (now.exists && now.imbalance <= std::max(target, limit(now))) return now;
    linear.invalidate_bounds();
    const double here = now.exists ? slope_at_end() : -std::numeric_limits<double>::infinity();
    if (here >= -flat && (at == 1.0 || here <= flat)) return now;
    if (!may_go_on()) return now;

    double next;
    if (here > 0.0) {
      low = at;
      low_slope = here;
      next = 0.5 * (low + high);
    } else {
      high = at;
      const double part = low_slope / (low_slope - here);
      next = low + (high - low) * (std::isinf(here) ? LineSearch::WITHOUT_SHAPE : part);
    }
    const double margin = LineSearch::FROM_ENDS * (high - low);
    next = std::clamp(next, low + margin, high - margin);
    if (!(next > low && next < high) || high - low < LineSearch::NARROW) return now;
    outcome = Outcome::SHORTENED;
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
    const double first = a.before[k], change = a.step[k], force = a.force[k];
    const bool is_small = std::fabs(change) < std::fabs(first);
    const double moved = is_small    ? force + (to - from) * change * a.unit
                         : to == 0.0 ? first * a.unit
                                     : (first + to * change) * a.unit;
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
  if (solutions > 1)
    for (int kind = 0; kind < list.pairs.kinds(); ++kind)
      list.pairs.past[kind].earlier[0] = changes[kind];
}

// The next solution of this call is another problem: it may take as many evaluations.
void DualSolver::begin_again()
{
  remember();
  allowed_evaluations = summary.evaluations + max_evaluations;
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
void DualSolver::finish(const ForceCall &call, const Push &push, double part)
{
  push_all(call, push, part, true);
  remember_lines();
}

void DualSolver::push_all(const ForceCall &call, const Push &push, double part, bool is_final)
{
  const NearPairs &p = list.pairs;
  std::vector<RingBatches> here = batches.of_threads();
  std::vector<double> energy(blocks.count(), 0.0);
  const auto work = [&](int block, int stage, int thread) {
    blocks.choose(here[thread], block);
    if (stage == 1 && !lines) find_slopes(here[thread]);    // those have slopes
    blocks.for_pairs(block, [&](int begin, int end, double) {
      if (stage == 1 && is_final) kernels.remember(arrays(), begin, end);
      if (stage == 2 && begin < p.wall) energy[block] += push(begin, end, part, is_final);
    });
    if (stage == 3) p.in_space ? add_pushes<3>(here[thread]) : add_pushes<2>(here[thread]);
  };
  const int together = call.tallies ? 1 : 3;    // stages
  blocks.run(threads, together, work, [](int) {});
  for (int stage = together + 1; stage <= 3; ++stage)
    for (int block = 0; block < blocks.count(); ++block) work(block, stage, 0);
  pushed_energy = std::accumulate(energy.begin(), energy.end(), 0.0);
  if (p.wall < p.size) pushed_energy += push(p.wall, p.size, part, is_final);
  const int axes = p.in_space ? 3 : 2;
  for (const int k : images)
    for (int axis = 0; axis < axes; ++axis)
      atom->f[p.j[k]][axis] -= pushes[axes * static_cast<std::size_t>(k) + axis];
}

// The force on a particle is the sum over its contacts. Ghosts have forces of their own: LAMMPS finds the virial from them.
template <int AXES> void DualSolver::add_pushes(const RingBatches &rings)
{
  for (int batch = rings.begin; batch < rings.end; ++batch) {
    double sum[LANES][AXES] = {};
    for (int c = batches.first[batch]; c < batches.first[batch + 1]; c += LANES)
      for (int lane = 0; lane < LANES; ++lane) {
        const std::size_t k = batches.pair_side[c + lane] >> 1;
        for (int axis = 0; axis < AXES; ++axis)
          sum[lane][axis] += sign[c + lane] * pushes[AXES * k + axis];
      }
    for (int lane = 0; lane < LANES; ++lane) {
      const int i = batches.particle[batch * LANES + lane];
      for (int axis = 0; axis < AXES && i >= 0; ++axis) atom->f[i][axis] += sum[lane][axis];
    }
  }
}

void DualSolver::find_images()
{
  const NearPairs &p = list.pairs;
  pushes.assign((p.in_space ? 3 : 2) * (p.size + std::size_t{1}), 0.0);
  sign.assign(batches.contacts, 0.0F);
  images.clear();
  for (int k = 0; k < p.wall; ++k) {
    sign[p.side[0][k]] = 1.0F;
    if (p.j[k] < atom->nlocal)
      sign[p.side[1][k]] = -1.0F;
    else
      images.push_back(k);
  }
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
  for (int end = 0; end < 2; ++end) a.side[end] = p.side[end].data();
  a.indentation = batches.indentation.data();
  a.compliance = batches.compliance.data();
  a.correction = batches.step.data();
  a.force = p.force.data();
  a.residual = residual.data();
  a.weight = weight.data();
  a.before = before.data();
  a.step = step.data();
  a.length = p.length;
  a.unit = p.unit();
  a.past = p.past[FORCE].arrays();
  a.least = p.least.empty() ? nullptr : p.least.data();
  return a;
}

// Shapes, and then the residuals.
void DualSolver::add_shape(Steps &steps, Stage shape, bool is_before) const
{
  const auto add = [&](Stage stage) {
    steps.push_back(stage);
    steps.back().is_before = is_before;
  };
  add(shape);
  if (has_facets()) add(Stage::TILT);
  add(Stage::RESIDUAL);
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

// Returns what the last stage RESIDUAL has found in all blocks; in `of_planned`, unless null, what that before a planned correction
// has.
Evaluation DualSolver::run(const Steps &steps, Evaluation *of_planned)
{
  found.assign(blocks.count(), {});
  sweep(steps);
  if (steps.back().stage == Stage::RESIDUAL) ++summary.evaluations;
  if (of_planned) ++summary.evaluations;
  LargestAndSums both[] = {sum_up(found), of_planned ? sum_up(found_before) : LargestAndSums()};
  if (comm->nprocs > 1) combine_ranks(world, both, of_planned ? 2 : 1);
  Evaluation now = evaluation_of(both[0]);
  const auto takes = [](const Step &step) { return step.stage == Stage::STEP; };
  if (std::any_of(steps.begin(), steps.end(), takes)) step_slope = both[0].sum[SLOPE];
  if (of_planned) {
    *of_planned = evaluation_of(both[1]);
    now.exists &= of_planned->exists;
  }
  return now;
}

void DualSolver::sweep(const Steps &steps)
{
  const auto step_of = [&](int number) -> const Step & { return steps[number - 1]; };
  std::vector<RingBatches> here = batches.of_threads();    // the block that has its turn
  blocks.run(
      threads, static_cast<int>(steps.size()),
      [&](int block, int number, int thread) {
        blocks.choose(here[thread], block);
        work(step_of(number), block, here[thread]);
      },
      [&](int number) { exchange_after(step_of(number)); });
}

// A few pairs that are far from balance, one after the other. Those of a block are found together.
void DualSolver::relax_pairs()
{
  std::fill(step.begin(), step.end(), 0.0F);
  for (int block = 0; block < blocks.count(); ++block) {
    static_cast<Residuals &>(found_before[block]) = {};    // they are found again
    relaxation.relax(block, kernels, blocks, list.pairs, batches, arrays());
  }
}

void DualSolver::work(const Step &now, int block, RingBatches &here)
{
  const PairArrays loop = arrays();
  OfBlock &of = (now.is_before ? found_before : found)[block];
  switch (now.stage) {
    case Stage::SHAPE: of.exists &= shape(here); break;
    case Stage::ADAPT: of.exists &= adapt(here, step.data(), loop.unit); break;
    case Stage::TILT: turn_facets(here); break;
    case Stage::RESIDUAL:
      blocks.for_pairs(block, [&](int begin, int end, double part) {
        if (films) of.line = std::max(of.line, films->find_bounds(begin, end));
        of.add(kernels.find_residuals(loop, begin, end), part);
        if (lines) of.line = std::max(of.line, lines->find(loop, begin, end));
      });
      if (films) of.line = std::max(of.line, films->lag(here));
      break;
    case Stage::RESHAPE:
      relaxation.for_changed(here, [&](const RingBatches &changed) {
        of.exists &= reshape(changed, step.data(), loop.unit);
      });
      break;
    case Stage::CORRECT:
      linear.iterate(here, loop, now.iteration, now.last,
                     now.goes_on ? lines->arrays().left : nullptr, now.gain);
      break;
    case Stage::STEP:
      blocks.for_pairs(block, [&](int begin, int end, double part) {
        of.slope += part * kernels.take_step(loop, false, begin, end);
      });
      break;
    case Stage::FOLLOW: kernels.follow(here, lines->arrays(), nullptr); break;
    case Stage::ANSWER:
      blocks.for_pairs(block,
                       [&](int begin, int end, double) { lines->find_answers(loop, begin, end); });
      break;
    case Stage::RESPOND: {
      const bool begins = !now.goes_on;
      kernels.respond(here, lines->arrays(), begins);
      break;
    }
    case Stage::FOLLOW_STEP: kernels.follow(here, lines->arrays(), step.data()); break;
    case Stage::TURN:
      blocks.for_pairs(block, [&](int begin, int end, double) { lines->settle(loop, begin, end); });
      if (films) films->follow(here);
  }
}

// What other ranks need of a stage.
void DualSolver::exchange_after(const Step &done)
{
  switch (done.stage) {
    case Stage::SHAPE:
    case Stage::ADAPT:
    case Stage::TILT:
      if (has_facets() && done.stage != Stage::TILT) {
        exchange_facets();
        break;
      }
      list.remote_sides.exchange(batches.indentation.data(), batches.compliance.data());
      if (lines) lines->exchange_outlines();
      break;
    case Stage::CORRECT:
      if (done.iteration == done.last) break;
      [[fallthrough]];
    case Stage::RESPOND:
      list.remote_sides.exchange(LinearSolver::products(batches.arrays(), done.iteration));
      break;
    case Stage::FOLLOW:
    case Stage::FOLLOW_STEP: lines->exchange_answers(); break;
    case Stage::RESIDUAL:
    case Stage::RESHAPE:    // particles beside those of other ranks keep their shapes
    case Stage::STEP:
    case Stage::ANSWER:
    case Stage::TURN: break;
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

LargestAndSums DualSolver::sum_up(const std::vector<OfBlock> &of_blocks)
{
  LargestAndSums all;
  for (const OfBlock &of : of_blocks) {
    const double largest[] = {of.error, of.force, of.left, of.exists ? 0.0 : 1.0, of.line};
    for (int k = 0; k < 5; ++k) all.largest[k] = std::max(all.largest[k], largest[k]);
    all.sum[NORM2] += of.norm2;
    all.sum[WEIGHTS] += of.weights;
    all.sum[SLOPE] += of.slope;
  }
  return all;
}

Evaluation DualSolver::evaluation_of(const LargestAndSums &all)
{
  // Overlaps are not known better than this.
  constexpr double ROUNDING = 8.0 * std::numeric_limits<double>::epsilon();
  const double left = all.largest[LEFT];
  Evaluation now;
  now.imbalance = left <= ROUNDING ? 0.0 : all.largest[ERROR];
  now.line_imbalance = all.largest[OF_LINE];
  now.force = std::max(all.largest[LARGEST_FORCE], std::isinf(left) ? left : 0.0);
  now.exists = all.largest[NO_SHAPE] == 0.0 && std::isfinite(now.force);
  now.norm2 = all.sum[NORM2];
  now.weights = all.sum[WEIGHTS];
  return now;
}

double DualSolver::memory_usage() const
{
  return list.memory_usage() + batches.bytes() + blocks.bytes() + relaxation.bytes() +
         bytes_of(residual, weight, before, step, pushes, sign, images, found, found_before,
                  changes[0], changes[1], changes[2]) +
         (lines ? lines->bytes() : 0.0) + (films ? films->bytes() : 0.0);
}

}    // namespace deformable
