// What ForceSolver does to the rings and pairs, stage by stage, and what it learns from that.

#include "force_solver.h"

#include "comm.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using deformable::PairArrays;

ForceSolver::Evaluation ForceSolver::evaluate()
{
  std::vector<Stage> stages = {Stage::SHAPE, Stage::LOOK};
  if (unlocated) stages.insert(stages.begin(), Stage::LOCATE);
  return run(stages);
}

// Returns what the last stage LOOK has found in all blocks; the one before it, unless null. If only some blocks are chosen,
// the others stay as they are.
ForceSolver::Evaluation ForceSolver::run(const std::vector<Stage> &stages, Evaluation *before,
                                         const BlockLevels::Choice *chosen)
{
  batches->clear_none();
  const deformable::RingBatches rings = batches->arrays();
  deformable::RingBatches here = rings;    // of the block that has its turn
  const PairArrays loop = arrays();
  const int last = static_cast<int>(stages.size());
  const int corrections =
      static_cast<int>(std::count(stages.begin(), stages.end(), Stage::CORRECT));
  const int first = static_cast<int>(std::find(stages.begin(), stages.end(), Stage::CORRECT) -
                                     stages.begin());    // from 0; stages count from 1
  of_blocks.resize((before ? 2 : 1) * blocks.count());
  for (std::size_t block = 0; block < of_blocks.size(); ++block)
    if (!chosen || (*chosen)[block]) of_blocks[block] = {};
  bool exist = true;
  blocks.run(
      last,
      [&](int block, int stage) {
        const bool is_before = before && stage <= first;
        OfBlock &found = of_blocks[is_before ? blocks.count() + block : block];
        blocks.choose(here, block);
        switch (stages[stage - 1]) {
          case Stage::LOCATE:
            blocks.for_pairs(block, [&](int a, int z, double) {
              if (a >= pairs->remote) return;
              is_apart &= kernels.locate(*unlocated, a, z);
              kernels.extrapolate(loop, extrapolation, a, z);
            });
            break;
          case Stage::WAIT: break;
          case Stage::RELAX:
            found = {};
            relaxation.relax(block, kernels, blocks, *pairs, *batches, loop);
            break;
          case Stage::TURN:
            relaxation.take_turned(here, [&](const deformable::RingBatches &turned) {
              exist &= kernels.shape(turned, pairs->directions());
            });
            break;
          case Stage::CORRECT: corrector.iterate(here, loop, stage - first); break;
          case Stage::STEP:
            blocks.for_pairs(block, [&](int a, int z, double part) {
              found.slope += part * kernels.take_step(loop, false, a, z);
            });
            break;
          case Stage::SHAPE: exist &= kernels.shape(here, pairs->directions()); break;
          case Stage::ADAPT:
            exist &= kernels.adapt(here, pairs->force.data(), step.data(), loop.unit);
            break;
          case Stage::LOOK:
            blocks.for_pairs(block, [&](int a, int z, double part) {
              const deformable::Residuals r = kernels.find_residuals(loop, a, z);
              found.error = std::max(found.error, r.error);
              found.force = std::max(found.force, r.force);
              found.left = std::max(found.left, r.left);
              found.norm2 += part * r.norm2;
              found.weights += part * r.weights;
            });
        }
      },
      [&](int stage) {
        const int *const side = pairs->side[0].data() + pairs->remote;
        const Stage done = stages[stage - 1];
        if (done == Stage::CORRECT && stage < first + corrections)
          remote->exchange(side, batches->contacts, ForceCorrector::products(rings, stage - first));
        else if (done == Stage::SHAPE || done == Stage::ADAPT)
          remote->exchange(side, batches->contacts, batches->indentation.data(),
                           batches->compliance.data());
      },
      chosen);
  if (stages.back() == Stage::LOOK) ++evaluations;
  if (before) *before = sum_up(blocks.count(), true);
  return sum_up(0, exist);
}

// What the blocks have found, from this place on.
ForceSolver::Evaluation ForceSolver::sum_up(int first, bool exist) const
{
  constexpr double FEW = 0.02;
  double largest[5] = {0.0, 0.0, 0.0, exist ? 0.0 : 1.0, 0.0}, sum[3] = {0.0, 0.0, 0.0};
  errors.clear();
  for (int block = 0; block < blocks.count(); ++block) {
    const OfBlock &found = of_blocks[first + block];
    errors.push_back(found.error);
    largest[0] = std::max(largest[0], found.error);
    largest[1] = std::max(largest[1], found.force);
    largest[2] = std::max(largest[2], found.left);
    sum[0] += found.norm2;
    sum[1] += found.weights;
    sum[2] += found.slope;
  }
  if (!devices.quantile) largest[4] = largest[0];
  if (!errors.empty() && devices.quantile) {
    const auto usual = errors.end() - 1 - static_cast<int>(FEW * errors.size());
    std::nth_element(errors.begin(), usual, errors.end());
    largest[4] = *usual;
  }
  if (comm->nprocs > 1) {
    MPI_Allreduce(MPI_IN_PLACE, largest, 5, MPI_DOUBLE, MPI_MAX, world);
    MPI_Allreduce(MPI_IN_PLACE, sum, 3, MPI_DOUBLE, MPI_SUM, world);
  }
  // Overlaps are not known better than this.
  constexpr double ROUNDING = 8.0 * std::numeric_limits<double>::epsilon();
  Evaluation now;
  now.forces = largest[2] <= ROUNDING ? 0.0 : largest[0];
  now.largest = std::max(largest[1], std::isinf(largest[2]) ? largest[2] : 0.0);
  now.exists = largest[3] == 0.0 && std::isfinite(now.largest);
  now.usual = largest[4];
  now.norm2 = sum[0];
  now.weights = sum[1];
  now.slope = sum[2];
  return now;
}

// The largest imbalance of a tilt for the present forces. Also finds the next tilts.
double ForceSolver::find_torques()
{
  kernels.slopes(batches->arrays(), pairs->directions(), tilts.rates());
  remote->exchange(pairs->side[0].data() + pairs->remote, batches->contacts, batches->slope.data(),
                   tilts.rates());
  double worst = tilts.find(*pairs, *batches, kernels);
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MAX, world);
  return worst;
}
