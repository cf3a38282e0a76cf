// The ring laws, whose contacts slip: pair_style deformable/ring [contact balanced|radical] [balance tol maxeval]
// [reach f] [radius type|atom]

#ifndef LMP_PAIR_DEFORMABLE_RING_H
#define LMP_PAIR_DEFORMABLE_RING_H

#include "pair_deformable.h"

#include "balanced_rings.h"
#include "soft_ring.h"

#include <memory>

namespace LAMMPS_NS {

class PairDeformableRing : public PairDeformable {
 public:
  PairDeformableRing(class LAMMPS *lmp) : PairDeformable(lmp, 4) {}
  void settings(int, char **) override;
  void init_style() override;
  void compute(int, int) override;
  double memory_usage() override;

 private:
  std::unique_ptr<BalancedRings> balanced;    // null: contacts stay on their radical axes
  bool soft = false;                          // some species does not conserve its perimeter
  double smallest = 0.0;    // radius of all particles, as of the last new neighbor list

  deformable::RingLCP lcp;
  WarmStart<char> active_contacts;    // of balanced contacts
  std::vector<char> is_active;        // of one ring

  template <bool WALLS, bool SOFT> void evaluate(int eflag, int vflag);
  template <bool WALLS, bool SOFT> void evaluate_balanced();
  template <bool WALLS, bool SOFT> void evaluate_radical();
  template <bool SOFT> deformable::Energy deform(int i, const deformable::Contacts &);
  template <bool SOFT>
  deformable::Energy shape_ring(int i, const deformable::Contacts &, char *active);
  template <bool WALLS>
  void finish(int i, const deformable::Contacts &, const deformable::Energy &);
  template <class PartnerOf>
  void check_reach(int i, const deformable::Contacts &, PartnerOf &&partner_of);
  [[noreturn]] void refuse_bulge(int i, int partner, double indentation, double ratio,
                                 double depth);
  [[noreturn]] void no_shape(int i, int contacts);
};

}    // namespace LAMMPS_NS

#endif
