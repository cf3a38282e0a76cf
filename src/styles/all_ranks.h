// Numbers of all ranks, on all of them. MPI of LAMMPS' stubs takes no constants: these functions take copies.

#ifndef DEFORMABLE_ALL_RANKS_H
#define DEFORMABLE_ALL_RANKS_H

#include "lmptype.h"
#include "styles/lammps_names.h"

#include <string>
#include <type_traits>
#include <vector>

namespace deformable {

// Number: double, int or tagint.
template <class Number> Number reduced(MPI_Comm world, Number here, MPI_Op operation)
{
  const MPI_Datatype type = std::is_same<Number, double>::value ? MPI_DOUBLE
                            : sizeof(Number) == sizeof(int)     ? MPI_INT
                                                                : MPI_LMP_BIGINT;
  Number all;
  MPI_Allreduce(&here, &all, 1, type, operation, world);
  return all;
}

template <class Number> Number sum_of_ranks(MPI_Comm world, Number here)
{
  return reduced(world, here, MPI_SUM);
}
template <class Number> Number largest_of_ranks(MPI_Comm world, Number here)
{
  return reduced(world, here, MPI_MAX);
}
template <class Number> Number smallest_of_ranks(MPI_Comm world, Number here)
{
  return reduced(world, here, MPI_MIN);
}

// Combined over ranks in one message, in place.
struct LargestAndSums {
  double largest[5] = {}, sum[3] = {};
};
void combine_ranks(MPI_Comm world, LargestAndSums *each, int count);

// How many ranks share this machine.
int ranks_of_machine(MPI_Comm world);

// The numbers of one rank after the other.
std::vector<double> of_all_ranks(LAMMPS *, std::vector<double> here);

// What is in a file, which rank 0 reads; the other ranks need no path. Returns false on all ranks if it cannot be read; then errno
// of rank 0 says why.
bool read_file(LAMMPS *, const std::string &path, std::string &bytes);

// A variable of the environment of rank 0, which all ranks follow; empty if it is not set.
std::string environment(LAMMPS *, const char *name);

}    // namespace deformable

#endif
