// What fix deformable/friction takes along: to other indices and ranks, into restart files, and from ghosts back.

#include "fix_deformable_friction.h"

#include "vector_bytes.h"

#include "atom.h"
#include "comm.h"

#include <algorithm>
#include <cstdio>

using namespace LAMMPS_NS;

double FixDeformableFriction::memory_usage()
{
  return memory.bytes() + bytes_of(values, rows);
}

void FixDeformableFriction::grow_arrays(int size)
{
  memory.resize(size);
}

void FixDeformableFriction::copy_arrays(int from, int to, int /*delflag*/)
{
  memory.copy(from, to);
}

void FixDeformableFriction::set_arrays(int i)
{
  memory.clear(i);
}

void FixDeformableFriction::make_room(int i)
{
  maxexchange = std::max(maxexchange, memory.size(i));
}

/* ---------------------------------------------------------------------- */

int FixDeformableFriction::pack_exchange(int i, double *buffer)
{
  return memory.pack(i, buffer);
}

int FixDeformableFriction::unpack_exchange(int i, double *buffer)
{
  const int size = memory.unpack(i, buffer);
  make_room(i);
  return size;
}

int FixDeformableFriction::pack_restart(int i, double *buffer)
{
  return memory.pack(i, buffer);
}

// Atom::extra has the numbers of all fixes, one after the other; each begins with its size.
void FixDeformableFriction::unpack_restart(int i, int fix)
{
  const double *numbers = atom->extra[i];
  for (int n = 0; n < fix; ++n) numbers += static_cast<int>(numbers[0]);
  memory.unpack(i, numbers);
  make_room(i);
}

int FixDeformableFriction::size_restart(int i)
{
  return memory.size(i);
}

// Of all ranks: the first one tells those that read the file how much room they need.
int FixDeformableFriction::maxsize_restart()
{
  int most = 1, of_all;
  for (int i = 0; i < atom->nlocal; ++i) most = std::max(most, memory.size(i));
  MPI_Allreduce(&most, &of_all, 1, MPI_INT, MPI_MAX, world);
  return of_all;
}

/* ----------------------------------------------------------------------
   What was lost so far goes on with rank 0.
------------------------------------------------------------------------- */

void FixDeformableFriction::write_restart(FILE *file)
{
  double sums[OUTPUTS];
  MPI_Allreduce(output, sums, OUTPUTS, MPI_DOUBLE, MPI_SUM, world);
  if (comm->me != 0) return;
  const int bytes = sizeof sums;
  std::fwrite(&bytes, sizeof bytes, 1, file);
  std::fwrite(sums, sizeof(double), OUTPUTS, file);
}

void FixDeformableFriction::restart(char *buffer)
{
  if (comm->me == 0) std::copy_n(reinterpret_cast<const double *>(buffer), OUTPUTS, output);
}

/* ----------------------------------------------------------------------
   Stresses of particles, also of those that are ghosts here.
------------------------------------------------------------------------- */

int FixDeformableFriction::pack_reverse_comm(int n, int first, double *buffer)
{
  for (int i = first; i < first + n; ++i) buffer = std::copy_n(vatom[i], 6, buffer);
  return 6 * n;
}

void FixDeformableFriction::unpack_reverse_comm(int n, int *list, double *buffer)
{
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < 6; ++c) vatom[list[k]][c] += *buffer++;
}
