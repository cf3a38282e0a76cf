// Edges of rings: each vertex of this rank, ghosts included, with the edge to its successor along the ring.

#ifndef LMP_RING_EDGES_H
#define LMP_RING_EDGES_H

#include "pointers.h"

#include "bead_rings.h"

#include <vector>

namespace LAMMPS_NS {

struct RingEdge {
  double x, y;    // from the vertex to its successor
  int next;    // the successor by local index; -1 if the vertex is in no ring, or is a ghost whose
               // successor is beyond the ghost cutoff
  int ring;    // -1 if in none
};

class RingEdges : protected Pointers {
 public:
  // style: begins the errors
  RingEdges(class LAMMPS *lmp, const std::string &style) : Pointers(lmp), style(style) {}

  // Which rings there are. All ranks.
  void find(const BeadSelection &);

  // With a new neighbor list: successors by local index. longest: of the edges allowed.
  void link(double longest);

  // In each force call: edge vectors. Returns the length of the longest one here. Refuses those that are not
  // allowed, and rings that may come within the range of their own images. All ranks.
  double measure(double longest, double range);

  const RingEdge *begin() const { return edges.data(); }
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

  void refuse_long(double longest) const;
  void refuse_own_images(double range, double across, double up);
};

}    // namespace LAMMPS_NS

#endif
