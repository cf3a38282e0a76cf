// The area term of bead rings: fix ID group deformable/polygon kA [rest initial|AREA]
//
// A ring is a molecule whose beads follow one another in tag order. With bond_style harmonic along the ring
// and pair_style harmonic/cut between rings this is the deformable-polygon model, the reference that the
// deformable pair styles are compared with.

#ifndef LMP_FIX_DEFORMABLE_POLYGON_H
#define LMP_FIX_DEFORMABLE_POLYGON_H

#include "fix.h"

#include "bead_rings.h"

#include <vector>

namespace LAMMPS_NS {

class FixDeformablePolygon : public Fix {
 public:
  FixDeformablePolygon(class LAMMPS *, int, char **);
  // No style name may contain "deform", see fix_deformable_wall.h.
  static constexpr const char *STYLE = "polygon/area";

  int setmask() override;
  void init() override;
  void setup(int) override;
  void min_setup(int) override;
  void post_force(int) override;
  void min_post_force(int) override;
  void post_run() override;
  double compute_scalar() override;
  double compute_array(int, int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

 private:
  // Areas are signed, so that the energy stays smooth where a ring turns inside out. The center, from which
  // areas are measured, is the mean of the beads as of the call before.
  struct Ring : BeadRing {
    double rest_area = 0.0;
    std::size_t links_end = 0;
  };
  std::vector<Ring> rings;    // by rising molecule ID, the same on every rank
  std::vector<double> sums;
  bool perimeters_known = true;    // they cost a look at every bead, which few scenes ask for

  double kA;
  double given_rest_area = 0.0;    // 0: the initial area of each ring

  // A bead of this rank and those beside it, by local index: ring after ring, along each ring.
  struct Link {
    int bead, previous, next;
  };
  std::vector<Link> links;
  bigint links_of_build = -1;    // they change with the neighbor list

  std::vector<Ring> find_rings();
  void link_beads();
  int beside(int i, const Ring &ring, tagint tag) const;
  void from_center(const Ring &ring, int i, double &x, double &y) const;
  void measure_areas();
  void measure_perimeters();
};

}    // namespace LAMMPS_NS

#endif
