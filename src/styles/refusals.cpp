#include "styles/refusals.h"

#include "comm.h"
#include "error.h"

#include <utility>

using namespace LAMMPS_NS;

void Refusals::agree()
{
  int here = any_here(), anywhere = here;
  if (comm->nprocs > 1) MPI_Allreduce(&here, &anywhere, 1, MPI_INT, MPI_MAX, world);
  if (anywhere) stop();
}

void Refusals::stop()
{
  std::string told = std::exchange(message, {});
  int first = told.empty() ? comm->nprocs : comm->me, size = static_cast<int>(told.size());
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, world);
  MPI_Bcast(&size, 1, MPI_INT, first, world);
  told.resize(size);
  MPI_Bcast(told.data(), size, MPI_CHAR, first, world);
  error->all(FLERR, told);
}
