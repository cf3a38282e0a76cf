// Self-propulsion along directions that diffuse: fix ID group deformable/propel f tau seed

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/propel,FixDeformablePropel);
// clang-format on
#else

#ifndef DEFORMABLE_FIX_DEFORMABLE_PROPEL_H
#define DEFORMABLE_FIX_DEFORMABLE_PROPEL_H

#include "styles/memory/fix_memory.h"

#include <cstdint>
#include <vector>

namespace LAMMPS_NS {

// It remembers the components of directions, which are unit vectors; 0 of a particle that has none yet.
class FixDeformablePropel : public deformable::FixMemory<double> {
 public:
  FixDeformablePropel(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup(int) override;
  void post_force(int) override;

  void grow_arrays(int) override;

 private:
  double strength, persistence;
  std::uint64_t seed;
  std::vector<double *> rows;    // see array_atom

  void push(double persisted);
  double *direction_of(int i);
};

}    // namespace LAMMPS_NS

#endif
#endif
