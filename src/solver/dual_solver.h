// The forces of all pairs, from positions. Pair styles call `solve` once a force call.
//
// A particle under the forces f of its contacts has the conjugate energy W(f). Its outline gives way by the indentations a = dW/df,
// with the compliances C = da/df (laws/ring_forces.h, laws/droplet.h). The forces of a packing maximize
//   sum over pairs of f o - sum over particles of W(f),   f >= 0; of an adhesive pair f >= least_force,
// with the overlaps o of the undeformed particles. This is the dual problem of the smallest energy. Its gradient is the residual
// overlap r = o - a_i - a_j, of a wall r = o - a. At the solution r = 0 where f > 0, and r <= 0 where f = 0. The imbalance of a
// pair is the change of its force that would remove r if all others stayed: r/(C_i + C_j), not below -f, and for r > 0 at least k r^3
// as between two circles, since a ring without force has no finite compliance. Forces are balanced when no imbalance exceeds the
// tolerance times the largest force.
//
//   solve        find_pairs, predict, then balance, again where outlines bulge beyond the list of pairs or films come or go; finish
//   predict      a polynomial in time through the forces of the last calls; along the lines of a minimizer the last forces
//   balance      Newton's method: evaluate, and correct until balanced, stuck or out of evaluations; from no forces, and with
//                straight lines, where that leads astray
//   evaluate     kernels find the shapes of all particles (a, C) and the residuals of all pairs; shapes of droplets ask for
//                the facets of their neighbors, and have a stage more
//   correct      C x = r for the active set (LinearSolver: Chebyshev's iteration, or conjugate gradients where the bounds of the
//                spectrum are not known). A pair whose own force would become negative is not in it, and its force vanishes.
//   with_lines   the stages of a correction that curved lines answer (CurvedLines)
//   evaluate_and_correct   both in one sweep, as planned from the last call: the usual way in a run, if the bounds are known.
//                With straight lines pairs that are far off, as where contacts open, are relaxed before (PairRelaxation).
//   accept, line_search   an unsound step is undone, a step that is too long is shortened: the dual energy is concave
//   remember     forces become past ones. A pair without force has its imbalance instead, which is negative: extrapolated in time
//                it becomes positive when the contact forms.
//
// A sweep goes through its stages block by block, and near blocks run ahead of far ones, so that memory is read once (BlockLevels).
// Threads share the blocks. What follows from a sweep does not depend on the order of blocks, so neither on the number of threads.
// All ranks take the same steps, and both ranks of a pair compute the same bits for it. Forces and overlaps are in double precision,
// what only corrects them in single precision and in units of PairArrays. RingSolver and DropletSolver say what W is; lines that
// tilt and bend (CurvedLines) turn with each correction once forces are close to balance.

#ifndef DEFORMABLE_DUAL_SOLVER_H
#define DEFORMABLE_DUAL_SOLVER_H

#include "solver/block_levels.h"
#include "solver/contact_batches.h"
#include "solver/curved_lines.h"
#include "solver/films.h"
#include "solver/linear_solver.h"
#include "solver/pair_list.h"
#include "solver/pair_relaxation.h"
#include "solver/threads.h"
#include "solver/tuning.h"
#include "styles/all_ranks.h"
#include "styles/lammps_names.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace deformable {

// How a solution ends; compute pair shows the number, warnings the words.
enum class Termination { BALANCED, STUCK, NO_SHAPE, OUT_OF_EVALUATIONS };

struct Summary {
  Termination termination = Termination::BALANCED;
  int evaluations = 0;         // in the call
  double imbalance = 0.0;      // the largest of a pair, over the largest force
  double lost_energy = 0.0;    // of films that came or went
  const char *why() const;     // in words: why it ended, and what helps
};

// What is found in all particles and pairs with their present forces.
struct Evaluation {
  double imbalance = 0.0, force = 0.0;    // the largest ones of a pair
  double norm2 = 0.0, weights = 0.0;      // see Residuals
  bool exists = false;                    // every particle has a shape
  double line_imbalance = 0.0;            // the largest one of a line, CurvedLines
  double worst() const { return std::max(imbalance, line_imbalance); }
};

class DualSolver : protected Pointers {
 public:
  virtual ~DualSolver() = default;

  // Threads that share a call: as many as this, or 0: as LAMMPS has, but not more than there are cores.
  static constexpr int ALL_CORES = std::numeric_limits<int>::max();
  int wanted_threads = 0;

  const double tolerance;    // of the imbalance over the largest force
  double accepted = 0.0;     // an imbalance up to this force is small enough, too
  Summary summary;           // of the last call

  // push(begin, end, part, is_final) finds `pushes`, this part of the forces of some pairs, and returns what their energy adds to that
  // of particles. Not final: films come or go afterwards, and other forces follow. Pairs of two ranks have a turn of their own, and so
  // have those with walls, which these push. Threads push at the same time, unless ForceCall::tallies.
  using Push = std::function<double(int begin, int end, double part, bool is_final)>;
  LargeVector<double>
      pushes;    // 2 or 3 numbers of each pair: the force on its first particle; 0 of walls
  double pushed_energy = 0.0;    // of the last call

  // A force call. Returns false on all ranks if any must stop with an error: a wall has refused a center, this pair has a contact
  // line that cannot lie between the centers, or particles have no room (RingSolver). Else all forces have been pushed.
  bool solve(const ForceCall &, const Push &);
  int refused_pair() const { return refused; }    // or -1

  // Whether the forces of the last call are off by a tenth of the largest or more; and an error where they are. Minimizers go on.
  bool is_meaningless() const;
  void check_balance(const char *style) const;

  const NearPairs &pairs() const { return list.pairs; }

  // What is left of an overlap, r; and what a pair adds to the energy of its particles: with f r the sum is that of the dual
  // problem, whose error is of second order in r.
  double residual_overlap(int k) const { return residual[k] * list.pairs.length; }
  double energy_left(int k) const
  {
    return list.pairs.force[k] * residual_overlap(k) + (lines ? lines->energy_left(k) : 0.0);
  }

  // Some contacts may have films.
  virtual void use_films() = 0;

  // For calls after an error that the caller has caught: they must not start from forces without bound.
  void forget();

  double memory_usage() const;

 protected:
  // See PairList for the bulges.
  DualSolver(LAMMPS *, const ForceKernels &, bool in_space, bool curved, double bulge_per_overlap,
             double most_bulge, double tolerance, int max_evaluations, const Tuning &tuning = {});

  // The law. Radii and stiffnesses of all particles, and the units of pairs; `arranged`: contacts are new, and `batches` has
  // other places.
  virtual void set_material(const ForceCall &, bool arranged) = 0;
  void find_adhesions(const ForceCall &);    // of all pairs, if they are attached
  virtual bool has_own_compliances() const { return false; }
  // Shapes of the particles of some batches from the forces of their pairs; the same after small changes; and slopes of
  // outlines. False: a particle has no shape.
  virtual bool shape(const RingBatches &) = 0;
  virtual bool adapt(const RingBatches &, const float *changes, double unit) = 0;
  // Whether indentations also ask for the places of facets on neighbors: `shape` leaves these, ranks exchange them, `turn` does the
  // rest.
  virtual bool has_facets() const { return false; }
  virtual void turn_facets(const RingBatches &) {}
  virtual void exchange_facets() {}
  // The same after pairs were relaxed, by these changes.
  virtual bool reshape(const RingBatches &batch, const float *, double) { return shape(batch); }
  virtual void find_slopes(const RingBatches &) {}
  // After a solution: how far outlines bulge; false on all ranks: particles have no room, and forces no limit.
  virtual bool has_room() { return true; }
  virtual void find_bulges(const ForceCall &) = 0;
  virtual double energy() const = 0;    // of all particles of this rank, without what is left
  // What a user should know after a solution. The law calls warn_unbalanced: it warns once of contacts that are not balanced, and
  // names its pair style.
  virtual void warn(const ForceCall &, bool films_changed) = 0;
  void warn_unbalanced(const char *style);

  const ForceKernels &kernels;
  const Tuning tuning;
  PairList list;
  ContactBatches batches;
  std::unique_ptr<CurvedLines> lines;    // null: perpendicular to lines of centers
  std::unique_ptr<Films> films;          // null: no adhesion
  bool are_balanced = false;
  bool shapes_exist = true;

 private:
  // What happens to a block in a sweep: `work` does it, and `exchange_after` tells other ranks.
  enum class Stage {
    SHAPE,       // of particles, for the forces of their pairs
    ADAPT,       // the same after a small step
    RESHAPE,     // of particles whose pairs were relaxed
    TILT,        // what neighbors add to that, as films of droplets turn
    RESIDUAL,    // overlaps of all pairs
    CORRECT,     // an iteration for C x = r
    STEP,        // all forces take their corrections
    // curved lines: see CurvedLines
    FOLLOW,         // outlines follow the last answer of lines, and the correction so far
    ANSWER,         // of lines to that
    RESPOND,        // what it does to indentations; then comes a solution for what is left
    FOLLOW_STEP,    // outlines follow the last answer, and the step
    TURN            // lines to where they are at rest
  };
  struct Step {
    Stage stage;
    int iteration = 0, last = 0;    // CORRECT: which one of so many
    double gain = 1.0;              // and what steps are multiplied by
    bool goes_on = false;           // CORRECT, RESPOND: with what a solution before has left
    bool is_before = false;         // SHAPE to RESIDUAL: a correction that was planned follows
    Step(Stage stage) : stage(stage) {}
  };
  using Steps = std::vector<Step>;
  void add_shape(Steps &, Stage, bool is_before = false) const;
  static void add_solution(Steps &, int iterations, double gain = 1.0, bool goes_on = false);

  const int max_evaluations;      // of a call, without changes of films
  int allowed_evaluations = 0;    // of this call
  int refused = -1;               // see refused_pair
  bool warned_unbalanced = false;

  // prediction
  static constexpr int LINEAR = 2, QUADRATIC = 3, CUBIC = 4;    // past forces that are needed
  int successive_calls = 0;    // at successive time steps before this one
  bigint last_step = -2;
  int solutions = 0;    // of this call so far
  // From the last call, as the first solution has left them: they stand in for past[].earlier[0] in a call of several solutions.
  LargeVector<float> changes[KINDS];
  bool is_corrected = false;    // whether this call has made a correction
  // Before the correction of the last call, and then of this one, which is planned from it.
  Evaluation planned_from;

  Threads threads;
  int last_wanted = 1;
  LinearSolver linear;
  PairRelaxation relaxation;
  BlockLevels blocks;
  LargeVector<float> residual, weight, before, step;    // by pair, see PairArrays
  struct OfBlock : Residuals {
    double line = 0.0;     // imbalance of a line
    double slope = 0.0;    // see step_slope
    bool exists = true;    // every particle has a shape
    void add(const Residuals &, double part);
  };
  LargeVector<float> sign;              // of pushes at contacts; 0 at ghosts
  std::vector<int> images;              // pairs whose second particle is a ghost
  std::vector<OfBlock> found;           // by the last stages RESIDUAL and STEP
  std::vector<OfBlock> found_before;    // the same, before a correction that was planned
  double pairs_of_all = 1.0;            // the number of pairs of all ranks, plus 1

  bool minimizing() const;
  bool searches_lines() const;
  void choose_threads();
  void arrange(const ForceCall &, bool new_list);
  void find_images();
  bool locate(const ForceCall &);
  bool find_pairs(const ForceCall &);
  double total_energy() const;

  void predict();
  void take_past();
  void average_over_ranks();
  void remember();
  void remember_lines();
  void begin_again();

  // Beyond confluence there may be no balance, and lines may lead astray. So a solution begins with the forces that are predicted;
  // with no forces; with no forces and straight lines; from there with lines that may turn; and with lines that stay straight.
  enum class Attempt { PREDICTED, ANEW, STRAIGHT, LET_GO, HELD };
  // What became of a step; DEFORMABLE_TRACE prints it.
  enum class Outcome { NONE, TAKEN, SHORTENED, ALONE, UNDONE };
  bool balance(const ForceCall &);
  void begin_attempt();
  Evaluation begin(Attempt, const ForceCall &);
  Termination iterate(Evaluation &, Attempt);
  bool has_another(Attempt) const;
  Attempt next_attempt(Attempt, const Evaluation &);
  bool gets_nowhere(double imbalance);
  const bool is_traced;
  void trace(Attempt, const Evaluation &) const;
  bool may_plan() const;
  bool lines_move(const Evaluation &) const;
  bool lines_answer(const Evaluation &) const;
  Steps with_lines(double accuracy);
  Evaluation accept_with_lines(Evaluation now, const Evaluation &from);
  Evaluation evaluate_and_correct();
  Evaluation correct(const Evaluation &);
  double accuracy(const Evaluation &) const;
  Stage shape_after(const Evaluation &) const;
  Evaluation accept(const Evaluation &now, const Evaluation &from, bool iterated, bool has_shapes);
  Evaluation line_search(Evaluation now, double target);
  bool is_balanced(const Evaluation &now, double worst) const;
  // Since when the imbalance has not halved.
  struct Progress {
    double imbalance = std::numeric_limits<double>::infinity();
    int evaluations = 0;
    // Whether a step must lead to where the dual energy is largest along it, or only halve the imbalance. That is faster where
    // Newton's method converges; from forces that are far off it may go to and fro, as between no force and one that is too large.
    bool is_careful = false;
  } progress;
  struct LineSearch {
    // A step needs no search if the imbalance is at most this part of that before; if lines change too.
    static constexpr double BETTER = 0.5, NO_WORSE = 2.0;
    // Where it ends: slopes over the first one, and the part of the step that is left.
    static constexpr double FLAT = 0.5, FLAT_IF_CAREFUL = 0.1, NARROW = 1e-10;
    // The next place is so far from both ends of that part, and here where particles have no shape at its end.
    static constexpr double FROM_ENDS = 0.1, WITHOUT_SHAPE = 0.25;
  };
  double limit(const Evaluation &now) const { return std::max(tolerance * now.force, accepted); }
  bool may_go_on() const { return summary.evaluations < allowed_evaluations; }

  PairArrays arrays();
  Evaluation run(const Steps &, Evaluation *of_planned = nullptr);
  void sweep(const Steps &);
  void relax_pairs();
  Evaluation evaluate();
  void work(const Step &, int block, RingBatches &);
  void exchange_after(const Step &);
  static LargestAndSums sum_up(const std::vector<OfBlock> &);
  static Evaluation evaluation_of(const LargestAndSums &);
  double step_slope = 0.0;    // of the dual energy along the last step, where that began
  Outcome outcome = Outcome::NONE;
  void move(double from, double to);
  Evaluation undo();
  double slope_at_end();
  double step_alone();
  double unit_of_energy() const { return list.pairs.length * list.pairs.unit(); }
  void finish(const ForceCall &, const Push &, double part);
  void push_all(const ForceCall &, const Push &, double part, bool is_final);
  template <int AXES> void add_pushes(const RingBatches &);

  template <class Sum> double sum_over_pairs(Sum &&sum) const    // of all ranks
  {
    return list.remote_sides.sum(list.pairs.sum(sum));
  }
};

}    // namespace deformable

#endif
