#include "styles/pair/compute_deformable_outline.h"

#include "styles/lammps_release.h"
#include "styles/pair/fix_deformable_outline.h"
#include "styles/pair/pair_deformable.h"

#include "domain.h"
#include "error.h"
#include "modify.h"

#include <string>

using namespace LAMMPS_NS;
using namespace deformable;

ComputeDeformableOutline::ComputeDeformableOutline(LAMMPS *lmp, int narg, char **arg)
    : ComputeDeformableContact(lmp, narg, arg, PairDeformable::OUTLINE_COLUMNS)
{
  if (domain->dimension != 2)
    error->all(FLERR,
               "Compute {} deformable/outline is two-dimensional: in three dimensions compute "
               "deformable/contact lists the facets of droplets",
               id);
  for (int iarg = 3; iarg < narg; iarg += 2) {
    if (std::string(arg[iarg]) != "points")
      error->all(FLERR_WORD(iarg),
                 "Unknown compute deformable/outline keyword '{}': it must be 'points'", arg[iarg]);
    if (iarg + 1 >= narg)
      utils::missing_cmd_args(FLERR, "compute deformable/outline points", error);
    points = utils::inumeric(FLERR, arg[iarg + 1], false, lmp);
    if (points < 1)
      error->all(FLERR_WORD(iarg + 1), "Compute deformable/outline: points is '{}': give 1 or more",
                 arg[iarg + 1]);
  }
  if (modify->get_fix_by_id(id))
    error->all(
        FLERR,
        "Compute {0} deformable/outline defines a fix of the same ID, which dump image draws, "
        "but there is a fix {0}",
        id);
  picture = modify->add_fix(fmt::format("{} {} {}", id, arg[1], STYLE));
}

// LAMMPS at its end deletes fixes first.
ComputeDeformableOutline::~ComputeDeformableOutline()
{
  if (modify->nfix && modify->get_fix_by_id(id) == picture) modify->delete_fix(id);
}

void ComputeDeformableOutline::list(const PairDeformable &pair, std::vector<double> &numbers) const
{
  pair.list_outlines(groupbit, points, numbers);
}
