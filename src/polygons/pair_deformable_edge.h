// Smooth and frictionless deformable polygons: vertices of polygons against the edges of other polygons.
//   pair_style deformable/edge l
//   pair_coeff I J kr c

#ifdef PAIR_CLASS
// clang-format off
PairStyle(deformable/edge,PairDeformableEdge);
// clang-format on
#else

#ifndef DEFORMABLE_PAIR_DEFORMABLE_EDGE_H
#define DEFORMABLE_PAIR_DEFORMABLE_EDGE_H

#include "pair.h"

#include "polygons/edge_contact.h"
#include "polygons/polygon_edges.h"
#include "styles/refusals.h"

#include <vector>

namespace LAMMPS_NS {

class PairDeformableEdge : public Pair {
 public:
  PairDeformableEdge(class LAMMPS *);
  ~PairDeformableEdge() override;

  void settings(int, char **) override;
  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void compute(int, int) override;
  void write_restart(FILE *) override;
  void read_restart(FILE *) override;
  void write_restart_settings(FILE *) override;
  void read_restart_settings(FILE *) override;
  void write_data(FILE *) override;
  void write_data_all(FILE *) override;
  double memory_usage() override;

 private:
  double longest;       // l
  double **kr, **c;     // of each pair of types
  double greatest_c;    // of all of them
  deformable::PolygonEdges edges;
  deformable::Refusals refusals;

  std::vector<deformable::VertexAndEdge> contacts;    // that may act before the next neighbor list
  std::vector<deformable::Repulsion> repulsion;       // by VertexAndEdge::types

  bool polygons_unknown = true;
  bigint atoms_known = -1;
  // which neighbor list the contacts are from; `rerun` counts the builds anew for each snapshot
  bigint builds_known = -1, build_step = -1;
  bool warned_out_of_plane = false;

  void allocate();
  void set_ghost_cutoff();
  void take_list();
  template <bool TALLY> void add_contacts();
  void tally(const deformable::VertexAndEdge &, double px, double py, double ex, double ey,
             const deformable::EdgeContact &);
};

}    // namespace LAMMPS_NS

#endif
#endif
