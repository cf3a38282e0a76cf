// Edges of polygons: each vertex of this rank, ghosts included, and its successor along the polygon.

#ifndef LMP_POLYGON_EDGES_H
#define LMP_POLYGON_EDGES_H

#include "pointers.h"

#include "polygons/bead_polygons.h"

#include <vector>

namespace LAMMPS_NS {

struct RingEdge {
  int polygon;    // -1 if the vertex is in none
  int next;    // the successor by local index; -1 without polygon, and for ghosts whose successor is no ghost
};

class PolygonEdges : protected Pointers {
 public:
  // style: begins the errors
  PolygonEdges(class LAMMPS *lmp, const std::string &style) : Pointers(lmp), style(style) {}

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

}    // namespace LAMMPS_NS

#endif
