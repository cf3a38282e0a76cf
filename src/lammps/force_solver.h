// Balanced contacts: the forces of all pairs, from positions.
//
// The energy of balanced contacts is smallest over all splits of the overlaps o = a_ij + a_ji. Its dual problem: find the
// largest value of
//   sum over pairs of f o - sum over particles of W(f),   f >= 0,
// over one force for each pair, with W of ring_forces.h; of a wall, o = a. Its gradient is what is left of the overlap,
//   r = o - a_ij - a_ji,   0 where f > 0, not positive where f = 0.
// Newton's method finds the maximum; ForceCorrector solves its linear systems, with the compliances C of both rings. A
// pair whose own force would become negative takes no part in a step: its force vanishes. All ranks do the same
// arithmetic in the same order of steps, from the same overlap and force of a pair, so that both ranks of a pair agree
// on its force to the last bit.
//
// The imbalance of a pair is the change of its force that would remove r if all other forces stayed: r/(C_i + C_j), at
// least k r^3 as between circles (a ring without force has infinite compliance), and not below -f. Pairs without force
// keep it, then negative, as a force that continues the positive ones: it tells when a contact will form.
//
// In motion most pairs are close to balance from the start, but for those that open or close: they are relaxed first
// (PairRelaxation), and one step for all is mostly enough.
//
// Where contact lines tilt, the energy is smallest over their tilts too. They take a step (LineTilts) with each of
// Newton's method, as soon as forces are close to balance.

#ifndef LMP_FORCE_SOLVER_H
#define LMP_FORCE_SOLVER_H

#include "devices.h"
#include "pointers.h"

#include "block_levels.h"
#include "force_batches.h"
#include "force_corrector.h"
#include "line_tilts.h"
#include "near_pairs.h"
#include "pair_relaxation.h"
#include "remote_sides.h"

#include <algorithm>
#include <vector>

namespace LAMMPS_NS {

class ForceSolver : protected Pointers {
 public:
  ForceSolver(class LAMMPS *lmp, const deformable::ForceKernels &kernels, double tolerance,
              int max_evaluations)
      : Pointers(lmp),
        tolerance(tolerance),
        max_evaluations(max_evaluations),
        kernels(kernels),
        corrector(kernels)
  {
  }

  const double tolerance;       // of the imbalance over the largest force
  const int max_evaluations;    // of a call

  // of the last call
  int evaluations = 0;
  double imbalance = 0.0;    // the largest of a pair, over the largest force

  void arrange(const ForceBatches &, const NearPairs &, bool new_list);    // contacts are new

  // A new force call: forces continue those of the last calls. If places are given, `solve` itself finds distances and
  // directions of the pairs of two particles of this rank, block by block.
  void begin_call(NearPairs &, ForceBatches &, const deformable::PairPlaces *);

  // The rings know their material. Starts from the last forces. Returns whether the forces are balanced. May be called
  // again in the same call, with other pairs that are located, after `remember`.
  bool solve(RemoteSides &);
  void remember()
  {
    if (!is_remembered) kernels.remember(arrays(), 0, pairs->size);
    is_remembered = true;
  }

  // All contact lines lie between the centers. Otherwise there is no solution.
  bool lines_are_apart() const { return is_apart; }

  // Remembers the forces, finds the slopes of the outlines and calls act(begin, end) for all pairs.
  template <class Act> void finish(Act &&act)
  {
    deformable::RingBatches here = batches->arrays();
    const auto work = [&](int block, int stage) {
      blocks.choose(here, block);
      if (stage == 1 && !pairs->tilts)    // those have slopes
        kernels.slopes(here, pairs->directions(), nullptr);
      blocks.for_pairs(block, [&](int a, int z, double) {
        if (stage == 2)
          act(a, z);
        else if (!is_remembered)
          kernels.remember(arrays(), a, z);
      });
    };
    blocks.run(2, work, [](int) {});
  }

  // What is left of the overlap of a pair, r.
  double left(int k) const { return residual[k] * pairs->length; }
  LineTilts tilts;
  double memory_usage() const;

 private:
  struct Evaluation {
    double forces = 0.0, largest = 0.0;    // imbalance, force
    double usual = 0.0;                    // imbalance, but for that of a few blocks
    double norm2 = 0.0, weights = 0.0;     // see Residuals
    double slope = 0.0;                    // of the dual energy along the step, where it began
    bool exists = false;                   // every ring has a shape
    bool knows_torques = false;
    double torques = 0.0;    // imbalance of tilts
    double worst() const { return std::max(forces, torques); }
    double relative() const { return worst() > 0.0 ? worst() / largest : 0.0; }
  };

  const deformable::ForceKernels &kernels;
  ForceCorrector corrector;
  PairRelaxation relaxation;
  NearPairs *pairs = nullptr;
  ForceBatches *batches = nullptr;
  RemoteSides *remote = nullptr;

  // by pair
  LargeVector<float> residual, weight, step;    // see PairArrays

  deformable::Extrapolation extrapolation{};
  const deformable::PairPlaces *unlocated = nullptr;    // of pairs that are to be located
  bool is_apart = true;                                 // lines of this rank
  void make_room();
  void move(double from, double to) { move(from, to, 0, pairs->size); }
  void move(double from, double to, int begin, int end);

  bigint last_step = -2;
  static constexpr int ENOUGH = 3, MOST = 4;    // past forces for a prediction
  int consecutive_calls = 0;                    // at successive steps before this one, up to MOST
  bool predicts() const { return consecutive_calls >= ENOUGH; }
  bool minimizing() const;
  deformable::Extrapolation find_extrapolation() const;
  bool first_solution = true;    // of this call
  bool is_remembered = false;    // the present forces are the past ones
  static constexpr double LOOSE =
      1e-7;    // larger tolerances leave errors that matter for predictions
  bool must_correct = false;
  double pairs_of_all = 1.0;    // ranks

  void agree();
  deformable::PairArrays arrays();
  Evaluation evaluate();
  Evaluation evaluate_and_correct();
  double find_torques();
  int begin_corrections(const Evaluation &);
  double typical_of(const Evaluation &) const;
  double accuracy_of(const Evaluation &) const;
  double coarse = 0.003;    // accuracy of the first correction of a call
  int tries_coarse = 0;     // calls that still use it
  int failures = 0;         // of fine ones, one after the other
  double accuracy_of_first() const;
  void learn_from_first(double left, bool all_were_corrected);
  bool is_balanced(Evaluation &);
  Evaluation correct(const Evaluation &);
  bool relax_some(Evaluation &);
  bool has_relaxed = false;    // some, in this call
  int in_vain = 0;             // relaxations one after the other, since the pairs are new
  bool correct_some(Evaluation &);
  void hold_others(const BlockLevels::Choice &);
  Evaluation accept(Evaluation now, const Evaluation &from, bool iterated, bool turns);
  Evaluation line_search(Evaluation now, const Evaluation &from, bool turned);

  // What a run through the blocks may do: places and first forces of the pairs, new shapes of the rings, what is left of
  // overlaps then; relaxation of a few pairs, after WAIT if LOOK was in the same run (a block waits there until those two
  // away have looked), new shapes of their rings; an iteration of the corrector, the step of all forces, and shapes after a
  // small one.
  enum class Stage { LOCATE, SHAPE, LOOK, WAIT, RELAX, TURN, CORRECT, STEP, ADAPT };
  Evaluation run(const std::vector<Stage> &, Evaluation *before = nullptr,
                 const BlockLevels::Choice * = nullptr);
  Evaluation sum_up(int first, bool exist) const;
  Stage shape_after(const Evaluation &) const;
  struct OfBlock : deformable::Residuals {
    double slope = 0.0;
  };
  // of this call, after the relaxation before the correction; until that is known, of the last call: the correction is
  // planned from it
  Evaluation first_evaluation;
  bool needs_correction = false;
  int local_corrections = 0;    // of this call
  BlockLevels blocks;
  std::vector<OfBlock> of_blocks;
  mutable std::vector<double> errors;    // of the blocks

  template <class Sum> double sum_over_pairs(Sum &&sum) const;
};

}    // namespace LAMMPS_NS

#endif
