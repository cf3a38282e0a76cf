// Contact lines where both sides press with the same force: contact balanced.
//
// Each pair shares its overlap by a number s of its own, a_ij = radical + s, a_ji = radical - s. The energy of
// all particles is convex in all s, and smallest where F_ij = F_ji. Newton's method finds that, conjugate
// gradients solve its linear systems. A pair has two sides, one in the row of each particle; a number of the pair
// has opposite signs there. Both are computed from the same numbers, so that ranks that share a pair agree to
// the last bit. Only particles near a pair that is not in balance act: of many, few have a contact that opens.

#ifndef LMP_CONTACT_BALANCE_H
#define LMP_CONTACT_BALANCE_H

#include "balance.h"
#include "contact_sides.h"

#include <cstddef>
#include <functional>
#include <vector>

namespace LAMMPS_NS {

class ContactBalance : ContactSides {
 public:
  explicit ContactBalance(class LAMMPS *lmp) : ContactSides(lmp) {}

  double tolerance = 1e-8;    // of |F_ij - F_ji|, in units of the largest force
  int limit = 100;            // sweeps of a call

  int sweeps = 0;           // of the last call
  double residual = 0.0;    // what it has left of |F_ij - F_ji|, in units of the largest force

  // Shapes those particles of this rank that act by their contacts, with the shifts as they are now, and says
  // by `press` what their sides feel. Returns the energy of all and the largest force on any, walls included.
  struct Load {
    double energy, largest;
  };
  using Sweep = std::function<Load(const char *acts)>;

  // The rings as last shaped.
  using Rings = std::function<deformable::PressedRing(int i)>;

  // The contacts on their radical axes, each row with the walls last; rows stay the same as long as the
  // neighbour list does. Returns whether the sides agree.
  bool settle(const ContactTable &, bool new_list, const Sweep &, const Rings &);

  int sides_of(int i) const { return count[i]; }
  double shift(int i, int c) { return shifts[side(i, c)]; }
  void press(int i, int c, double force) { forces[side(i, c)] = force; }

  double memory_usage() const;

 private:
  struct Point {
    double energy, slope;     // slope: along the last step
    double largest, worst;    // force, |F_ij - F_ji|
    bool one_sided;           // does a line press on one side only?
    bool settled(double tolerance) const { return worst <= tolerance * largest; }
  };

  SideValues forces, answers;      // answers: of a particle's stiffness
  std::vector<double> gradient;    // of each side, F_ij - F_ji
  std::vector<int> abroad;         // sides that face a ghost, an image or of another rank

  // Shifts to begin with.
  bigint last_step = -2;
  int run_up = 0;    // calls before this one of successive steps, up to 3
  void start();
  void rest();

  // Particles that act: those with a contact that is not in balance, and those around them.
  std::vector<char> acts;    // of each particle
  std::vector<int> newly;    // in the order that they began to
  void choose(double unsettled);

  // Lines that jump, seen from their sides.
  std::vector<int> parted;
  SideValues room;    // before the outline; negative where it is pressed
  bool part(const Rings &, double unsettled);

  // Stiffness of particles that act and carry, at the contacts that do, walls last. G^-1 belongs to these contacts.
  struct Block {
    int begin, size, sides;    // in carrying; sides: without walls
    std::size_t matrix;        // in inverses and matrices
  };
  std::vector<Block> blocks;    // by particle
  std::vector<int> carrying;    // place in the row
  std::vector<double> inverses, matrices, rate;
  deformable::RingProgramme programme;
  void stiffen(const Rings &);

  // Pairs that carry, of particles that act. The first one is none: it stands for all that do not move. Those
  // of two particles of this rank come next, each once; those with ghosts have the near side here, and half a share.
  struct Pair {
    int side, mirror;
  };
  std::vector<Pair> moving;
  std::size_t within = 1;      // where those with ghosts begin
  std::vector<int> pair_of;    // of each side: twice its pair's place; one more for a mirror
  static constexpr int NO_PAIR = 0;
  void pair_up();

  // The linear system, by pair.
  std::vector<double> steps, left, search, turned, weight;
  void find_step(double unsettled, const Point &from);
  void turn();

  // The way along a step.
  double slope();
  Point look(const Sweep &);
  Point descend(const Point &, const Sweep &);

  double total(double part) const;
  template <class Term> double sum_over_pairs(Term &&term) const
  {
    double whole = 0.0, halves = 0.0;
    for (std::size_t p = 1; p < within; ++p) whole += term(p);
    for (std::size_t p = within; p < moving.size(); ++p) halves += term(p);
    return total(whole + 0.5 * halves);
  }
};

}    // namespace LAMMPS_NS

#endif
