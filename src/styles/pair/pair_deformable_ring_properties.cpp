// Stiffness and line tension of single particles: the custom properties d_kA and d_tension of fix property/atom.

#include "styles/pair/pair_deformable_ring.h"

#include "styles/lammps_release.h"
#include "styles/refusals.h"

#include "laws/parameter_rules.h"

#include "error.h"

#include <algorithm>

using namespace LAMMPS_NS;
using namespace deformable;

/* ---------------------------------------------------------------------- */

int PairDeformableRing::property_of_atoms(const std::string &name) const
{
  int is_double = 0, columns = 0;
  const int index = atom->find_custom(name.c_str(), is_double, columns);
  if (index < 0 || !is_double || columns > 0)
    error->all(
        FLERR,
        "pair_style deformable/ring {0} atom needs a value of each particle: use 'fix ID all "
        "property/atom d_{0}', and give values by 'set' or a data file",
        name);
  return index;
}

// Fixes may have come and gone since the last run.
void PairDeformableRing::find_properties()
{
  if (kA_by_atom) kA_of_atoms = property_of_atoms("kA");
  if (tension_by_atom) tension_of_atoms = property_of_atoms("tension");
}

/* ----------------------------------------------------------------------
   The rules of species files, for each particle, as values may change at any
   time.
------------------------------------------------------------------------- */

void PairDeformableRing::check_properties()
{
  std::vector<double> adhesion(species.size(), 0.0);    // the largest one of a type
  for (std::size_t i = 1; i < species.size() && adhesions.any(); ++i)
    for (std::size_t j = 1; j < species.size(); ++j)
      adhesion[i] = std::max(adhesion[i], adhesions.between(i, j));
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    const Stiffness k = stiffness_of(i);
    const Species &s = materials.species_of(i);
    std::string wrong = invalid_stiffness(k);
    if (wrong.empty()) wrong = unstable_radius(ring_radius_of(i), k);
    if (wrong.empty()) wrong = invalid_for_adhesion(adhesion[atom->type[i]], k, s.skin);
    if (wrong.empty()) continue;
    refuse("Atom {} of species {}: {} ({} of fix property/atom)", atom->tag[i], s.name, wrong,
           kA_by_atom ? tension_by_atom ? "d_kA and d_tension" : "d_kA" : "d_tension");
  }
}
