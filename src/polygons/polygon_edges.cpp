#include "polygons/polygon_edges.h"

#include "kernels/large_vector.h"
#include "laws/vector2.h"
#include "styles/all_ranks.h"
#include "styles/lammps_release.h"
#include "styles/refusals.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "group.h"
#include "lammps.h"
#include "neigh_list.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deformable {

namespace {

// A bead as all ranks get it.
struct Bead {
  double tag, molecule, image_x, image_y, x, y;
};

std::vector<Bead> gather_beads(LAMMPS *lmp, const BeadSelection &selection)
{
  const Atom *atom = lmp->atom;
  std::vector<double> mine;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!selection.has(i)) continue;
    const imageint image = atom->image[i];
    mine.insert(mine.end(),
                {static_cast<double>(atom->tag[i]), static_cast<double>(atom->molecule[i]),
                 static_cast<double>(image_x(image)), static_cast<double>(image_y(image)),
                 atom->x[i][0], atom->x[i][1]});
  }
  const std::vector<double> all = of_all_ranks(lmp, mine);
  std::vector<Bead> beads;
  for (const double *bead = all.data(), *end = bead + all.size(); bead != end; bead += 6)
    beads.push_back({bead[0], bead[1], bead[2], bead[3], bead[4], bead[5]});
  std::sort(beads.begin(), beads.end(), [](const Bead &a, const Bead &b) {
    return a.molecule != b.molecule ? a.molecule < b.molecule : a.tag < b.tag;
  });
  return beads;
}

// From bead a to bead b, with their image flags.
void from_to(const Domain *domain, const Bead &a, const Bead &b, double &dx, double &dy)
{
  const int across = boxes_between(static_cast<int>(a.image_x), static_cast<int>(b.image_x));
  const int up = boxes_between(static_cast<int>(a.image_y), static_cast<int>(b.image_y));
  dx = b.x - a.x + across * domain->xprd + (domain->triclinic ? up * domain->xy : 0.0);
  dy = b.y - a.y + up * domain->yprd;
}

}    // namespace

bool is_nearest_image(const Domain *domain, double dx, double dy)
{
  double nearest[3] = {dx, dy, 0.0};
  minimum_image_big(domain, nearest);
  return nearest[0] == dx && nearest[1] == dy;
}

std::vector<BeadPolygon> find_bead_polygons(LAMMPS *lmp, const BeadSelection &selection)
{
  const Atom *atom = lmp->atom;
  const Domain *domain = lmp->domain;
  Error *error = lmp->error;
  const std::vector<Bead> beads = gather_beads(lmp, selection);
  const std::string &style = selection.style;

  std::vector<BeadPolygon> found;
  for (std::size_t begin = 0, end; begin < beads.size(); begin = end) {
    const Bead &first = beads[begin];
    if (first.molecule <= 0.0)
      error->all(FLERR, "{}: atom {:.0f} belongs to no molecule", style, first.tag);
    for (end = begin; end < beads.size() && beads[end].molecule == first.molecule; ++end)
      if (beads[end].tag != first.tag + static_cast<double>(end - begin))
        error->all(FLERR,
                   "{}: the beads of polygon {:.0f} are not consecutive, atom "
                   "{:.0f} follows {:.0f}; number them around the polygon",
                   style, first.molecule, beads[end].tag, beads[end - 1].tag);
    const int count = static_cast<int>(end - begin);
    if (count < 3)
      error->all(FLERR, "{}: polygon {:.0f} has {} beads, at least 3 are needed", style,
                 first.molecule, count);
    double area = 0.0, perimeter = 0.0, sum_x = 0.0, sum_y = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      const Bead &bead = beads[k], &next = k + 1 < end ? beads[k + 1] : first;
      double x, y, dx, dy;
      from_to(domain, first, bead, x, y);
      from_to(domain, bead, next, dx, dy);
      if (!is_nearest_image(domain, dx, dy))
        error->all(
            FLERR,
            "{}: by their image flags atoms {:.0f} and {:.0f} of "
            "polygon {:.0f} are {:.6g} apart, more than half the box; set flags that make the "
            "polygon whole (set image, or read_data)",
            style, bead.tag, next.tag, first.molecule, std::hypot(dx, dy));
      area += 0.5 * (x * dy - y * dx);
      perimeter += std::hypot(dx, dy);
      sum_x += x;
      sum_y += y;
    }
    found.push_back({static_cast<tagint>(first.molecule), static_cast<tagint>(first.tag), count,
                     area, perimeter, static_cast<int>(first.image_x),
                     static_cast<int>(first.image_y), first.x + sum_x / count,
                     first.y + sum_y / count});
  }

  Refusals(lmp).check([&] {
    for (int i = 0; i < atom->nlocal; ++i) {
      if (selection.has(i)) continue;
      const tagint molecule = atom->molecule[i];
      const auto polygon =
          std::lower_bound(found.begin(), found.end(), molecule,
                           [](const BeadPolygon &a, tagint sought) { return a.molecule < sought; });
      if (polygon != found.end() && polygon->molecule == molecule)
        refuse("{}: atom {} belongs to polygon {} but not to {}", style, atom->tag[i], molecule,
               selection.name);
    }
  });
  return found;
}

/* ----------------------------------------------------------------------
   Edges of the polygons that a rank sees
------------------------------------------------------------------------- */

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

double PolygonEdges::memory_usage() const
{
  return bytes_of(polygons, edges, extents);
}

/* ----------------------------------------------------------------------
   Contacts that may act before the next neighbor list
------------------------------------------------------------------------- */

namespace {

Vector2 difference(const double *to, const double *from)
{
  return {to[0] - from[0], to[1] - from[1]};
}

/* ----------------------------------------------------------------------
   Whether a vertex may come within the range of an edge while both move by
   less than skin/2: the distance then changes by less than the skin, and p.e
   by less than skin (|p| + |e| + skin). Nothing acts while p.e <= 0. p: from
   the first vertex of the edge e to the vertex.
------------------------------------------------------------------------- */

bool may_touch(const Vector2 &p, const Vector2 &e, double range, double skin)
{
  const double along = dot(p, e), square = dot(e, e);
  const double lengths = std::sqrt(dot(p, p)) + std::sqrt(square);
  if (along <= -skin * (lengths + skin)) return false;
  const double t = along <= 0.0 ? 0.0 : along >= square ? 1.0 : along / square;
  const Vector2 foot = p - t * e;
  return dot(foot, foot) < (range + skin) * (range + skin);
}

/* ----------------------------------------------------------------------
   Whether the edges a and b cross. p: from the begin of b to that of a.
------------------------------------------------------------------------- */

bool edges_cross(const Vector2 &p, const Vector2 &a, const Vector2 &b)
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

void list_edge_contacts(LAMMPS *lmp, const NeighList &list, const PolygonEdges &edges,
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
    const Vector2 ei = difference(x[edges[i].next], x[i]);
    for (int jj = 0; jj < list.numneigh[i]; ++jj) {
      const int j = list.firstneigh[i][jj] & NEIGHMASK;
      if (edges[j].polygon == edges[i].polygon) continue;
      const double range = c[type[i]][type[j]], cutoff = range + longest + skin;
      const Vector2 p = difference(x[i], x[j]);
      if (dot(p, p) >= cutoff * cutoff) continue;
      if (edges[j].next < 0)
        refuse("{}: the atom that follows atom {} in its polygon is not found beside it: "
               "lost, or farther away than l, the longest edge allowed, {:.6g}",
               style, tag[j], longest);
      const Vector2 ej = difference(x[edges[j].next], x[j]);
      if (edges_cross(p, ei, ej))
        refuse("{}: polygons {} and {} have crossed: the edge from atom {} to atom {} and "
               "that from atom {} to atom {}. Start from polygons that do not overlap, and "
               "take smaller steps (timestep, min_modify dmax), or a larger c or kr",
               style, edges.molecule(edges[i].polygon), edges.molecule(edges[j].polygon), tag[i],
               tag[edges[i].next], tag[j], tag[edges[j].next]);
      const int types = atom->ntypes + 1;
      if (may_touch(p, ej, range, skin))
        found.push_back({i, j, edges[j].next, type[i] * types + type[j]});
      if (may_touch(-p, ei, range, skin))
        found.push_back({j, i, edges[i].next, type[j] * types + type[i]});
    }
  }
}

/* ----------------------------------------------------------------------
   What would make contacts wrong or incomplete
------------------------------------------------------------------------- */

namespace {

/* ----------------------------------------------------------------------
   Partners along a polygon have no contacts. Others come from bonds between
   polygons. The factors are read in each call: pair_style hybrid may set its own.
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

void check_removed_contacts(LAMMPS *lmp, const PolygonEdges &edges, const std::string &style)
{
  check_special_bonds(lmp, edges, style);
  check_groups(lmp, edges, style);
}

}    // namespace deformable
