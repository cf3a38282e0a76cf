// Contact lines where both sides press with the same force: contact balanced.
//
// Each pair shares its overlap by a number s of its own, a_ij = radical + s, a_ji = radical - s. The energy of
// all particles is convex in all s, and smallest where F_ij = F_ji. Newton's method finds that, conjugate
// gradients solve its linear systems. A pair has two sides, one in the row of each particle; a number of the pair
// has opposite signs there. Both are computed from the same numbers, so that ranks that share a pair agree to
// the last bit.

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

  // Shapes all particles of this rank by their contacts, with the shifts as they are now, and says by `press`
  // what their sides feel. Returns their energy and the largest force on them, walls included.
  struct Load {
    double energy, largest;
  };
  using Sweep = std::function<Load()>;

  // The rings of the last sweep.
  using Rings = std::function<deformable::PressedRing(int i)>;

  // The contacts on their radical axes, each row with the walls last; rows stay the same as long as the
  // neighbour list does. Returns whether the sides agree.
  bool settle(const ContactTable &, bool new_list, const Sweep &, const Rings &);

  int sides_of(int i) const { return count[i]; }
  double shift(int i, int c) { return shifts[side(i, c)]; }
  void press(int i, int c, double force) { forces[side(i, c)] = force; }

  double memory_usage() const;

 private:
  // A pair that carries, seen from this side: once where both sides are of this rank, from each side where
  // they are not.
  struct Pair {
    int side, mirror;
    double share;    // of the pair in sums over all ranks
  };
  std::vector<Pair> moving;

  SideValues forces, steps, answers;
  std::vector<double> gradient, left, search, turned, per_diagonal;
  deformable::RingProgramme programme;

  // Shifts to begin with.
  bigint last_step = -2;
  int run_up = 0;    // calls before this one of successive steps, up to 3
  void start();
  void rest();
  bool part(const Rings &);

  // Stiffness of particles that carry, at the contacts that do, walls last. G^-1 belongs to these contacts.
  struct Block {
    int begin, size, sides;    // in carrying; sides: without walls
    std::size_t matrix;        // in inverses and matrices
  };
  std::vector<Block> blocks;    // by particle
  std::vector<int> carrying;    // place in the row
  std::vector<double> inverses, matrices, rate;
  void stiffen(const Rings &);
  void find_step(double accuracy);

  struct Point {
    double energy, slope;     // slope: along the step
    double largest, worst;    // force, |F_ij - F_ji|
    bool settled(double tolerance) const { return worst <= tolerance * largest; }
  };
  double total(double part) const;
  double slope();
  Point look(const Sweep &);
  Point descend(const Point &, const Sweep &);
};

}    // namespace LAMMPS_NS

#endif
