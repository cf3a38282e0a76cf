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

/* ----------------------------------------------------------------------
   an outline that bulges by less than depth meets no line that is not a
   candidate: those of the types present lie at least as far out as at the
   cutoff
------------------------------------------------------------------------- */

void PairDeformableRing::init_style()
{
  PairDeformable::init_style();

  soft = false;
  for (const Species &s : species) soft |= s.radius > 0.0 && !s.stiffness.conserves_perimeter();

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
    soft ? evaluate<false, true>(eflag, vflag) : evaluate<false, false>(eflag, vflag);
  else
    soft ? evaluate<true, true>(eflag, vflag) : evaluate<true, false>(eflag, vflag);
}

/* ---------------------------------------------------------------------- */

template <bool WALLS, bool SOFT> void PairDeformableRing::evaluate(int eflag, int vflag)
{
  const bool new_list = neighbor->ago == 0;
  begin_call(eflag, vflag);
  for_each_particle<WALLS>([&](int i, const Contacts &contacts) {
    const int type = atom->type[i];
    char *const carries =
        carried.of(i, contacts.size, [](char *first, char *last) { std::fill(first, last, 0); });
    Energy energy;
    if (SOFT && !species[type].stiffness.conserves_perimeter()) {
      energy = soften(i, contacts, carries);
    } else {
      ring_shape(ring_radius[type], contacts, carries, programme, shape);
      energy = harmonic(species[type].stiffness.kA, shape.area_deficit);
    }
    if (energy.derivative == 0.0) return store_circle(i);

    apply<WALLS>(i, contacts, energy);
    store_shape(i, contacts, energy.derivative);
    if (new_list) check_reach(i, contacts);
  });
  end_call();
}

/* ---------------------------------------------------------------------- */

Energy PairDeformableRing::soften(int i, const Contacts &contacts, char *carries)
{
  const int type = atom->type[i];
  Energy energy;
  if (!soft_ring_shape(ring_radius[type], species[type].stiffness, contacts, carries, programme,
                       shape, energy))
    error->one(FLERR,
               "Atom {} has no shape that keeps its area: its {} contacts leave no room. Compress "
               "less, or give species {} a finite kA",
               atom->tag[i], contacts.size, species[type].name);
  return energy;
}

/* ----------------------------------------------------------------------
   the outline reaches out of the undeformed circle where it bulges and
   because the whole ring has moved out
------------------------------------------------------------------------- */

void PairDeformableRing::check_reach(int i, const Contacts &contacts)
{
  const int type = atom->type[i];
  const double breath = shape.perimeter_excess / (2.0 * PI);
  const double ratio = (breath + ring_bulge(ring_radius[type], contacts, shape)) / depth[type];
  if (ratio > 1.0)
    error->one(FLERR,
               "The outline of atom {} bulges by {:.4g}, {:.3g} times as far as 'reach {}' looks "
               "for neighbors: use a reach of {:.2g} or more",
               atom->tag[i], ratio * depth[type], ratio, reach, 1.2 * ratio * reach);
  if (ratio > bulge_over_reach) bulge_over_reach = ratio;
}
