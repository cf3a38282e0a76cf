// Corrections of the forces only where they are not balanced.
//
// Where a contact opens or closes, or a ring bears hardly anything, the imbalance is many times that of all others. What
// corrects it decays within a few rings. So its block and the neighbors of that are corrected on their own, with the forces
// on all others held.

#include "solver/block_pipeline.h"

#include "comm.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

bool BlockPipeline::are_few(double limit, BlockLevels::Choice &chosen) const
{
  constexpr double FEW = 0.25;
  chosen.assign(blocks.count(), 0);
  for (int k = 0; k < blocks.count(); ++k) chosen[k] = of_blocks[k].error > limit;
  blocks.widen(chosen);
  const bool many = std::count(chosen.begin(), chosen.end(), 1) > FEW * blocks.count();
  return remote->largest(many) == 0.0;
}

Evaluation BlockPipeline::run_alone(const BlockLevels::Choice &chosen, const Stages &stages)
{
  hold_others(chosen);
  for (OfBlock &of : of_blocks) of.slope = 0.0;
  const Evaluation stepped = run(stages, nullptr, &chosen);
  remote->exchange(pairs->side[0].data() + pairs->remote, batches->contacts,
                   batches->indentation.data(), batches->compliance.data());
  BlockLevels::Choice seen = chosen;
  blocks.widen(seen);
  blocks.add_borders(seen);
  Evaluation now = run({Stage::LOOK}, nullptr, &seen);
  now.exists &= stepped.exists;
  now.slope = stepped.slope;
  return now;
}

void BlockPipeline::take_back(const BlockLevels::Choice &chosen)
{
  for (int block = 0; block < blocks.count(); ++block)
    if (chosen[block])
      blocks.for_pairs(block, [this](int begin, int end, double) { move(1.0, 0.0, begin, end); });
}

// Pairs with rings of other blocks take no part: no step changes them, and the products of the other rings, which nobody
// finds, vanish.
void BlockPipeline::hold_others(const BlockLevels::Choice &chosen)
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
