// Prints the commit that an installed LAMMPS was built from.

#include <lammps/lammps.h>

#include <cstdio>

int main()
{
  std::fputs(LAMMPS_NS::LAMMPS::git_descriptor(), stdout);
}
