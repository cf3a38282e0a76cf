// The order in which the solver goes through the rings: block by block, several times through near blocks before it comes
// to those far away. So memory is read once for many iterations.
//
// An iteration of a block may need the last one of the blocks that it has contacts with, and no others.

#ifndef DEFORMABLE_BLOCK_LEVELS_H
#define DEFORMABLE_BLOCK_LEVELS_H

#include "solver/contact_batches.h"
#include "solver/near_pairs.h"

#include <algorithm>
#include <vector>

namespace deformable {

class BlockLevels {
 public:
  // Finds which blocks have contacts with each other, or with rings of other ranks.
  void arrange(const ContactBatches &, const NearPairs &);

  int count() const { return static_cast<int>(level.size()); }

  // begin and end of the batches of a block
  void choose(RingBatches &, int block) const;

  // act(begin, end, part) for the pairs whose first ring is in the block; part: 1/2 for pairs of two ranks, or 1.
  template <class Act> void for_pairs(int block, Act &&act) const
  {
    for (int part = 0; part < PARTS; ++part) {
      const int begin = first_pair[part][block], end = first_pair[part][block + 1];
      if (begin < end) act(begin, end, part == REMOTE ? 0.5 : 1.0);
    }
  }

  // visit(other) for the blocks that have contacts with this one.
  template <class Visit> void for_neighbors(int block, Visit &&visit) const
  {
    for (int n = first[block]; n < first[block + 1]; ++n) visit(neighbors[n]);
  }

  static int of_ring(int ring) { return ring / ContactBatches::BLOCK; }

  // work(block, iteration) for all blocks and iterations from 1 to `last`, for DualSolver the stages of a sweep; exchange(iteration)
  // between ranks after each one but the last. First comes what other ranks wait for, and what that needs.
  template <class Work, class Exchange> void run(int last, Work &&work, Exchange &&exchange)
  {
    std::fill(level.begin(), level.end(), 0);
    for (int next = 1; next < last; ++next) {
      for (const int k : borders)
        if (level[k] < next) raise(k, work);
      exchange(next);
    }
    // Wavefront order: a group of iterations on a chunk of blocks, then the next group; what they go through at once stays in
    // the processor's own cache. Both sizes hardly matter: [2, 8].
    constexpr int GROUP = 4, CHUNK = 4;
    const int groups = (last + GROUP - 1) / GROUP, chunks = (count() + CHUNK - 1) / CHUNK;
    for (int turn = 0; turn < chunks + groups - 1; ++turn)
      for (int group = std::max(0, turn - chunks + 1); group <= std::min(turn, groups - 1);
           ++group) {
        const int begin = CHUNK * (turn - group), end = std::min(count(), begin + CHUNK);
        for (int k = begin; k < end; ++k)
          while (level[k] < std::min(last, GROUP * (group + 1))) raise(k, work);
      }
  }

  double bytes() const
  {
    return bytes_of(first, neighbors, borders, level, first_pair[0], first_pair[1], first_pair[2]);
  }

 private:
  enum { WITHIN, REMOTE, WALLS, PARTS };    // of the pairs, in the order of KnownPairs
  std::vector<int> first, neighbors;        // of each block
  std::vector<int> borders;                 // blocks with contacts of other ranks
  std::vector<int> level;                   // the last iteration of each block
  int batches = 0;
  std::vector<int> first_pair[PARTS];    // of each block, and the end

  template <class Work> void raise(int k, Work &work)
  {
    for (int n = first[k]; n < first[k + 1]; ++n)
      if (level[neighbors[n]] < level[k]) raise(neighbors[n], work);
    work(k, ++level[k]);
  }
};

}    // namespace deformable

#endif
