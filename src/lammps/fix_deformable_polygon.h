// The area term of bead rings: fix ID group deformable/polygon kA [rest initial|AREA]
//
// A ring is a molecule whose beads follow one another in tag order. With bond_style harmonic along the ring
// and pair_style harmonic/cut between rings this is the deformable-polygon model, the reference that the
// deformable pair styles are compared with.

#ifndef LMP_FIX_DEFORMABLE_POLYGON_H
#define LMP_FIX_DEFORMABLE_POLYGON_H

#include "fix.h"

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
  double compute_scalar() override;
  double compute_array(int, int) override;
  void write_restart(FILE *) override;
  void restart(char *) override;
  double memory_usage() override;

 private:
  struct Ring {
    tagint molecule, first;
    int beads;
    double orientation;    // 1 or -1: beads run counterclockwise or clockwise
    double rest_area;
  };
  // What the beads of a ring add up to; every rank has the sums over all of them.
  struct Sums {
    double area;    // signed
    double x, y;    // of the beads from `centre`
  };

  double kA;
  double given_rest_area = -1.0;    // or negative: the initial area of each ring
  std::vector<Ring> rings;          // by rising molecule ID, the same on every rank
  std::vector<int> ring_of_molecule;
  tagint lowest_molecule = 0;

  // Where a local bead stands in its ring, by local index; valid until the neighbour list is rebuilt.
  struct Link {
    int ring, previous, next;    // ring = -1: not of the group
  };
  std::vector<Link> links;
  bigint links_of_build = -1;

  std::vector<Sums> sums;
  std::vector<double> centre;    // mean of the beads a call ago, from which areas keep their digits
  std::vector<double> perimeter;
  bool perimeters_known = false;    // they cost a look at every bead, which few scenes ask for

  std::vector<Ring> find_rings();
  void adopt(std::vector<Ring> &&found);
  void link_beads();
  void measure_areas();
  void measure_perimeters();
  void unwrapped(int i, double &x, double &y) const;
  double pressure(int ring) const;
};

}    // namespace LAMMPS_NS

#endif
