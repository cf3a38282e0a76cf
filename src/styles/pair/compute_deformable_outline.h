// The outlines of the deformable pair styles as lines, for dump local and dump image:
// compute ID group deformable/outline [points N]

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(deformable/outline,ComputeDeformableOutline);
// clang-format on
#else

#ifndef DEFORMABLE_COMPUTE_DEFORMABLE_OUTLINE_H
#define DEFORMABLE_COMPUTE_DEFORMABLE_OUTLINE_H

#include "styles/pair/compute_deformable_contact.h"

#include <vector>

namespace LAMMPS_NS {

class ComputeDeformableOutline : public ComputeDeformableContact {
 public:
  ComputeDeformableOutline(class LAMMPS *, int, char **);
  ~ComputeDeformableOutline() override;
  static constexpr const char *STYLE = "deformable/outline";

 protected:
  void list(const class PairDeformable &, std::vector<double> &numbers) const override;

 private:
  int points = 180;    // of a whole turn
  class Fix *picture = nullptr;
};

}    // namespace LAMMPS_NS

#endif
#endif
