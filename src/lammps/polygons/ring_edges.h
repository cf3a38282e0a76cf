// Edges of rings: each vertex of this rank, ghosts included, and its successor along the ring.

#ifndef LMP_RING_EDGES_H
#define LMP_RING_EDGES_H

#include "pointers.h"

#include "bead_rings.h"

#include <vector>

namespace LAMMPS_NS {

struct RingEdge {
  int ring;    // -1 if the vertex is in none
  int next;    // the successor by local index; -1 without ring, and for ghosts whose successor is no ghost
};

class RingEdges : protected Pointers {
 public:
  // style: begins the errors
  RingEdges(class LAMMPS *lmp, const std::string &style) : Pointers(lmp), style(style) {}

  // Before there are ghosts: refuses edges and ranges for which the box is too small. Returns its smallest width.
  double refuse_small_box(double longest, double range) const;

  // Which rings there are. All ranks.
  void find(const BeadSelection &);

  // With a new neighbor list: successors by local index. Refuses edges above the longest allowed, and rings that
  // may come within the range of their own images before the next list. All ranks.
  void link(double longest, double range);

  const RingEdge &operator[](int i) const { return edges[i]; }
  tagint molecule(int ring) const { return rings[ring].molecule; }

  // The ring of an atom ID, -1 if none; the guess is tried first.
  int ring_of(tagint tag, int guess) const;

  double memory_usage() const;

 private:
  const std::string style;
  std::vector<BeadRing> rings;    // by rising ID of their first vertex
  std::vector<RingEdge> edges;
  std::vector<double> extents;
  int most_vertices = 0;

  void link_successor(int i, double longest);
  double across() const;
  void refuse_own_images(double range);
};

}    // namespace LAMMPS_NS

#endif
