#include "pair_deformable_ring.h"

#include "contact.h"
#include "support.h"

#include "error.h"
#include "neighbor.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using namespace deformable;

/* ---------------------------------------------------------------------- */

void PairDeformableRing::settings(int narg, char **arg)
{
  reach = 0.1;
  for (int iarg = 0; iarg < narg; iarg += 2) {
    if (std::strcmp(arg[iarg], "reach") != 0)
      error->all(FLERR, iarg, "Unknown pair_style deformable/ring keyword '{}': it knows 'reach'",
                 arg[iarg]);
    if (iarg + 1 == narg) utils::missing_cmd_args(FLERR, "pair_style deformable/ring reach", error);
    reach = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
    if (!(reach > 0.0))
      error->all(FLERR, iarg + 1, "pair_style deformable/ring reach {} must be positive",
                 arg[iarg + 1]);
  }
}

/* ---------------------------------------------------------------------- */

void PairDeformableRing::check_species(const Species &s) const
{
  if (!std::isinf(s.stiffness.kP))
    error->all(FLERR,
               "Pair style deformable/ring conserves the perimeter: it needs kP = inf and a "
               "finite kA, but species {} has kA = {} and kP = {}",
               s.name, s.stiffness.kA, s.stiffness.kP);
}

/* ----------------------------------------------------------------------
   an outline that bulges by less than depth meets no line that is not a
   candidate: those of the types present lie at least as far out as at the
   cutoff
------------------------------------------------------------------------- */

void PairDeformableRing::init_style()
{
  PairDeformable::init_style();

  std::vector<int> here(radius.size(), 0), present(radius.size(), 0);
  for (int i = 0; i < atom->nlocal; ++i) here[atom->type[i]] = 1;
  MPI_Allreduce(here.data(), present.data(), static_cast<int>(here.size()), MPI_INT, MPI_MAX,
                world);

  depth.assign(radius.size(), 0.0);
  for (std::size_t i = 1; i < radius.size(); ++i) {
    depth[i] = reach * radius[i];    // walls
    for (std::size_t j = 1; j < radius.size(); ++j) {
      if (!present[j] || radius[j] == 0.0) continue;
      const double cutoff = (1.0 + reach) * (radius[i] + radius[j]);
      depth[i] = std::min(depth[i],
                          -contact_line(cutoff, 1.0 / cutoff, radius[i], radius[j]).indentation_i);
    }
  }
}

/* ---------------------------------------------------------------------- */

void PairDeformableRing::compute(int eflag, int vflag)
{
  if (walls.empty())
    evaluate<false>(eflag, vflag);
  else
    evaluate<true>(eflag, vflag);
}

/* ---------------------------------------------------------------------- */

template <bool WALLS> void PairDeformableRing::evaluate(int eflag, int vflag)
{
  const bool new_list = neighbor->ago == 0;
  begin_call(eflag, vflag);
  for_each_particle<WALLS>([&](int i, const Contacts &contacts) {
    const int type = atom->type[i];
    char *const carries =
        carried.of(i, contacts.size, [](char *first, char *last) { std::fill(first, last, 0); });
    ring_shape(radius[type], contacts, carries, programme, shape);
    if (shape.area_deficit == 0.0) return store_circle(i);

    const Energy energy = harmonic(species[type].stiffness.kA, shape.area_deficit);
    apply<WALLS>(i, contacts, energy);
    store_shape(i, contacts, energy.derivative);
    if (new_list) check_reach(i, contacts);
  });
  end_call();
}

/* ---------------------------------------------------------------------- */

void PairDeformableRing::check_reach(int i, const Contacts &contacts)
{
  const int type = atom->type[i];
  const double ratio = ring_bulge(radius[type], contacts, shape) / depth[type];
  if (ratio > 1.0)
    error->one(FLERR,
               "The outline of atom {} bulges by {:.4g}, {:.3g} times as far as 'reach {}' looks "
               "for neighbors: use a reach of {:.2g} or more",
               atom->tag[i], ratio * depth[type], ratio, reach, 1.2 * ratio * reach);
  if (ratio > bulge_over_reach) bulge_over_reach = ratio;
}
