#include "polygons/polygon_edges.h"

#include "styles/refusals.h"

#include "atom.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void PolygonEdges::find(const BeadSelection &selection)
{
  polygons = find_bead_polygons(lmp, selection);
  std::sort(polygons.begin(), polygons.end(),
            [](const BeadPolygon &a, const BeadPolygon &b) { return a.first < b.first; });
  most_vertices = 0;
  for (const BeadPolygon &polygon : polygons)
    most_vertices = std::max(most_vertices, polygon.beads);
}

/* ----------------------------------------------------------------------
   Atoms that follow each other are often of one polygon.
------------------------------------------------------------------------- */

int PolygonEdges::polygon_of(tagint tag, int guess) const
{
  const auto has = [this, tag](int polygon) {
    return tag >= polygons[polygon].first &&
           tag < polygons[polygon].first + polygons[polygon].beads;
  };
  if (guess >= 0 && has(guess)) return guess;
  const auto after = std::upper_bound(
      polygons.begin(), polygons.end(), tag,
      [](tagint sought, const BeadPolygon &polygon) { return sought < polygon.first; });
  const int polygon = static_cast<int>(after - polygons.begin()) - 1;
  return polygon >= 0 && has(polygon) ? polygon : -1;
}

/* ---------------------------------------------------------------------- */

void PolygonEdges::link(double longest, double range)
{
  edges.assign(atom->nlocal + atom->nghost, {-1, -1});
  Refusals(lmp).check([&] {
    int polygon = -1;
    for (int i = 0; i < static_cast<int>(edges.size()); ++i) {
      polygon = polygon_of(atom->tag[i], polygon);
      edges[i].polygon = polygon;
      if (polygon >= 0) link_successor(i, longest);
    }
  });
  const double least = refuse_small_box(longest, range);
  // no polygon is wider than half its perimeter
  if (0.5 * most_vertices * longest + range > least) refuse_own_images(range);
}

/* ----------------------------------------------------------------------
   The image of the successor within the longest edge: there is only one, as
   that is less than half of the box. It often is the next atom in memory. A
   ghost may have none, if its successor is beyond the ghost cutoff.
------------------------------------------------------------------------- */

void PolygonEdges::link_successor(int i, double longest)
{
  const double *const *x = atom->x;
  const auto square = [i, x](int j) {
    const double dx = x[j][0] - x[i][0], dy = x[j][1] - x[i][1];
    return dx * dx + dy * dy;
  };
  const BeadPolygon &polygon = polygons[edges[i].polygon];
  const tagint last = polygon.first + polygon.beads - 1;
  const tagint successor = atom->tag[i] == last ? polygon.first : atom->tag[i] + 1;
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
    refuse("{}: atom {} of polygon {} is not found beside atom {}: lost, or farther away than l, "
           "the longest edge allowed, {:.6g}",
           style, successor, polygon.molecule, atom->tag[i], longest);
  else
    refuse("{}: the edge of polygon {} from atom {} to atom {} is {:.6g} long, but l, the longest "
           "edge allowed, is {:.6g}: use a larger l",
           style, polygon.molecule, atom->tag[i], successor, std::sqrt(square(next)), longest);
  if (local && atom->type[next] != atom->type[i])
    refuse("{}: the atoms of polygon {} are of types {} and {}, they must have one", style,
           polygon.molecule, atom->type[i], atom->type[next]);
}

/* ----------------------------------------------------------------------
   Distances between opposite faces of the box.
------------------------------------------------------------------------- */

double PolygonEdges::across() const
{
  const double up = domain->yprd;
  return domain->triclinic ? domain->xprd * up / std::hypot(up, domain->xy) : domain->xprd;
}

double PolygonEdges::refuse_small_box(double longest, double range) const
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
   No polygon meets an image of itself if it is narrower than the box, by the
   range of contacts, along the normals of all faces.
------------------------------------------------------------------------- */

void PolygonEdges::refuse_own_images(double range)
{
  const double across = this->across(), up = domain->yprd;
  // largest and minus smallest projection of each polygon on both normals
  extents.assign(4 * polygons.size(), -std::numeric_limits<double>::max());
  for (int i = 0; i < atom->nlocal; ++i) {
    if (edges[i].polygon < 0) continue;
    const BeadPolygon &polygon = polygons[edges[i].polygon];
    const imageint image = atom->image[i];
    double y = (atom->x[i][1] - domain->boxlo[1]) / domain->yprd;
    double x = atom->x[i][0] - domain->boxlo[0] - (domain->triclinic ? y * domain->xy : 0.0);
    x = across * (x / domain->xprd + boxes_between(polygon.image_x, image_x(image)));
    y = up * (y + boxes_between(polygon.image_y, image_y(image)));
    double *of_ring = &extents[4 * edges[i].polygon];
    for (const double projection : {x, -x, y, -y}) {
      *of_ring = std::max(*of_ring, projection);
      ++of_ring;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, extents.data(), static_cast<int>(extents.size()), MPI_DOUBLE, MPI_MAX,
                world);
  for (std::size_t r = 0; r < polygons.size(); ++r) {
    const double *of_ring = &extents[4 * r];
    const double width = of_ring[0] + of_ring[1], height = of_ring[2] + of_ring[3];
    const bool wide = domain->xperiodic && !(width + range < across);
    const bool high = domain->yperiodic && !(height + range < up);
    if (wide || high)
      error->all(
          FLERR,
          "{}: polygon {} may meet its own image: it is {:.6g} wide, and the box {:.6g}: use a "
          "larger box (replicate)",
          style, polygons[r].molecule, wide ? width : height, wide ? across : up);
  }
}

/* ---------------------------------------------------------------------- */

double PolygonEdges::memory_usage() const
{
  return static_cast<double>(polygons.capacity() * sizeof(BeadPolygon) +
                             edges.capacity() * sizeof(RingEdge) +
                             extents.capacity() * sizeof(double));
}
