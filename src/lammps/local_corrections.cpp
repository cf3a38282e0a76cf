// Corrections of the forces only where they are not balanced.
//
// Where a contact opens or closes, or a ring bears hardly anything, the imbalance is many times that of all others. What
// corrects it decays within a few rings. So such pairs are relaxed; if that is not enough, their blocks and the neighbors
// of these are corrected on their own, with the forces on all others held.

#include "force_solver.h"

#include "comm.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

// In motion, once in a call, if the typical imbalance is well below the tolerance and the largest one not far above it. False:
// nothing has changed. Beside other ranks nothing may change, so there it would often be in vain.
bool ForceSolver::relax_some(Evaluation &now)
{
  constexpr double LITTLE = 100.0, ENOUGH = 0.3, USUAL = 0.3;    // times the tolerance
  constexpr int TRIES = 3;
  const double limit = tolerance * now.largest;
  if (!devices.relax_after || has_relaxed || in_vain == TRIES || !predicts() || minimizing() || pairs->tilts ||
      evaluations + 2 >= max_evaluations || !now.exists || now.forces <= limit ||
      now.forces > LITTLE * limit || typical_of(now) > USUAL * limit)
    return false;
  has_relaxed = true;
  BlockLevels::Choice chosen(blocks.count());
  for (int k = 0; k < blocks.count(); ++k) chosen[k] = of_blocks[k].error > limit;
  relaxation.go_on(ENOUGH * limit, now.largest, chosen);
  blocks.widen(chosen);    // these rings may change
  blocks.widen(chosen);    // their pairs have new residuals
  now = run({Stage::RELAX, Stage::TURN, Stage::LOOK}, nullptr, &chosen);
  in_vain = now.forces <= limit ? 0 : in_vain + 1;
  return true;
}

// False: all have to be corrected. The state may be another one then too.
bool ForceSolver::correct_some(Evaluation &now)
{
  constexpr double FEW = 0.25, NO_WORSE = 2.0;
  constexpr int OFTEN = 4;
  const double limit = tolerance * now.largest;
  if (!devices.local || local_corrections == OFTEN || evaluations + 2 >= max_evaluations ||
      !corrector.knows_bounds() || pairs->tilts || !now.exists || now.forces <= limit ||
      now.norm2 == 0.0)    // only rings without force touch
    return false;
  BlockLevels::Choice chosen(blocks.count());
  for (int k = 0; k < blocks.count(); ++k) chosen[k] = of_blocks[k].error > limit;
  blocks.widen(chosen);
  int many = std::count(chosen.begin(), chosen.end(), 1) > FEW * blocks.count();
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, &many, 1, MPI_INT, MPI_MAX, world);
  if (many) return false;

  ++local_corrections;
  const Evaluation from = now;
  hold_others(chosen);
  for (OfBlock &of : of_blocks) of.slope = 0.0;
  std::vector<Stage> stages(corrector.plan(accuracy_of(from)), Stage::CORRECT);
  stages.insert(stages.end(), {Stage::STEP, shape_after(from)});
  const Evaluation stepped = run(stages, nullptr, &chosen);
  remote->exchange(pairs->side[0].data() + pairs->remote, batches->contacts,
                   batches->indentation.data(), batches->compliance.data());
  BlockLevels::Choice seen = chosen;
  blocks.widen(seen);
  blocks.add_borders(seen);
  now = run({Stage::LOOK}, nullptr, &seen);
  now.exists &= stepped.exists;
  const double most = corrector.largest_slope(from.norm2) * pairs->length * pairs->unit();
  if (now.exists && stepped.slope > 0.0 && stepped.slope <= most &&
      now.forces <= NO_WORSE * from.forces)
    return true;
  for (int block = 0; block < blocks.count(); ++block)
    if (chosen[block])
      blocks.for_pairs(block, [this](int begin, int end, double) { move(1.0, 0.0, begin, end); });
  now = evaluate();
  local_corrections = OFTEN;
  return false;
}

// Pairs with rings of other blocks take no part: no step changes them, and the products of the other rings, which nobody
// finds, vanish.
void ForceSolver::hold_others(const BlockLevels::Choice &chosen)
{
  const NearPairs &p = *pairs;
  const ForceBatches &b = *batches;
  const deformable::RingBatches all = batches->arrays();
  deformable::RingBatches here = all;
  const auto is_chosen = [&](int particle) {
    return chosen[BlockLevels::of_ring(b.place[particle])] != 0;
  };
  const auto drop_product = [&](int contact) {
    for (const int k : {0, 1}) ForceCorrector::products(all, k)[contact] = 0.0F;
  };
  // of other ranks, as their contacts
  std::vector<double> are_chosen(comm->nprocs > 1 ? b.indentation.size() : 0);
  const int *const side = p.side[0].data();
  for (int k = p.remote; k < p.wall; ++k) are_chosen[side[k]] = is_chosen(p.i[k]);
  remote->exchange(side + p.remote, b.contacts, are_chosen.data());
  for (int k = p.remote; k < p.wall; ++k)
    if (!is_chosen(p.i[k])) drop_product(side[k]);
  for (int block = 0; block < blocks.count(); ++block) {
    if (!chosen[block]) continue;
    blocks.choose(here, block);
    for (int c = here.first[here.begin]; c < here.first[here.end]; ++c) {
      const int k = b.seat[c] >> 1;
      if (k >= p.wall) continue;
      if (k >= p.remote ? are_chosen[b.partner[c]] != 0.0
                        : is_chosen(b.seat[c] & 1 ? p.i[k] : p.second(k)))
        continue;
      residual[k] = step[k] = 0.0F;
      weight[k] = -std::fabs(weight[k]);
      drop_product(b.partner[c]);
    }
  }
}
