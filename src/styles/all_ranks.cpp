#include "styles/all_ranks.h"

#include "comm.h"
#include "lammps.h"

using namespace LAMMPS_NS;

std::vector<double> LAMMPS_NS::of_all_ranks(LAMMPS *lmp, std::vector<double> here)
{
  const int ranks = lmp->comm->nprocs;
  int count = static_cast<int>(here.size());
  std::vector<int> counts(ranks), first(ranks + 1, 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, lmp->world);
  for (int r = 0; r < ranks; ++r) first[r + 1] = first[r] + counts[r];
  std::vector<double> all(first[ranks]);
  MPI_Allgatherv(here.data(), count, MPI_DOUBLE, all.data(), counts.data(), first.data(),
                 MPI_DOUBLE, lmp->world);
  return all;
}
