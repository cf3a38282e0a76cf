// Draws the lines of a compute deformable/outline in dump image, which asks fixes only in all releases of LAMMPS. The compute
// makes it, with its own ID and group: fix ID group deformable/outline

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/outline,FixDeformableOutline);
// clang-format on
#else

#ifndef DEFORMABLE_FIX_DEFORMABLE_OUTLINE_H
#define DEFORMABLE_FIX_DEFORMABLE_OUTLINE_H

#include "fix.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

class FixDeformableOutline : public Fix {
 public:
  FixDeformableOutline(class LAMMPS *, int, char **);

  int setmask() override { return 0; }
  int image(int *&, double **&) override;

 private:
  std::vector<int> kinds;
  std::vector<std::array<double, 7>> lines;    // type of the atom, both ends
  std::vector<double *> rows;
};

}    // namespace LAMMPS_NS

#endif
#endif
