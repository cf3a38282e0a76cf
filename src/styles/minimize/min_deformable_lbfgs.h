// Minimization by L-BFGS: min_style deformable/lbfgs. `min_modify` has the words of its own: memory m, precondition springs|none.
//
// With positions x and forces f = -dE/dx, the last m steps s and changes of the gradient y give an approximate inverse Hessian,
// which turns f into the next step q (two-loop recursion of Nocedal, Math. Comp. 35, 773 (1980)). It begins with gamma P^-1,
// gamma = s.y/(y.P^-1 y), of the last step. P has a spring for each contact, see SpringMatrix: contacts are stiff along their
// normals, and what a packing is slow to find are the motions that compress none. Without contacts P = 1.
//
// A step ends where
//
//   E <= E0 + 1e-4 part slope,  or  |flat| <= 0.9 |slope|  and  E <= E0 + 1e-10 |E0|
//
// slope and flat are -f.q before and after part q. The second test is for the end: the energy no longer falls by more than its
// rounding, but the slope still does.

#ifdef MINIMIZE_CLASS
// clang-format off
MinimizeStyle(deformable/lbfgs,MinDeformableLbfgs);
// clang-format on
#else

#ifndef DEFORMABLE_MIN_DEFORMABLE_LBFGS_H
#define DEFORMABLE_MIN_DEFORMABLE_LBFGS_H

#include "styles/minimize/lammps_min.h"

#ifdef DEFORMABLE_HAS_MIN

#include "kernels/spring_matrix.h"
#include "styles/pair/pair_deformable.h"

#include <vector>

namespace LAMMPS_NS {

class MinDeformableLbfgs : public Min {
 public:
  MinDeformableLbfgs(class LAMMPS *);
  void init() override;
  void setup_style() override;
  void reset_vectors() override;
  int iterate(int) override;
  int modify_param(int, char **) override;
  double memory_usage() override;

  // Whether a Min of this LAMMPS has the layout of lammps_min.h.
  static bool fits(class LAMMPS *);

 private:
  // a new Min has LAMMPS' defaults where lammps_min.h has them
  bool laid_out_as_declared;
  int memory = 10;    // [6, 30]: more save no time
  enum { IF_POSSIBLE, SPRINGS, NONE } precondition = IF_POSSIBLE;

  // per-atom vectors, which migrate with the atoms
  double *x0, *f0, *q;
  std::vector<double *> s, y;

  // The pairs (s, y), by the index of both, from the oldest one to the newest.
  std::vector<int> known;
  std::vector<double> sy;    // s_a.y_b at [a memory + b]
  std::vector<double> sf;    // s_a.f
  double gamma = 0.0;
  double &dot_sy(int a, int b) { return sy[a * memory + b]; }
  void remember(double part);
  double find_direction();

  double energy = 0.0;           // not over the number of atoms
  bool energy_follows = true;    // false: forces are not its derivatives
  bool follows_again = false;    // as soon as no area gives way
  bool law_changes() const;

  bool search(double slope, double &part);
  int descend(int maxiter);
  double evaluate();
  bool is_converged();
  bool is_at_rest();

  // of the contacts of our pair styles
  double accepted = 0.0;    // see PairDeformable::accept_imbalance
  bool may_be_loose = false;
  void balance_loosely();
  void balance_fully();

  // P
  PairDeformable *pair = nullptr;    // null: of another style
  bool preconditioned = false;       // else P = 1
  deformable::SpringMatrix matrix;
  std::vector<deformable::Spring> springs;
  bool outdated = true;        // P
  bool moved = false;          // atoms, to other indices and ranks, since P is there
  double *origin;              // per-atom vector: index and rank then
  std::vector<int> then;       // by local index: that of then, or -1: was on another rank
  std::vector<char> held;      // coordinates without a force, by the indices of then
  bool others_push = false;    // forces that do not add up to zero
  int renewed = 0;             // iteration
  int interval = 1;            // iterations from one look at the contacts to the next one
  double limit = 0.0;          // no coordinate changes by more in one step
  std::vector<double> solved;
  void renew();
  bool contacts_have_changed();
  void solve(const double *, double *);
};

}    // namespace LAMMPS_NS

#endif
#endif
#endif
