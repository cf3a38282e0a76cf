#include "edge_checks.h"

#include "atom.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "lammps.h"
#include "neigh_list.h"
#include "neighbor.h"

#include <cmath>

using namespace LAMMPS_NS;

namespace {

/* ----------------------------------------------------------------------
   Partners along a ring have no contacts. Others come from bonds between
   rings. The factors are those in a call: pair_style hybrid may set its own.
------------------------------------------------------------------------- */

void check_special_bonds(LAMMPS *lmp, const RingEdges &edges, const std::string &style)
{
  const Atom *atom = lmp->atom;
  const double *factors = lmp->force->special_lj;
  if (atom->molecular != Atom::MOLECULAR) return;
  for (int i = 0; i < atom->nlocal; ++i) {
    const int ring = edges.begin()[i].ring;
    if (ring < 0) continue;
    for (int k = 1, n = 0; k <= 3; ++k)    // 1-2, 1-3 and 1-4 partners
      for (; n < atom->nspecial[i][k - 1]; ++n) {
        if (factors[k] == 1.0) continue;
        const tagint partner = atom->special[i][n];
        const int other = edges.ring_of(partner, ring);
        if (other >= 0 && other != ring)
          lmp->error->one(FLERR,
                          "{}: special_bonds gives atoms {} and {} of rings {} and {} the factor "
                          "{:.6g}, but contacts are not scaled: use 'special_bonds lj/coul 1 1 1'",
                          style, atom->tag[i], partner, edges.molecule(ring), edges.molecule(other),
                          factors[k]);
      }
  }
}

/* ----------------------------------------------------------------------
   Contacts of whole rings may be excluded. Without a part of its edges the
   energy of a ring would jump.
------------------------------------------------------------------------- */

void check_groups(LAMMPS *lmp, const RingEdges &edges, const std::string &style)
{
  const Atom *atom = lmp->atom;
  const Neighbor *neighbor = lmp->neighbor;
  const Group *group = lmp->group;
  int bits = neighbor->includegroup ? group->bitmask[neighbor->includegroup] : 0;
  for (int n = 0; n < neighbor->nex_group; ++n)
    bits |= group->bitmask[neighbor->ex1_group[n]] | group->bitmask[neighbor->ex2_group[n]];
  if (bits == 0) return;
  for (int i = 0; i < atom->nlocal; ++i) {
    const RingEdge &edge = edges.begin()[i];
    if (edge.next < 0) continue;
    const int split = (atom->mask[i] ^ atom->mask[edge.next]) & bits;
    if (split == 0) continue;
    int which = 0;
    while (!(split & group->bitmask[which])) ++which;
    lmp->error->one(FLERR,
                    "{}: group {} of neigh_modify has a part of ring {} only, not both atoms {} "
                    "and {}: put rings into groups as a whole",
                    style, group->names[which], edges.molecule(edge.ring), atom->tag[i],
                    atom->tag[edge.next]);
  }
}

/* ----------------------------------------------------------------------
   Whether the edges a and b cross, with b beginning at (0, 0) and a at (x, y).
------------------------------------------------------------------------- */

bool cross(double x, double y, const RingEdge &a, const RingEdge &b)
{
  const double turn = b.x * a.y - b.y * a.x;
  const double begin = b.x * y - b.y * x;    // side of b where a begins
  if (!(begin * (begin + turn) < 0.0)) return false;
  const double other = a.y * x - a.x * y;    // side of a where b begins
  return other * (other - turn) < 0.0;
}

}    // namespace

/* ---------------------------------------------------------------------- */

void LAMMPS_NS::check_removed_contacts(LAMMPS *lmp, const RingEdges &edges,
                                       const std::string &style)
{
  check_special_bonds(lmp, edges, style);
  check_groups(lmp, edges, style);
}

/* ----------------------------------------------------------------------
   A vertex that has crossed an edge is pushed farther inward. Both of its
   own edges then cross that edge or the next ones. Lists that are shared with
   other styles may hold pairs beyond the cutoff.
------------------------------------------------------------------------- */

void LAMMPS_NS::check_listed_edges(LAMMPS *lmp, const NeighList &list, const RingEdges &edges,
                                   const double *const *cutsq, const std::string &style)
{
  const Atom *atom = lmp->atom;
  const double *const *x = atom->x;
  const RingEdge *edge = edges.begin();
  for (int ii = 0; ii < list.inum; ++ii) {
    const int i = list.ilist[ii];
    if (edge[i].ring < 0)
      lmp->error->one(FLERR,
                      "{}: atom {} belongs to none of the rings that were there when the run began",
                      style, atom->tag[i]);
    for (int jj = 0; jj < list.numneigh[i]; ++jj) {
      const int j = list.firstneigh[i][jj] & NEIGHMASK;
      if (edge[j].ring == edge[i].ring) continue;
      const double dx = x[i][0] - x[j][0], dy = x[i][1] - x[j][1];
      const double cutoff = std::sqrt(cutsq[atom->type[i]][atom->type[j]]) + lmp->neighbor->skin;
      if (dx * dx + dy * dy > cutoff * cutoff) continue;
      if (edge[j].next < 0)
        lmp->error->one(FLERR,
                        "{}: the atom that follows atom {} in ring {} is not found beside it: "
                        "lost, or farther away than l, the longest edge allowed",
                        style, atom->tag[j], edges.molecule(edge[j].ring));
      if (cross(dx, dy, edge[i], edge[j]))
        lmp->error->one(FLERR,
                        "{}: rings {} and {} have crossed: the edge from atom {} to atom {} and "
                        "that from atom {} to atom {}. Start from rings that do not overlap, and "
                        "take smaller steps (timestep, min_modify dmax), or a larger c or kr",
                        style, edges.molecule(edge[i].ring), edges.molecule(edge[j].ring),
                        atom->tag[i], atom->tag[edge[i].next], atom->tag[j],
                        atom->tag[edge[j].next]);
    }
  }
}
