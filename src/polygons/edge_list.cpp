#include "polygons/edge_list.h"

#include "styles/refusals.h"

#include "atom.h"
#include "lammps.h"
#include "neigh_list.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace {

struct Vector {
  double x, y;
};

double dot(const Vector &a, const Vector &b)
{
  return a.x * b.x + a.y * b.y;
}

double cross(const Vector &a, const Vector &b)
{
  return a.x * b.y - a.y * b.x;
}

Vector difference(const double *to, const double *from)
{
  return {to[0] - from[0], to[1] - from[1]};
}

/* ----------------------------------------------------------------------
   Whether a vertex may come within the range of an edge while both move by
   less than skin/2: the distance then changes by less than the skin, and p.e
   by less than skin (|p| + |e| + skin). Nothing acts while p.e <= 0. p: from
   the first vertex of the edge e to the vertex.
------------------------------------------------------------------------- */

bool may_touch(const Vector &p, const Vector &e, double range, double skin)
{
  const double along = dot(p, e), square = dot(e, e);
  const double lengths = std::sqrt(dot(p, p)) + std::sqrt(square);
  if (along <= -skin * (lengths + skin)) return false;
  const double t = along <= 0.0 ? 0.0 : along >= square ? 1.0 : along / square;
  const Vector foot = {p.x - t * e.x, p.y - t * e.y};
  return dot(foot, foot) < (range + skin) * (range + skin);
}

/* ----------------------------------------------------------------------
   Whether the edges a and b cross. p: from the begin of b to that of a.
------------------------------------------------------------------------- */

bool edges_cross(const Vector &p, const Vector &a, const Vector &b)
{
  const double turn = cross(b, a), side_of_b = cross(b, p), side_of_a = cross(p, a);
  return side_of_b * (side_of_b + turn) < 0.0 && side_of_a * (side_of_a - turn) < 0.0;
}

}    // namespace

/* ----------------------------------------------------------------------
   A vertex that has crossed an edge is pushed farther inward, and its own two
   edges cross that edge or the next ones. The list may be shared with styles
   of larger cutoffs.
------------------------------------------------------------------------- */

void LAMMPS_NS::list_edge_contacts(LAMMPS *lmp, const NeighList &list, const PolygonEdges &edges,
                                   const double *const *c, double longest, const std::string &style,
                                   std::vector<VertexAndEdge> &found)
{
  const Atom *atom = lmp->atom;
  const double *const *x = atom->x;
  const int *type = atom->type;
  const tagint *tag = atom->tag;
  const double skin = lmp->neighbor->skin;
  found.clear();
  for (int ii = 0; ii < list.inum; ++ii) {
    const int i = list.ilist[ii];
    if (edges[i].polygon < 0)
      refuse("{}: atom {} is in no polygon that was there when the run began", style, tag[i]);
    const Vector ei = difference(x[edges[i].next], x[i]);
    for (int jj = 0; jj < list.numneigh[i]; ++jj) {
      const int j = list.firstneigh[i][jj] & NEIGHMASK;
      if (edges[j].polygon == edges[i].polygon) continue;
      const double range = c[type[i]][type[j]], cutoff = range + longest + skin;
      const Vector p = difference(x[i], x[j]);
      if (dot(p, p) >= cutoff * cutoff) continue;
      if (edges[j].next < 0)
        refuse("{}: the atom that follows atom {} in its polygon is not found beside it: "
               "lost, or farther away than l, the longest edge allowed, {:.6g}",
               style, tag[j], longest);
      const Vector ej = difference(x[edges[j].next], x[j]);
      if (edges_cross(p, ei, ej))
        refuse("{}: polygons {} and {} have crossed: the edge from atom {} to atom {} and "
               "that from atom {} to atom {}. Start from polygons that do not overlap, and "
               "take smaller steps (timestep, min_modify dmax), or a larger c or kr",
               style, edges.molecule(edges[i].polygon), edges.molecule(edges[j].polygon), tag[i],
               tag[edges[i].next], tag[j], tag[edges[j].next]);
      const int types = atom->ntypes + 1;
      if (may_touch(p, ej, range, skin))
        found.push_back({i, j, edges[j].next, type[i] * types + type[j]});
      if (may_touch({-p.x, -p.y}, ei, range, skin))
        found.push_back({j, i, edges[i].next, type[j] * types + type[i]});
    }
  }
}
