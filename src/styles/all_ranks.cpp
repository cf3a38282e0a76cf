#include "styles/all_ranks.h"

#include "comm.h"
#include "lammps.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <iterator>

namespace deformable {

std::vector<double> of_all_ranks(LAMMPS *lmp, std::vector<double> here)
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

static void combine_two(void *in, void *in_and_out, int *count, MPI_Datatype *)
{
  const auto *const from = static_cast<const LargestAndSums *>(in);
  auto *const to = static_cast<LargestAndSums *>(in_and_out);
  for (int n = 0; n < *count; ++n) {
    for (std::size_t k = 0; k < std::size(to->largest); ++k)
      to[n].largest[k] = std::max(to[n].largest[k], from[n].largest[k]);
    for (std::size_t k = 0; k < std::size(to->sum); ++k) to[n].sum[k] += from[n].sum[k];
  }
}

// Its type and operation live as long as the process: LAMMPS may be closed after MPI has ended.
void combine_ranks(MPI_Comm world, LargestAndSums *each, int count)
{
  static const MPI_Datatype type = [] {
    MPI_Datatype made;
    MPI_Type_contiguous(sizeof(LargestAndSums) / sizeof(double), MPI_DOUBLE, &made);
    MPI_Type_commit(&made);
    return made;
  }();
  static const MPI_Op operation = [] {
    MPI_Op made;
    MPI_Op_create(combine_two, 1, &made);
    return made;
  }();
  MPI_Allreduce(MPI_IN_PLACE, each, count, type, operation, world);
}

int ranks_of_machine(MPI_Comm world)
{
  int ranks;
#if defined(MPI_VERSION) && MPI_VERSION >= 3
  MPI_Comm machine;
  MPI_Comm_split_type(world, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  MPI_Comm_size(machine, &ranks);
  MPI_Comm_free(&machine);
#else
  MPI_Comm_size(world, &ranks);
#endif
  return ranks;
}

bool read_file(LAMMPS *lmp, const std::string &path, std::string &bytes)
{
  int size = -1;
  bytes.clear();
  errno = ENOENT;
  if (FILE *fp = path.empty() ? nullptr : std::fopen(path.c_str(), "rb")) {
    char buffer[4096];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, fp)) bytes.append(buffer, n);
    // fopen opens a folder too, which cannot be read
    if (!std::ferror(fp)) size = static_cast<int>(bytes.size());
    std::fclose(fp);
  }
  MPI_Bcast(&size, 1, MPI_INT, 0, lmp->world);
  if (size < 0) return false;
  bytes.resize(size);
  MPI_Bcast(bytes.data(), size, MPI_CHAR, 0, lmp->world);
  return true;
}

std::string environment(LAMMPS *lmp, const char *name)
{
  const char *const given = std::getenv(name);
  std::string value = given ? given : "";
  int size = static_cast<int>(value.size());
  MPI_Bcast(&size, 1, MPI_INT, 0, lmp->world);
  value.resize(size);
  MPI_Bcast(value.data(), size, MPI_CHAR, 0, lmp->world);
  return value;
}

}    // namespace deformable
