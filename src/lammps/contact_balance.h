// Balanced contacts: each contact line lies where the forces of both sides are equal.
//
// The unknown of each pair is a shift s of its line from the radical axis: a_ij = radical + s, a_ji = radical - s.
// The energy of all particles is convex in all shifts and smallest where F_ij = F_ji. Newton's method finds that
// minimum; conjugate gradients solve its linear systems. A pair has two sides, one in the row of each particle,
// where numbers of the pair have opposite signs. Both sides compute them from the same numbers, so that ranks that
// share a pair agree to the last bit. Only particles near an unbalanced contact are selected and shaped anew: in
// large systems few contacts open or close in a step.

#ifndef LMP_CONTACT_BALANCE_H
#define LMP_CONTACT_BALANCE_H

#include "contact_sides.h"
#include "contact_stiffness.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace LAMMPS_NS {

class ContactBalance : ContactSides {
 public:
  ContactBalance(class LAMMPS *lmp, double tolerance, int max_evaluations)
      : ContactSides(lmp),
        tolerance(tolerance),
        max_evaluations(max_evaluations)
  {
  }

  const double tolerance;       // of |F_ij - F_ji| over the largest force
  const int max_evaluations;    // of a call

  // of the last call
  int evaluations = 0;
  double imbalance = 0.0;    // largest |F_ij - F_ji| over the largest force

  // Shapes the selected particles of this rank with the present shifts and passes the force of each of their
  // sides to set_force. Returns the energy of all particles and the largest of all forces, walls included.
  struct Totals {
    double energy, largest_force;
  };
  using ShapeRings = std::function<Totals(const char *selected)>;

  // Particle i as shaped last.
  using RingOf = std::function<deformable::RingState(int i)>;

  // The table holds the contacts on their radical axes, in each row with the walls last; rows keep their order as
  // long as the neighbor list. Returns whether all contacts are balanced.
  bool solve(const ContactTable &, bool new_list, const ShapeRings &, const RingOf &);

  int sides_of(int i) const { return count[i]; }
  double shift(int i, int c) { return shifts[side(i, c)]; }
  void set_force(int i, int c, double force) { forces[side(i, c)] = force; }

  double memory_usage() const;

 private:
  struct Evaluation {
    double energy, slope;    // slope: along the last step
    double largest_force, largest_imbalance;
    bool one_sided;    // some line has a force on one side only
    bool is_balanced(double tolerance) const
    {
      return largest_imbalance <= tolerance * largest_force;
    }
  };

  SideValues forces, scratch;
  std::vector<double> gradient;    // of each side, F_ij - F_ji
  std::vector<int> ghost_sides;    // sides of this rank whose mirror belongs to a ghost
  void reset(const ContactTable &);

  // Initial shifts.
  bigint last_step = -2;
  int consecutive_calls = 0;    // at successive steps before this one, up to 3
  void extrapolate_shifts();
  void freeze_unloaded();

  // Selected particles.
  std::vector<char> selected;    // of each particle
  std::vector<int> selection;    // their indices, in the order of selection
  void select_particles(double balanced_below);

  // Lines that jump.
  std::vector<int> separated;    // their sides
  SideValues gaps;    // between outline and line; negative where the line indents the outline
  bool separate(const RingOf &, double balanced_below);

  // Stiffness of a selected particle at its active contacts, walls last, and G^-1 of these contacts.
  struct Block {
    int begin, size, sides;    // in active_contacts; sides: without walls
    std::size_t matrix;        // in inverses and matrices
  };
  std::vector<Block> blocks;           // by particle
  std::vector<int> active_contacts;    // place in the row
  std::vector<double> inverses, matrices, rate;
  deformable::RingLCP lcp;
  void assemble_hessian(const RingOf &);

  // Pairs with an unknown: active ones of selected particles. Pair 0 stands for all others. Pairs of two particles
  // of this rank come next, each once. Pairs with a ghost come last, with the near side of the pair; they count
  // half in sums over ranks.
  struct Pair {
    int side, mirror;
  };
  static constexpr int NO_PAIR = 0;
  std::vector<Pair> pairs;
  std::size_t first_ghost_pair = 1;
  std::vector<int> pair_of;    // of each side: 2 x index of its pair, + 1 for the mirror
  void clear_pairs();
  void number_pairs();

  // The linear system, by pair.
  std::vector<double> steps, residual, direction, product, preconditioner;
  void newton_step(double balanced_below, const Evaluation &from);
  void apply_hessian();    // product = H direction

  // Along a step.
  double slope();
  Evaluation evaluate(const ShapeRings &);
  Evaluation line_search(const Evaluation &from, const ShapeRings &);

  double sum_over_ranks(double part) const;
  template <class Term> double sum_over_pairs(Term &&term) const
  {
    double whole = 0.0, halves = 0.0;
    for (std::size_t p = 1; p < first_ghost_pair; ++p) whole += term(p);
    for (std::size_t p = first_ghost_pair; p < pairs.size(); ++p) halves += term(p);
    return sum_over_ranks(whole + 0.5 * halves);
  }
};

}    // namespace LAMMPS_NS

#endif
