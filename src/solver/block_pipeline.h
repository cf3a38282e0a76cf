// What happens to rings and pairs in a force call, stage by stage, block by block. A block runs ahead of those far away
// (BlockLevels), so memory is read once for a whole correction.

#ifndef LMP_BLOCK_PIPELINE_H
#define LMP_BLOCK_PIPELINE_H

#include "pointers.h"

#include "solver/block_levels.h"
#include "solver/force_batches.h"
#include "solver/force_corrector.h"
#include "solver/near_pairs.h"
#include "solver/pair_relaxation.h"
#include "solver/remote_sides.h"

#include <algorithm>
#include <vector>

namespace LAMMPS_NS {

// What is found in all rings and pairs with their present forces.
struct Evaluation {
  double imbalance = 0.0, force = 0.0;    // the largest ones of a pair
  double norm2 = 0.0, weights = 0.0;      // see deformable::Residuals
  double slope = 0.0;        // of the dual energy along the last step, where that began
  bool exists = false;       // every ring has a shape
  double of_lines = -1.0;    // the largest imbalance of a line, CurvedLines; negative: not known
  double worst() const { return std::max(imbalance, of_lines); }
};

class BlockPipeline : protected Pointers {
 public:
  enum class Stage {
    SHAPE,      // rings, for the forces of their pairs
    ADAPT,      // the same after a small step
    LOOK,       // what is left of overlaps
    WAIT,       // until the blocks that are two away have looked, whose pairs RELAX may change
    RELAX,      // a few pairs that are far from balance
    TURN,       // shapes of the rings of those
    CORRECT,    // an iteration of the corrector
    STEP        // all forces take their corrections
  };
  using Stages = std::vector<Stage>;

  BlockPipeline(class LAMMPS *lmp, const deformable::ForceKernels &kernels)
      : Pointers(lmp),
        corrector(kernels),
        kernels(kernels)
  {
  }

  ForceCorrector corrector;
  PairRelaxation relaxation;
  int evaluations = 0;    // of the call: shapes of all rings, and what is left of the overlaps then

  void arrange(ForceBatches &, NearPairs &, RemoteSides &);    // contacts are new
  void begin_call();                                           // units may be new

  // First forces, and how the present ones become past ones.
  void extrapolate(const deformable::Extrapolation &);
  void take_past();
  void start_from_nothing();
  void remember() { remember(0, pairs->size); }

  // Both ranks of a pair take the mean of their overlaps and of their first forces.
  void agree();

  // Returns what the last stage LOOK has found in all blocks; the one before the corrections, unless null. If only some
  // blocks are chosen, the others stay as they are.
  Evaluation run(const Stages &, Evaluation *before = nullptr,
                 const BlockLevels::Choice *chosen = nullptr);
  Evaluation evaluate() { return run({Stage::SHAPE, Stage::LOOK}); }

  // Prepares corrections to this accuracy. Returns how many iterations are left for `run`: none after conjugate gradients,
  // which find the bounds of the spectrum.
  int begin_corrections(const Evaluation &, double accuracy);

  // Corrections of a few blocks (local_corrections.cpp). Chooses those with larger imbalances than this one and their
  // neighbors, and whether they are few on each rank; such a correction, by stages without a look; back before it.
  bool are_few(double limit, BlockLevels::Choice &chosen) const;
  Evaluation run_alone(const BlockLevels::Choice &, const Stages &);
  void take_back(const BlockLevels::Choice &);

  // Along the last step, from this part of it to that one; the slope of the dual energy at its end.
  void move(double from, double to) { move(from, to, 0, pairs->size); }
  double slope_at_end();
  // A step of each pair for itself, instead of Newton's method. Returns the slope where it begins.
  double step_alone();

  // act(begin, end) for all pairs, whose rings then have the slopes of their outlines. Unless they are remembered, forces
  // become past ones.
  template <class Act> void finish(bool are_remembered, Act &&act)
  {
    deformable::RingBatches here = batches->arrays();
    const auto work = [&](int block, int stage) {
      blocks.choose(here, block);
      if (stage == 1 && !pairs->curved)    // those have slopes
        kernels.slopes(here, pairs->directions(), {});
      blocks.for_pairs(block, [&](int begin, int end, double) {
        if (stage == 2)
          act(begin, end);
        else if (!are_remembered)
          remember(begin, end);
      });
    };
    blocks.run(2, work, [](int) {});
  }

  deformable::PairArrays arrays();
  double left(int k) const { return residual[k] * pairs->length; }    // r
  double imbalance_per_pair(const Evaluation &) const;                // a typical one
  double unit_of_energy() const { return pairs->length * pairs->unit(); }
  double bytes() const;

 private:
  const deformable::ForceKernels &kernels;
  NearPairs *pairs = nullptr;
  ForceBatches *batches = nullptr;
  RemoteSides *remote = nullptr;
  double pairs_of_all = 1.0;    // ranks
  BlockLevels blocks;

  LargeVector<float> residual, weight, step;    // by pair, see PairArrays
  void make_room();
  void remember(int begin, int end) { kernels.remember(arrays(), begin, end); }

  struct OfBlock : deformable::Residuals {
    double slope = 0.0;
    void add(const deformable::Residuals &, double part);
  };
  std::vector<OfBlock> of_blocks;
  void work(Stage, int block, int iteration, deformable::RingBatches &, OfBlock &, bool &exist);
  Evaluation sum_up(int first, bool exist) const;
  void hold_others(const BlockLevels::Choice &);
  void move(double from, double to, int begin, int end);

  // Pairs that two ranks share count half on each.
  template <class Sum> double sum_over_pairs(Sum &&sum) const
  {
    return remote->sum(sum(0, pairs->remote) + 0.5 * sum(pairs->remote, pairs->wall) +
                       sum(pairs->wall, pairs->size));
  }
};

}    // namespace LAMMPS_NS

#endif
