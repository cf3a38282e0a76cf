// Balanced contacts: the forces of all pairs, from positions.
//
// The energy of balanced contacts is smallest over all splits of the overlaps o = a_ij + a_ji. Its dual problem has one
// unknown for each pair, its force f. Find the largest value of
//   sum over pairs of f o - sum over particles of W(f),   f >= 0,
// with W of ring_forces.h; of a wall, o = a. Its gradient is what is left of the overlap,
//   r = o - a_ij - a_ji,   0 where f > 0, not positive where f = 0.
// Newton's method finds the maximum. A step solves C x = r with the compliances C of all rings (ForceCorrector), for the
// pairs that bear a force; a pair whose own force would become negative takes no part, and its force vanishes.
//
// The imbalance of a pair is the change of its force that would remove r if all other forces stayed: r/(C_i + C_j), at
// least k r^3 as between circles (a ring without force has infinite compliance), and not below -f. The solution is found
// when no imbalance exceeds the tolerance times the largest force. Pairs without force keep their imbalance, then negative,
// as a force that continues the positive ones: it tells when a contact will form.
//
// In motion the forces of the last calls predict the next ones well (ForcePredictor) but for the few pairs that have
// opened or closed. Those are relaxed one by one (PairRelaxation), then one step for all is mostly enough: shapes,
// relaxation, correction and the shapes after it are one run through the blocks of rings (BlockPipeline).
//
// All ranks do the same arithmetic in the same order of steps, from the same overlap and force of a pair, so that both
// ranks of a pair agree on its force to the last bit.
//
// Where contact lines are curved, the energy is smallest over their tilts and bends too. They take a step (CurvedLines)
// with each of Newton's method, as soon as forces are close to balance.

#ifndef LMP_FORCE_SOLVER_H
#define LMP_FORCE_SOLVER_H

#include "pointers.h"

#include "solver/block_pipeline.h"
#include "solver/curved_lines.h"
#include "solver/force_predictor.h"

#include <algorithm>
#include <memory>

namespace LAMMPS_NS {

class ForceSolver : protected Pointers {
 public:
  ForceSolver(class LAMMPS *, const deformable::ForceKernels &, bool curved, double tolerance,
              int max_evaluations);

  const double tolerance;    // of the imbalance over the largest force

  void arrange(ForceBatches &, NearPairs &, RemoteSides &, bool new_list);    // contacts are new

  void stick(Films *films) { lines->films = films; }

  // A new force call: forces and tilts continue those of the last calls.
  void begin_call();

  // The rings know their material, the pairs their places. Starts from the last forces. Returns whether the forces are
  // balanced. May be called again in the same call, with other pairs, after `remember`.
  bool solve();

  // The forces are the past ones of the next call.
  void remember();

  // The same, and the next solution of this call is another problem: it may take as many evaluations.
  void begin_again();

  // Remembers the forces, finds the slopes of the outlines and calls act(begin, end) for all pairs.
  template <class Act> void finish(Act &&act)
  {
    pipeline.finish(is_remembered, act);
    is_remembered = true;
  }

  bool exists = true;    // whether all rings bear the last forces
  // of the last call
  int evaluations() const { return pipeline.evaluations; }
  double imbalance = 0.0;    // the largest of a pair, over the largest force
  // What is left of the overlap of a pair, r.
  double left(int k) const { return pipeline.left(k); }
  // What a pair adds to the energy of its rings, to that of the dual problem.
  double energy_left(int k) const
  {
    return pairs->force[k] * left(k) + (lines ? lines->energy_left(k) : 0.0);
  }
  double limited_lines() const { return lines ? lines->limited : 0.0; }

  double memory_usage() const { return pipeline.bytes() + (lines ? lines->bytes() : 0.0); }

 private:
  using Stage = BlockPipeline::Stage;
  using Stages = BlockPipeline::Stages;

  const int max_evaluations;    // of a call, without changes of films
  int allowed = 0;
  BlockPipeline pipeline;
  ForcePredictor predictor;
  std::unique_ptr<CurvedLines>
      lines;    // null: they are straight, perpendicular to lines of centers
  NearPairs *pairs = nullptr;

  bool is_first = true;    // solution of this call
  bool is_remembered = false;
  bool is_corrected = false;    // in this call
  // Before the correction of the last call, and then of this one, which is planned from it.
  Evaluation planned_from;

  bool minimizing() const;
  double limit(const Evaluation &now) const { return tolerance * now.force; }
  bool may_go_on() const { return pipeline.evaluations < allowed; }
  void forget();
  bool is_balanced(Evaluation &now);

  Evaluation first_evaluation();
  Evaluation evaluate_and_correct();
  int local_corrections = 0;    // of this solution
  bool correct_some(Evaluation &);
  Evaluation correct(const Evaluation &);
  double accuracy(const Evaluation &) const;
  Stage shape_after(const Evaluation &) const;
  bool is_sound(const Evaluation &now, const Evaluation &from) const;
  Evaluation accept(Evaluation now, const Evaluation &from, bool iterated, bool has_shapes);
  static constexpr double BETTER = 0.5;    // than before a step, that needs no search
  Evaluation line_search(Evaluation now, double enough);
};

}    // namespace LAMMPS_NS

#endif
