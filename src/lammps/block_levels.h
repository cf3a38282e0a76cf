// The order in which an iteration goes through blocks of rings: several times through near ones, before it comes to
// those far away. So memory is read once for many iterations.
//
// An iteration of a block needs the last one of its neighbors, and no more than that.

#ifndef DEFORMABLE_BLOCK_LEVELS_H
#define DEFORMABLE_BLOCK_LEVELS_H

#include "force_batches.h"
#include "vector_bytes.h"

#include <algorithm>
#include <vector>

namespace LAMMPS_NS {

class BlockLevels {
 public:
  static constexpr int BATCHES = ForceBatches::BLOCK / deformable::LANES;

  // Finds which blocks have contacts with each other, or with rings of other ranks.
  void arrange(const ForceBatches &b)
  {
    const int blocks = (b.batches + BATCHES - 1) / BATCHES;
    std::vector<int> end(blocks);    // of the contacts
    for (int k = 0; k < blocks; ++k) end[k] = b.first[std::min((k + 1) * BATCHES, b.batches)];
    first.assign(1, 0);
    neighbors.clear();
    borders.clear();
    std::vector<int> seen_by(blocks, -1);
    for (int k = 0, c = 0; k < blocks; ++k) {
      bool is_border = false;
      seen_by[k] = k;
      for (; c < end[k]; ++c) {
        is_border |= b.partner[c] >= b.contacts;
        if (b.partner[c] >= b.contacts) continue;
        const int other =
            static_cast<int>(std::upper_bound(end.begin(), end.end(), b.partner[c]) - end.begin());
        if (seen_by[other] == k) continue;
        seen_by[other] = k;
        neighbors.push_back(other);
      }
      if (is_border) borders.push_back(k);
      first.push_back(static_cast<int>(neighbors.size()));
    }
  }

  // work(block, iteration) for all blocks and iterations from 1 to `last`; after each one but the last, exchange(it)
  // between ranks.
  template <class Work, class Exchange> void run(int last, Work &&work, Exchange &&exchange)
  {
    const int blocks = static_cast<int>(first.size()) - 1;
    level.assign(blocks, 0);
    for (int next = 1; next < last; ++next) {
      for (const int k : borders)
        if (level[k] < next) raise(k, work);
      exchange(next);
    }
    for (int k = 0; k < blocks; ++k)
      while (level[k] < last) raise(k, work);
  }

  double bytes() const { return bytes_of(first, neighbors, borders, level); }

 private:
  std::vector<int> first, neighbors;    // of each block
  std::vector<int> borders;             // blocks with contacts of other ranks
  std::vector<int> level;               // the last iteration of each block

  template <class Work> void raise(int k, Work &work)
  {
    for (int n = first[k]; n < first[k + 1]; ++n)
      if (level[neighbors[n]] < level[k]) raise(neighbors[n], work);
    work(k, ++level[k]);
  }
};

}    // namespace LAMMPS_NS

#endif
