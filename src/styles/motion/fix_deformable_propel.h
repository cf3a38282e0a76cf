// Self-propulsion along directions that diffuse: fix ID group deformable/propel f tau seed

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/propel,FixDeformablePropel);
// clang-format on
#else

#ifndef LMP_FIX_DEFORMABLE_PROPEL_H
#define LMP_FIX_DEFORMABLE_PROPEL_H

#include "fix.h"

#include <cstdint>

namespace LAMMPS_NS {

class FixDeformablePropel : public Fix {
 public:
  FixDeformablePropel(class LAMMPS *, int, char **);
  ~FixDeformablePropel() override;

  int setmask() override;
  void init() override;
  void setup(int) override;
  void post_force(int) override;

  double memory_usage() override;
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;

 private:
  double strength, persistence;
  std::uint64_t seed;
  double **directions = nullptr;    // unit vectors; (0, 0) of a particle that has none yet

  void push(double angle_per_deviation);
  double *direction_of(int i);
};

}    // namespace LAMMPS_NS

#endif
#endif
