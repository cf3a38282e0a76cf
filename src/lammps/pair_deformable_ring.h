// Contacts that slip: pair_style deformable/ring [reach f]

#ifndef LMP_PAIR_DEFORMABLE_RING_H
#define LMP_PAIR_DEFORMABLE_RING_H

#include "pair_deformable.h"
#include "soft_ring.h"

namespace LAMMPS_NS {

class PairDeformableRing : public PairDeformable {
 public:
  PairDeformableRing(class LAMMPS *lmp) : PairDeformable(lmp) {}
  void settings(int, char **) override;
  void init_style() override;
  void compute(int, int) override;

 private:
  deformable::RingProgramme programme;
  Recall<char> carried;         // which contacts carried
  std::vector<double> depth;    // by atom type: how far out of the circle candidates are complete

  bool soft = false;    // is there a species whose perimeter is not conserved?

  template <bool WALLS, bool SOFT> void evaluate(int eflag, int vflag);
  deformable::Energy soften(int i, const deformable::Contacts &, char *carries);
  void check_reach(int i, const deformable::Contacts &);
};

}    // namespace LAMMPS_NS

#endif
