#include "ring_edges.h"

#include "atom.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void RingEdges::find(const BeadSelection &selection)
{
  rings = find_bead_rings(lmp, selection);
  std::sort(rings.begin(), rings.end(),
            [](const BeadRing &a, const BeadRing &b) { return a.first < b.first; });
  most_vertices = 0;
  for (const BeadRing &ring : rings) most_vertices = std::max(most_vertices, ring.beads);
}

/* ----------------------------------------------------------------------
   Atoms that follow each other are often of one ring.
------------------------------------------------------------------------- */

int RingEdges::ring_of(tagint tag, int guess) const
{
  const auto has = [this, tag](int ring) {
    return tag >= rings[ring].first && tag < rings[ring].first + rings[ring].beads;
  };
  if (guess >= 0 && has(guess)) return guess;
  const auto after =
      std::upper_bound(rings.begin(), rings.end(), tag,
                       [](tagint sought, const BeadRing &ring) { return sought < ring.first; });
  const int ring = static_cast<int>(after - rings.begin()) - 1;
  return ring >= 0 && has(ring) ? ring : -1;
}

/* ---------------------------------------------------------------------- */

void RingEdges::link(double longest, double range)
{
  edges.assign(atom->nlocal + atom->nghost, {-1, -1});
  int ring = -1;
  for (int i = 0; i < static_cast<int>(edges.size()); ++i) {
    ring = ring_of(atom->tag[i], ring);
    edges[i].ring = ring;
    if (ring >= 0) link_successor(i, longest);
  }
  const double least = refuse_small_box(longest, range);
  // no ring is wider than half its perimeter
  if (0.5 * most_vertices * longest + range > least) refuse_own_images(range);
}

/* ----------------------------------------------------------------------
   The image of the successor within the longest edge: there is only one, as
   that is less than half of the box. It often is the next atom in memory. A
   ghost may have none, if its successor is beyond the ghost cutoff.
------------------------------------------------------------------------- */

void RingEdges::link_successor(int i, double longest)
{
  const double *const *x = atom->x;
  const auto square = [i, x](int j) {
    const double dx = x[j][0] - x[i][0], dy = x[j][1] - x[i][1];
    return dx * dx + dy * dy;
  };
  const BeadRing &ring = rings[edges[i].ring];
  const tagint last = ring.first + ring.beads - 1;
  const tagint successor = atom->tag[i] == last ? ring.first : atom->tag[i] + 1;
  const bool local = i < atom->nlocal;
  int next = i + 1;
  if (next >= static_cast<int>(edges.size()) || atom->tag[next] != successor ||
      !(square(next) <= longest * longest))
    next = domain->closest_image(i, atom->map(successor));
  if (next >= 0 && square(next) <= longest * longest)
    edges[i].next = next;
  else if (!local)
    return;
  else if (next < 0)
    error->one(FLERR,
               "{}: atom {} of ring {} is not found beside atom {}: lost, or farther away than l, "
               "the longest edge allowed, {:.6g}",
               style, successor, ring.molecule, atom->tag[i], longest);
  else
    error->one(FLERR,
               "{}: the edge of ring {} from atom {} to atom {} is {:.6g} long, but l, the longest "
               "edge allowed, is {:.6g}: use a larger l",
               style, ring.molecule, atom->tag[i], successor, std::sqrt(square(next)), longest);
  if (local && atom->type[next] != atom->type[i])
    error->one(FLERR, "{}: the atoms of ring {} are of types {} and {}, they must have one", style,
               ring.molecule, atom->type[i], atom->type[next]);
}

/* ----------------------------------------------------------------------
   Distances between opposite faces of the box.
------------------------------------------------------------------------- */

double RingEdges::across() const
{
  const double up = domain->yprd;
  return domain->triclinic ? domain->xprd * up / std::hypot(up, domain->xy) : domain->xprd;
}

double RingEdges::refuse_small_box(double longest, double range) const
{
  double least = std::numeric_limits<double>::infinity();
  if (domain->xperiodic) least = across();
  if (domain->yperiodic) least = std::min(least, domain->yprd);
  if (2.0 * longest > least)
    error->all(FLERR,
               "{}: l is {:.6g}, more than half of the box, which is {:.6g} wide: use a smaller l, "
               "or a larger box (replicate)",
               style, longest, least);
  if (range > least)
    error->all(FLERR,
               "{}: c and the skin of the neighbor list are {:.6g} together, more than the box, "
               "which is {:.6g} wide: use a smaller c or skin, or a larger box (replicate)",
               style, range, least);
  return least;
}

/* ----------------------------------------------------------------------
   No ring meets an image of itself if it is narrower than the box, by the
   range of contacts, along the normals of all faces.
------------------------------------------------------------------------- */

void RingEdges::refuse_own_images(double range)
{
  const double across = this->across(), up = domain->yprd;
  // largest and minus smallest projection of each ring on both normals
  extents.assign(4 * rings.size(), -std::numeric_limits<double>::max());
  for (int i = 0; i < atom->nlocal; ++i) {
    if (edges[i].ring < 0) continue;
    const BeadRing &ring = rings[edges[i].ring];
    const imageint image = atom->image[i];
    double y = (atom->x[i][1] - domain->boxlo[1]) / domain->yprd;
    double x = atom->x[i][0] - domain->boxlo[0] - (domain->triclinic ? y * domain->xy : 0.0);
    x = across * (x / domain->xprd + boxes_between(ring.image_x, image_x(image)));
    y = up * (y + boxes_between(ring.image_y, image_y(image)));
    double *of_ring = &extents[4 * edges[i].ring];
    for (const double projection : {x, -x, y, -y}) {
      *of_ring = std::max(*of_ring, projection);
      ++of_ring;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, extents.data(), static_cast<int>(extents.size()), MPI_DOUBLE, MPI_MAX,
                world);
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const double *of_ring = &extents[4 * r];
    const double width = of_ring[0] + of_ring[1], height = of_ring[2] + of_ring[3];
    const bool wide = domain->xperiodic && !(width + range < across);
    const bool high = domain->yperiodic && !(height + range < up);
    if (wide || high)
      error->all(FLERR,
                 "{}: ring {} may meet its own image: it is {:.6g} wide, and the box {:.6g}: use a "
                 "larger box (replicate)",
                 style, rings[r].molecule, wide ? width : height, wide ? across : up);
  }
}

/* ---------------------------------------------------------------------- */

double RingEdges::memory_usage() const
{
  return static_cast<double>(rings.capacity() * sizeof(BeadRing) +
                             edges.capacity() * sizeof(RingEdge) +
                             extents.capacity() * sizeof(double));
}
