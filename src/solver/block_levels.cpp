#include "solver/block_levels.h"

#include <algorithm>

namespace deformable {

static constexpr int BATCHES = ContactBatches::BLOCK / LANES;

void BlockLevels::arrange(const ContactBatches &b, const NearPairs &pairs)
{
  batches = b.batches;
  const int blocks = (batches + BATCHES - 1) / BATCHES;
  std::vector<int> end(blocks);    // of the contacts
  for (int k = 0; k < blocks; ++k) end[k] = b.first[std::min((k + 1) * BATCHES, batches)];
  first.assign(1, 0);
  neighbors.clear();
  is_remote.clear();
  of_thread.clear();
  level.assign(blocks, 0);
  std::vector<int> seen_by(blocks, -1);
  for (int k = 0, c = 0; k < blocks; ++k) {
    bool is_border = false;
    seen_by[k] = k;
    for (; c < end[k]; ++c) {
      const int partner = b.partner[c];
      is_border |= partner >= b.contacts && partner != b.none();
      if (partner >= b.contacts || (partner < end[k] && partner >= c))
        continue;    // most: in this block
      const auto found = std::upper_bound(end.begin(), end.end(), partner);
      const int other = static_cast<int>(found - end.begin());
      if (seen_by[other] == k) continue;
      seen_by[other] = k;
      neighbors.push_back(other);
    }
    is_remote.push_back(is_border);
    first.push_back(static_cast<int>(neighbors.size()));
  }

  const int begin_of[PARTS + 1] = {0, pairs.remote, pairs.wall, pairs.size};
  for (int part = 0; part < PARTS; ++part) {
    std::vector<int> &of = first_pair[part];
    int k = begin_of[part];
    of.assign(1, k);
    for (int block = 0; block < blocks; ++block) {
      while (k < begin_of[part + 1] && b.place[pairs.i[k]] < (block + 1) * ContactBatches::BLOCK)
        ++k;
      of.push_back(k);
    }
  }
}

void BlockLevels::divide(int parts)
{
  of_thread.resize(parts);
  has_remote = std::find(is_remote.begin(), is_remote.end(), 1) != is_remote.end();
  waits = has_remote;
  for (int n = 0; n < parts; ++n) {
    Part &part = of_thread[n];
    part = {count() * n / parts, count() * (n + 1) / parts, {}};
    for (int k = part.begin; k < part.end; ++k) {
      bool is_border = is_remote[k];
      for_neighbors(k, [&](int other) { is_border |= other < part.begin || other >= part.end; });
      if (is_border) part.borders.push_back(k);
    }
    waits |= !part.borders.empty();
  }
}

void BlockLevels::choose(RingBatches &rings, int block) const
{
  rings.begin = block * BATCHES;
  rings.end = std::min(rings.begin + BATCHES, batches);
}

}    // namespace deformable
