// The headers that LAMMPS 4Jul2026 installs lack this one, which its variable.h includes. Behind LAMMPS' own in the search path.

#ifndef LMP_SAFE_POINTERS_H
#define LMP_SAFE_POINTERS_H

#include <cstdio>

namespace LAMMPS_NS {

class SafeFilePtr {
 public:
  SafeFilePtr() = default;
  ~SafeFilePtr();    // in LAMMPS

 private:
  FILE *fp = nullptr;
  bool use_pclose = false;
};

}    // namespace LAMMPS_NS

#endif
