// The area term of bead polygons: fix ID group deformable/polygon kA [rest initial|AREA]
//
// A polygon is a molecule whose beads have consecutive atom IDs along it. With bond_style harmonic along the polygon
// and pair_style harmonic/cut between polygons this is the deformable-polygon model, the reference for the deformable
// pair styles.

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/polygon,FixDeformablePolygon);
// clang-format on
#else

#ifndef DEFORMABLE_FIX_DEFORMABLE_POLYGON_H
#define DEFORMABLE_FIX_DEFORMABLE_POLYGON_H

#include "fix.h"

#include "polygons/polygon_edges.h"

#include <vector>

namespace LAMMPS_NS {

class FixDeformablePolygon : public Fix {
 public:
  FixDeformablePolygon(class LAMMPS *, int, char **);
  // The name must not contain "deform", see fix_deformable_wall.h.
  static constexpr const char *STYLE = "polygon/area";

  int setmask() override;
  void init() override;
  void setup(int) override;
  void min_setup(int vflag) override { setup(vflag); }
  void post_force(int) override;
  void min_post_force(int vflag) override { post_force(vflag); }
  void post_run() override;
  double compute_scalar() override;
  double compute_array(int, int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

 private:
  // Areas are signed, so that the energy stays smooth if a polygon turns inside out. The center is the mean of the
  // beads at the previous call; areas are computed relative to it.
  struct Polygon : deformable::BeadPolygon {
    double rest_area = 0.0;
    std::size_t links_end = 0;
  };
  std::vector<Polygon> polygons;    // by rising molecule ID, the same on every rank
  std::vector<double> sums;
  bool perimeters_known = true;    // computed on request only

  double kA;
  double given_rest_area = 0.0;    // 0: the initial area of each polygon

  // A bead of this rank and its neighbors along the polygon, by local index: polygon by polygon, in order.
  struct Link {
    int bead, previous, next;
  };
  std::vector<Link> links;
  bigint links_of_build = -1;    // they change with the neighbor list

  std::vector<Polygon> find_polygons();
  void link_beads();
  int neighbor_of(int i, const Polygon &polygon, tagint tag) const;
  void from_center(const Polygon &polygon, int i, double &x, double &y) const;
  void measure_areas();
  void measure_perimeters();
};

}    // namespace LAMMPS_NS

#endif
#endif
