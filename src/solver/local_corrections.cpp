// Corrections of a few blocks of particles, as DualSolver makes them with straight lines. Where a contact opens or closes, or a
// particle bears hardly anything, the imbalance is many times that of all others, and what corrects it decays within a few
// particles. So its block and the neighbors of that are corrected on their own, with the forces on all others held.

#include "solver/dual_solver.h"

#include "comm.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace deformable {

// False: all have to be corrected, and `now` may have been evaluated again.
bool DualSolver::correct_some(Evaluation &now)
{
  constexpr int OFTEN = 4;
  if (local_corrections == OFTEN || summary.evaluations + 2 >= allowed || lines ||
      !linear.knows_bounds() || !now.exists || now.imbalance <= limit(now) ||
      now.norm2 == 0.0)    // only particles without force touch
    return false;
  BlockLevels::Choice chosen(blocks.count());
  for (int k = 0; k < blocks.count(); ++k) chosen[k] = of_blocks[k].error > limit(now);
  blocks.widen(chosen);
  const bool many = std::count(chosen.begin(), chosen.end(), 1) > tuning.few * blocks.count();
  if (list.remote_sides.largest(many) > 0.0) return false;

  ++local_corrections;
  const Evaluation from = now;
  Steps steps;
  add_solution(steps, linear.plan(accuracy(from)));
  steps.insert(steps.end(), {Stage::STEP, shape_after(from)});
  hold_others(chosen);
  for (OfBlock &of : of_blocks) of.slope = 0.0;
  const Evaluation stepped = run(steps, nullptr, &chosen);
  BlockLevels::Choice seen = chosen;
  if (has_facets()) {
    exchange_facets();
    blocks.widen(seen);
    blocks.add_borders(seen);
    run({Stage::TILT}, nullptr, &seen);
  }
  list.remote_sides.exchange(batches.indentation.data(), batches.compliance.data());
  blocks.widen(seen);
  blocks.add_borders(seen);
  now = run({Stage::RESIDUAL}, nullptr, &seen);
  now.exists &= stepped.exists;
  now.slope = stepped.slope;
  if (now.exists && linear.is_sound(now.slope, from.norm2 * unit_of_energy()) &&
      now.imbalance <= NO_WORSE * from.imbalance)
    return true;
  for (int block = 0; block < blocks.count(); ++block)
    if (chosen[block])
      blocks.for_pairs(block, [this](int begin, int end, double) { move(1.0, 0.0, begin, end); });
  now = evaluate();
  local_corrections = OFTEN;
  return false;
}

// Pairs with particles of other blocks take no part: no step changes them. The products of the other particles are set to 0,
// because nobody computes them.
void DualSolver::hold_others(const BlockLevels::Choice &chosen)
{
  const NearPairs &p = list.pairs;
  const ContactBatches &b = batches;
  const RingBatches all = batches.arrays();
  const auto is_chosen = [&](int particle) {
    return chosen[BlockLevels::of_ring(b.place[particle])] != 0;
  };
  const auto drop_product = [&](int contact) {
    for (const int k : {0, 1}) LinearSolver::products(all, k)[contact] = 0.0F;
  };
  // of other ranks, as their contacts
  std::vector<double> are_chosen(comm->nprocs > 1 ? b.indentation.size() : 0);
  const int *const side = p.side[0].data();
  for (int k = p.remote; k < p.wall; ++k) are_chosen[side[k]] = is_chosen(p.i[k]);
  list.remote_sides.exchange(are_chosen.data());
  for (int k = p.remote; k < p.wall; ++k)
    if (!is_chosen(p.i[k])) drop_product(side[k]);
  for (int c = 0; c < b.contacts; ++c) {
    const int k = b.pair_side[c] >> 1;
    if (k >= p.wall || !is_chosen(b.pair_side[c] & 1 ? p.second(k) : p.i[k])) continue;
    if (k >= p.remote ? are_chosen[b.partner[c]] != 0.0
                      : is_chosen(b.pair_side[c] & 1 ? p.i[k] : p.second(k)))
      continue;
    residual[k] = step[k] = 0.0F;
    weight[k] = -std::fabs(weight[k]);
    drop_product(b.partner[c]);
  }
}

}    // namespace deformable
