// Edges of polygons: each vertex of this rank, ghosts included, and its successor along the polygon.
//
// Bead polygons: molecules whose beads have consecutive atom IDs along the polygon.

#ifndef DEFORMABLE_POLYGON_EDGES_H
#define DEFORMABLE_POLYGON_EDGES_H

#include "lmptype.h"
#include "styles/lammps_names.h"

#include <functional>
#include <string>
#include <vector>

namespace deformable {

struct BeadPolygon {
  tagint molecule, first;
  int beads;
  double area;    // negative if the beads run clockwise
  double perimeter;
  int image_x, image_y;    // image flags of the first bead
  double x, y;             // mean of the beads in that image
};

// The beads of a style, and how its errors name both: "Fix area deformable/polygon", "the group of the fix".
struct BeadSelection {
  std::string style, name;
  std::function<bool(int)> has;    // this atom of the rank
};

// The polygons of the selected beads at present, by rising molecule ID; the same on every rank.
std::vector<BeadPolygon> find_bead_polygons(LAMMPS *lmp, const BeadSelection &);

// Image flags as LAMMPS stores them, not negative.
inline int image_x(imageint image)
{
  return image & IMGMASK;
}

inline int image_y(imageint image)
{
  return image >> IMGBITS & IMGMASK;
}

// Image flags wrap around at the end of their range.
inline int boxes_between(int from, int to)
{
  return ((to - from + IMGMAX) & IMGMASK) - IMGMAX;
}

// Whether no periodic image of the vector (dx, dy) is shorter.
bool is_nearest_image(const Domain *domain, double dx, double dy);

struct RingEdge {
  int polygon;    // -1 if the vertex is in none
  int next;    // the successor by local index; -1 without polygon, and for ghosts whose successor is no ghost
};

class PolygonEdges : protected Pointers {
 public:
  // style: begins the errors
  PolygonEdges(LAMMPS *lmp, const std::string &style) : Pointers(lmp), style(style) {}

  // Before there are ghosts: refuses edges and ranges for which the box is too small. Returns its smallest width.
  double refuse_small_box(double longest, double range) const;

  // Which polygons there are. All ranks.
  void find(const BeadSelection &);

  // With a new neighbor list: successors by local index. Refuses edges above the longest allowed, and polygons that
  // may come within the range of their own images before the next list. All ranks.
  void link(double longest, double range);

  const RingEdge &operator[](int i) const { return edges[i]; }
  tagint molecule(int polygon) const { return polygons[polygon].molecule; }

  // The polygon of an atom ID, -1 if none; the guess is tried first.
  int polygon_of(tagint tag, int guess) const;

  double memory_usage() const;

 private:
  const std::string style;
  std::vector<BeadPolygon> polygons;    // by rising ID of their first vertex
  std::vector<RingEdge> edges;
  std::vector<double> extents;
  int most_vertices = 0;

  void link_successor(int i, double longest);
  double across() const;
  void refuse_own_images(double range);
};

// The contacts that may act before the next neighbor list: a vertex and an edge of another polygon.
struct VertexAndEdge {
  int vertex, begin, end;
  int types;    // (type of the vertex) * (number of types + 1) + (type of the edge)
};

// From the neighbor list, which has all pairs of vertices within c + longest + skin; c: of each pair of types.
// Stops with an error if edges cross or if a successor is missing.
void list_edge_contacts(LAMMPS *, const NeighList &, const PolygonEdges &, const double *const *c,
                        double longest, const std::string &style, std::vector<VertexAndEdge> &);

// Stops with an error if special_bonds removes or scales contacts of different polygons, or if neigh_modify removes
// contacts of a part of a polygon. To be called with new polygons, when they are linked.
void check_removed_contacts(LAMMPS *, const PolygonEdges &, const std::string &style);

}    // namespace deformable

#endif
