// Undeformed radii: of the species, or, with `radius atom`, of each atom by itself.

#include "pair_deformable.h"

#include "error.h"

#include <limits>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void PairDeformable::set_radius(int iarg, char **arg)
{
  const std::string whose = arg[iarg];
  if (whose != "type" && whose != "atom")
    error->all(FLERR, iarg, "Radius '{}' of a deformable pair style is neither 'type' nor 'atom'",
               whose);
  radius_by_atom = whose == "atom";
}

/* ----------------------------------------------------------------------
   Radii may be set between runs and change in a run, but not beyond what
   neighbors are sought for. Data files keep 16 digits of them.
------------------------------------------------------------------------- */

void PairDeformable::check_radii()
{
  constexpr double ROUNDING = 1.0 + 1e-12;
  int largest = -1;    // of those that are too large
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    const double r = atom_radius[i];
    const Species &s = species[atom->type[i]];
    if (r > s.skin && r <= s.radius * ROUNDING) continue;
    if (!(r > 0.0))
      error->one(FLERR, "Atom {} has a radius of {:.6g}: it must be positive", atom->tag[i], r);
    if (r <= s.skin)
      error->one(FLERR,
                 "Atom {} has a radius of {:.6g}: it must be larger than the skin of species {}, "
                 "which is {}",
                 atom->tag[i], r, s.name, s.skin);
    if (largest < 0 || r > atom_radius[largest]) largest = i;
  }
  if (largest < 0) return;
  const Species &s = species[atom->type[largest]];
  error->one(FLERR,
             "Atom {} has a radius of {:.6g}, but species {} allows for {} at most: give it the "
             "largest radius of its atoms in the species file",
             atom->tag[largest], atom_radius[largest], s.name, s.radius);
}

/* ---------------------------------------------------------------------- */

double PairDeformable::smallest_radius() const
{
  double here = std::numeric_limits<double>::infinity(), smallest;
  for (int ii = 0; ii < list->inum; ++ii) here = std::min(here, radius_of(list->ilist[ii]));
  MPI_Allreduce(&here, &smallest, 1, MPI_DOUBLE, MPI_MIN, world);
  return smallest;
}
