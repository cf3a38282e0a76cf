#include "styles/pair/compute_deformable_contact.h"

#include "styles/lammps_release.h"
#include "styles/pair/pair_deformable.h"

#include "domain.h"
#include "error.h"
#include "update.h"

using namespace LAMMPS_NS;
using namespace deformable;

ComputeDeformableContact::ComputeDeformableContact(LAMMPS *lmp, int narg, char **arg)
    : ComputeDeformableContact(lmp, narg, arg,
                               PairDeformable::contact_columns(lmp->domain->dimension))
{
  if (narg > 3)
    error->all(FLERR_WORD(3), "Unknown compute deformable/contact argument '{}': it takes none",
               arg[3]);
}

ComputeDeformableContact::ComputeDeformableContact(LAMMPS *lmp, int narg, char **arg, int columns)
    : Compute(lmp, narg, arg)
{
  local_flag = 1;
  size_local_rows = 0;
  size_local_cols = columns;
}

void ComputeDeformableContact::init()
{
  pairs = require_deformable_pairs(lmp, fmt::format("Compute {} {}", id, style));
}

/* ----------------------------------------------------------------------
   A variable may ask between runs, when the pair style of the last one is gone.
------------------------------------------------------------------------- */

void ComputeDeformableContact::compute_local()
{
  if (deformable_pairs(*force) != pairs)
    error->all(FLERR,
               "Compute {} {}: the pair style is another one since the last run, use 'run 0' first",
               id, style);
  invoked_local = update->ntimestep;
  values.clear();
  for (const PairDeformable *pair : pairs) list(*pair, values);
  size_local_rows = static_cast<int>(values.size()) / size_local_cols;
  rows.resize(size_local_rows + 1);
  for (int r = 0; r < size_local_rows; ++r) rows[r] = &values[r * size_local_cols];
  array_local = rows.data();
}

void ComputeDeformableContact::list(const PairDeformable &pair, std::vector<double> &numbers) const
{
  pair.list_contacts(groupbit, numbers);
}

double ComputeDeformableContact::memory_usage()
{
  return bytes_of(values, rows);
}
