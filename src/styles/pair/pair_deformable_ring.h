// The ring laws, whose contacts slip: pair_style deformable/ring [contact balanced|curved|radical]
// [balance tol maxeval] [reach f] [radius type|atom] [kA type|atom] [tension type|atom]

#ifdef PAIR_CLASS
// clang-format off
PairStyle(deformable/ring,PairDeformableRing);
// clang-format on
#else

#ifndef DEFORMABLE_PAIR_DEFORMABLE_RING_H
#define DEFORMABLE_PAIR_DEFORMABLE_RING_H

#include "styles/pair/block_forces.h"
#include "styles/pair/pair_deformable.h"

#include "laws/soft_ring.h"
#include "solver/ring_solver.h"
#include "styles/species.h"

#include <memory>
#include <string>

namespace LAMMPS_NS {

class PairDeformableRing : public PairDeformable {
 public:
  PairDeformableRing(class LAMMPS *lmp) : PairDeformable(lmp, 8) {}
  void settings(int, char **) override;
  std::string law() const override;
  void coeff(int, char **) override;
  void *extract(const char *, int &) override;
  void init_style() override;
  void compute(int, int) override;
  void finish() override;
  void check_state() const override;
  double memory_usage() override;
  double energy_alone(int i, int partner, double force) const override;
  bool knows_energy_alone() const override { return balanced != nullptr; }
  void accept_imbalance(double force) override
  {
    if (balanced) balanced->accepted = force;
  }
  bool law_changes() const override { return soft_since != NEVER && all_giving_way() > 0; }

 protected:
  bool bends_lines() const override { return balanced && balanced->pairs().curved; }
  void use_films() override { balanced->use_films(); }
  void outline_of(int i, const std::vector<deformable::RecordedContact> &, int points,
                  deformable::Outline &) const override;

 private:
  deformable::BlockForces blocks{*this};               // of contacts on their radical axes
  std::unique_ptr<deformable::RingSolver> balanced;    // null: contacts stay there
  // Stiffness and tension of single particles, of fix property/atom
  bool kA_by_atom = false, tension_by_atom = false;
  int kA_of_atoms = -1, tension_of_atoms = -1;    // indices of custom properties
  int property_of_atoms(const std::string &name) const;
  void find_properties();
  void check_properties();

  // Particles without room
  static constexpr bigint NEVER = -1;
  bigint soft_since = NEVER;    // iteration of a minimization since which areas give way
  int giving_way = 0;           // particles of this rank, in this call
  bool warned_no_room = false;
  bool may_give_way() const;
  bool choose_yield();
  void begin_to_give_way();
  deformable::Energy shape_without_room(int i, const deformable::Contacts &);
  int all_giving_way() const;
  void tell_room();

  deformable::RingLCP lcp;
  std::vector<char> is_active;    // of one ring

  void evaluate_radical();
  deformable::Energy shape_ring(int i, const deformable::Contacts &, const deformable::Stiffness &);

  std::vector<deformable::Contact> contacts;    // of one particle
  std::vector<int> pair_sides;
  void evaluate_balanced(bool new_material);
  deformable::Vector2 push_of(int k, double force, const deformable::NearPairs::Centers &,
                              double share, double slope) const;
  double push_pairs(int begin, int end, double part, bool is_final);    // see DualSolver::Push
  void tally(int k, double px, double py, const deformable::NearPairs::Centers &, double rest);
  void refuse_pair(int k);
  void finish_balanced(int i);
  void load_contacts_of_pairs();

  // Whether all lines that the outline in `shape` may touch are known.
  bool is_within_reach(int i, const deformable::Contacts &);
  double depth_of_reach(int i) const;
  static int deepest(const deformable::Contacts &);
  [[noreturn]] void refuse_bulge(int i, const deformable::Contacts &, int partner);
  double largest_adhesion(int i) const;
  [[noreturn]] void no_shape(int i, int contacts);
};

}    // namespace LAMMPS_NS

#endif
#endif
