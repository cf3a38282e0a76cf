// Forces of pairs that outlive a neighbor list, after which particles have other indices and other ranks.

#ifndef LMP_FORCE_HISTORY_H
#define LMP_FORCE_HISTORY_H

#include "solver/near_pairs.h"

#include "lmptype.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

class ForceHistory {
 public:
  void reserve(std::size_t pairs, std::size_t particles)
  {
    entries.reserve(pairs);
    bulges.reserve(particles);
  }

  // Particle `tag` and a partner have borne these forces: another particle at the relative position (x, y, z), or a
  // wall of this code < 0.
  void add(tagint tag, tagint partner, double x, double y, const PastForces &past, double z = 0.0)
  {
    entries.push_back(entry_of(tag, partner, x, y, z, past));
  }
  void add_bulge(tagint tag, double bulge) { bulges.push_back({tag, bulge}); }
  void sort()
  {
    std::sort(entries.begin(), entries.end());
    std::sort(bulges.begin(), bulges.end());
  }

  // A particle in a small box may have several images of its partner: the one nearest to (x, y, z) counts. Nothing is
  // known if there is none within the distance that (x, y, z) itself has.
  PastForces find(tagint tag, tagint partner, double x, double y, double z = 0.0) const;

  // Negative if it is not known.
  double bulge(tagint tag) const;

  double bytes() const { return bytes_of(entries, bulges); }

 private:
  // of a pair, from the particle with the smaller tag
  struct Entry {
    tagint tag, partner;
    float x, y, z;    // sufficient to tell images apart
    PastForces past;
    bool operator<(const Entry &other) const
    {
      return tag != other.tag ? tag < other.tag : partner < other.partner;
    }
  };
  static Entry entry_of(tagint tag, tagint partner, double x, double y, double z,
                        const PastForces &past)
  {
    const float fx = static_cast<float>(x), fy = static_cast<float>(y), fz = static_cast<float>(z);
    if (partner < 0 || tag < partner) return {tag, partner, fx, fy, fz, past};
    return {partner, tag, -fx, -fy, -fz, past.from_second()};
  }
  std::vector<Entry> entries;
  std::vector<std::pair<tagint, double>> bulges;
};

}    // namespace LAMMPS_NS

#endif
