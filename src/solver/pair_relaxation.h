// Pairs that are far from balance, relaxed one by one.
//
// Forces are predicted well but where a contact opens or closes: there they are a thousand times worse than elsewhere. What
// balances such a pair decays within a few rings. So those pairs take a step each, again and again, until they are about as
// good as the others, before all are corrected together. That is the method of Gauss and Seidel only where something is
// left to do (R. V. Southwell, Relaxation Methods in Engineering Science, 1940).

#ifndef DEFORMABLE_PAIR_RELAXATION_H
#define DEFORMABLE_PAIR_RELAXATION_H

#include "solver/block_levels.h"
#include "solver/contact_batches.h"
#include "solver/near_pairs.h"
#include "solver/tuning.h"

#include <vector>

namespace deformable {

class PairRelaxation {
 public:
  void arrange(const ContactBatches &, const NearPairs &);    // contacts are new

  // Before a sweep. Pairs are relaxed whose imbalance is above a limit, which is such that they are about the same part of all pairs
  // in each call. Those that are far off, where the first order is not enough, are left to Newton's method, which knows when it goes
  // astray. Returns whether there may be anything between these limits, the same on all ranks.
  bool begin(const Tuning &, double tolerance, double largest_force);

  // Relaxes the pairs whose first ring is in the block, then those that this brings out of balance. Rings of a batch do not change if
  // one of them touches a ring of another rank, which would not learn of it. Forces and residuals are those after that, to first
  // order in the changes of forces, which are added to steps.
  void relax(int block, const ForceKernels &, const BlockLevels &, const NearPairs &,
             const ContactBatches &, const PairArrays &);

  // act(batches) for those of a block that have changed since the last time.
  template <class Act> void for_changed(RingBatches block, Act &&act)
  {
    const int end = block.end;
    for (int batch = block.begin; batch < end; ++batch) {
      if (!is_changed[batch]) continue;
      is_changed[batch] = 0;
      block.begin = batch;
      block.end = batch + 1;
      act(block);
    }
  }

  double bytes() const
  {
    return bytes_of(waiting, is_free, is_changed) + static_cast<double>(waits.size() / 8);
  }

 private:
  double limit = 0.0, most = 0.0;       // smaller and larger imbalances stay
  double crowd = 0.0, of_ring = 0.0;    // see Tuning
  double tolerances = 0.0;              // limit, 0: at first
  std::size_t relaxed = 0;              // pairs in the last sweep
  int pairs = 0;

  std::vector<int> waiting;                 // pairs
  std::vector<bool> waits;                  // by pair
  std::vector<char> is_free, is_changed;    // by batch

  void change_particle(const ContactBatches &, const PairArrays &, int ring, int contact, float by);
  void wait_for(const PairArrays &, int pair);
};

}    // namespace deformable

#endif
