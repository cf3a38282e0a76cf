// The deformable pair styles of a run, for the compute and the fixes that need them.

#ifndef LMP_DEFORMABLE_PAIRS_H
#define LMP_DEFORMABLE_PAIRS_H

#include "styles/pair/pair_deformable.h"

#include "force.h"

#include <vector>

namespace LAMMPS_NS {

// The pair style itself, or those within a hybrid one, in its order. By type: others, such as deformable/edge, have names that
// begin alike.
inline std::vector<PairDeformable *> deformable_pairs(Force &force)
{
  std::vector<PairDeformable *> found;
  const auto add = [&found](Pair *pair) {
    if (auto *const deformable = dynamic_cast<PairDeformable *>(pair)) found.push_back(deformable);
    return pair != nullptr;
  };
  constexpr const char *NAMES = "^deformable/";
  if (add(force.pair_match(NAMES, 0))) return found;    // the only one of these names
  for (int n = 1; add(force.pair_match(NAMES, 0, n));) ++n;
  return found;
}

}    // namespace LAMMPS_NS

#endif
