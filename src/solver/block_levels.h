// The order in which the solver goes through the rings: block by block, several times through near blocks before it comes
// to those far away. So memory is read once for many iterations.
//
// An iteration of a block may need the last one of the blocks that it has contacts with, and no others. Each thread has a range of
// blocks. Those with contacts to blocks of other threads, or to rings of other ranks, are its borders: they wait for each other.

#ifndef DEFORMABLE_BLOCK_LEVELS_H
#define DEFORMABLE_BLOCK_LEVELS_H

#include "solver/contact_batches.h"
#include "solver/near_pairs.h"
#include "solver/threads.h"

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

  // work(block, iteration, thread) for all blocks and iterations from 1 to `last`, for DualSolver the stages of a sweep;
  // exchange(iteration) between ranks after each one but the last, by the caller's thread. First comes what other threads and ranks
  // wait for, and what that needs.
  template <class Work, class Exchange>
  void run(Threads &threads, int last, Work &&work, Exchange &&exchange)
  {
    if (threads.count() != parts()) divide(threads.count());
    std::fill(level.begin(), level.end(), 0);
    threads.run([&](int thread) {
      const auto on_thread = [&](int block, int iteration) { work(block, iteration, thread); };
      const Part &part = of_thread[thread];
      for (int next = 1; next < last && waits; ++next) {
        for (const int k : part.borders)
          if (level[k] < next) raise(k, part, on_thread);
        threads.wait_for_all();
        if (!has_remote) continue;
        if (thread == 0) exchange(next);
        threads.wait_for_all();
      }
      go_through(part, last, on_thread);
    });
  }

  double bytes() const
  {
    return bytes_of(first, neighbors, is_remote, level, first_pair[0], first_pair[1],
                    first_pair[2]);
  }

 private:
  enum { WITHIN, REMOTE, WALLS, PARTS };    // of the pairs, in the order of KnownPairs
  std::vector<int> first, neighbors;        // of each block
  std::vector<char> is_remote;              // blocks with contacts of other ranks
  std::vector<int> level;                   // the last iteration of each block
  int batches = 0;
  std::vector<int> first_pair[PARTS];    // of each block, and the end

  struct Part {
    int begin, end;
    std::vector<int> borders;
  };
  std::vector<Part> of_thread;
  bool has_remote = false, waits = false;    // whether any block does; whether there are borders
  int parts() const { return static_cast<int>(of_thread.size()); }
  void divide(int parts);

  template <class Work> void raise(int k, const Part &part, Work &work)
  {
    for (int n = first[k]; n < first[k + 1]; ++n) {
      const int other = neighbors[n];
      const bool is_own = part.begin <= other && other < part.end;
      if (is_own && level[other] < level[k]) raise(other, part, work);
    }
    work(k, ++level[k]);
  }

  // Wavefront order: a group of iterations on a chunk of blocks, then the next group; what they go through at once stays in the
  // processor's own cache. Both sizes hardly matter: [2, 8].
  template <class Work> void go_through(const Part &part, int last, Work &work)
  {
    constexpr int GROUP = 4, CHUNK = 4;
    const int groups = (last + GROUP - 1) / GROUP,
              chunks = (part.end - part.begin + CHUNK - 1) / CHUNK;
    for (int turn = 0; turn < chunks + groups - 1; ++turn)
      for (int group = std::max(0, turn - chunks + 1); group <= std::min(turn, groups - 1);
           ++group) {
        const int begin = part.begin + CHUNK * (turn - group),
                  end = std::min(part.end, begin + CHUNK);
        for (int k = begin; k < end; ++k)
          while (level[k] < std::min(last, GROUP * (group + 1))) raise(k, part, work);
      }
  }
};

}    // namespace deformable

#endif
