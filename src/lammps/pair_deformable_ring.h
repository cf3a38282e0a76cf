// Contacts that slip: pair_style deformable/ring [contact radical|balanced] [balance tol maxiter]
// [reach f] [radius type|atom]

#ifndef LMP_PAIR_DEFORMABLE_RING_H
#define LMP_PAIR_DEFORMABLE_RING_H

#include "pair_deformable.h"

#include "contact_balance.h"
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
  deformable::RingProgramme programme;
  Recall<char> carried;     // which contacts carried
  double smallest = 0.0;    // radius of all particles, as of the last new neighbour list

  bool soft = false;    // is there a species whose perimeter is not conserved?

  template <bool WALLS, bool SOFT> void evaluate(int eflag, int vflag);
  template <bool SOFT> deformable::Energy deform(int i, const deformable::Contacts &);
  template <bool WALLS>
  void finish(int i, const deformable::Contacts &, const deformable::Energy &);
  void check_reach(int i, const deformable::Contacts &);
  [[noreturn]] void no_shape(int i, int contacts);

  // Of balanced contacts, all particles at once: what the law has made of them, the responses by place in
  // the table.
  struct Deformed {
    double area_deficit, perimeter_excess, arc_radius;
    double largest;    // force
    deformable::Energy energy;
  };
  std::unique_ptr<ContactBalance> balance;    // null: contacts stay on the radical axis
  bool unbalanced = false;                    // so it has been said
  std::vector<Deformed> deformed;
  std::vector<deformable::Response> responses;
  std::vector<double> radical;    // indentations, by place in the table
  template <bool WALLS, bool SOFT> void evaluate_balanced();
  template <bool SOFT> ContactBalance::Load sweep(const char *acts);
  deformable::PressedRing pressed(int i) const;
};

}    // namespace LAMMPS_NS

#endif
