// What fix deformable/friction takes along: to other indices and ranks, into restart files, and from ghosts back.

#include "fix_deformable_friction.h"

#include "vector_bytes.h"

#include "atom.h"
#include "comm.h"
#include "error.h"

#include <algorithm>
#include <cstdio>
#include <string>

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
   The same from a text: fix_modify ID springs none, or springs I J x y xi f_t f_d ...,
   and fix_modify ID lost E_sliding E_dashpots E_damping
------------------------------------------------------------------------- */

int FixDeformableFriction::modify_param(int narg, char **arg)
{
  constexpr int LOSSES = 3, WORDS = 7;
  const std::string word = arg[0];
  const auto number = [&](int n) { return utils::numeric(FLERR, arg[n], false, lmp); };
  if (word == "lost" && narg > LOSSES) {
    for (int n = 0; n < LOSSES; ++n) output[SLIDING + n] = comm->me == 0 ? number(1 + n) : 0.0;
    return 1 + LOSSES;
  }
  if (word != "springs" || narg < 2) return 0;
  if (narg == 2 && std::string(arg[1]) == "none") {
    for (int i = 0; i < atom->nlocal; ++i) memory.clear(i);
    return narg;
  }
  if ((narg - 1) % WORDS)
    error->all(FLERR,
               "fix_modify {} springs: expected 'none', or {} numbers for each contact, not {} "
               "words",
               id, WORDS, narg - 1);
  find_partners();
  for (int n = 1; n < narg; n += WORDS) {
    double words[WORDS];
    for (int k = 0; k < WORDS; ++k) words[k] = number(n + k);
    give_spring(words);
  }
  return narg;
}

void FixDeformableFriction::give_spring(const double *words)
{
  const int i = atom->map(static_cast<tagint>(words[0]));
  if (i < 0 || i >= atom->nlocal) return;    // another rank has it
  ContactPlace place = {};
  place.x = words[2];
  place.y = words[3];
  RememberedContact &m = memory.add(i, words[1], 0.0, place);
  m.xi = words[4];
  m.force = words[5];
  m.damping = words[6];
  make_room(i);
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
