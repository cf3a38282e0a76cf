#include "polygons/edge_checks.h"

#include "styles/refusals.h"

#include "atom.h"
#include "force.h"
#include "group.h"
#include "lammps.h"
#include "neighbor.h"

using namespace LAMMPS_NS;

namespace {

/* ----------------------------------------------------------------------
   Partners along a polygon have no contacts. Others come from bonds between
   polygons. The factors are those in a call: pair_style hybrid may set its own.
------------------------------------------------------------------------- */

void check_special_bonds(LAMMPS *lmp, const PolygonEdges &edges, const std::string &style)
{
  const Atom *atom = lmp->atom;
  const double *factors = lmp->force->special_lj;
  if (atom->molecular != Atom::MOLECULAR) return;
  for (int i = 0; i < atom->nlocal; ++i) {
    const int polygon = edges[i].polygon;
    if (polygon < 0) continue;
    for (int k = 1, n = 0; k <= 3; ++k)    // 1-2, 1-3 and 1-4 partners
      for (; n < atom->nspecial[i][k - 1]; ++n) {
        if (factors[k] == 1.0) continue;
        const tagint partner = atom->special[i][n];
        const int other = edges.polygon_of(partner, polygon);
        if (other >= 0 && other != polygon)
          refuse("{}: special_bonds gives atoms {} and {} of polygons {} and {} the factor "
                 "{:.6g}, but contacts are not scaled: use 'special_bonds lj/coul 1 1 1'",
                 style, atom->tag[i], partner, edges.molecule(polygon), edges.molecule(other),
                 factors[k]);
      }
  }
}

/* ----------------------------------------------------------------------
   Contacts of whole polygons may be excluded. Without a part of its edges the
   energy of a polygon would jump.
------------------------------------------------------------------------- */

void check_groups(LAMMPS *lmp, const PolygonEdges &edges, const std::string &style)
{
  const Atom *atom = lmp->atom;
  const Neighbor *neighbor = lmp->neighbor;
  const Group *group = lmp->group;
  int bits = neighbor->includegroup ? group->bitmask[neighbor->includegroup] : 0;
  for (int n = 0; n < neighbor->nex_group; ++n)
    bits |= group->bitmask[neighbor->ex1_group[n]] | group->bitmask[neighbor->ex2_group[n]];
  if (bits == 0) return;
  for (int i = 0; i < atom->nlocal; ++i) {
    const RingEdge &edge = edges[i];
    if (edge.next < 0) continue;
    const int split = (atom->mask[i] ^ atom->mask[edge.next]) & bits;
    if (split == 0) continue;
    int which = 0;
    while (!(split & group->bitmask[which])) ++which;
    refuse("{}: group {} of neigh_modify has a part of polygon {} only, not both atoms {} "
           "and {}: put polygons into groups as a whole",
           style, group->names[which], edges.molecule(edge.polygon), atom->tag[i],
           atom->tag[edge.next]);
  }
}

}    // namespace

/* ---------------------------------------------------------------------- */

void LAMMPS_NS::check_removed_contacts(LAMMPS *lmp, const PolygonEdges &edges,
                                       const std::string &style)
{
  check_special_bonds(lmp, edges, style);
  check_groups(lmp, edges, style);
}
