// The contacts that may act before the next neighbor list: a vertex and an edge of another polygon.

#ifndef LMP_EDGE_LIST_H
#define LMP_EDGE_LIST_H

#include "polygons/polygon_edges.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

struct VertexAndEdge {
  int vertex, begin, end;
  int types;    // (type of the vertex) * (number of types + 1) + (type of the edge)
};

// From the neighbor list, which has all pairs of vertices within c + longest + skin; c: of each pair of types.
// Stops with an error if edges cross or if a successor is missing.
void list_edge_contacts(class LAMMPS *, const class NeighList &, const PolygonEdges &,
                        const double *const *c, double longest, const std::string &style,
                        std::vector<VertexAndEdge> &);

}    // namespace LAMMPS_NS

#endif
