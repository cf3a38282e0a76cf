// Pairs that two ranks share: each rank has the contact of its own particle, and the values of the other one from
// the other rank.

#ifndef LMP_REMOTE_SIDES_H
#define LMP_REMOTE_SIDES_H

#include "pointers.h"

#include "solver/near_pairs.h"

#include <vector>

namespace LAMMPS_NS {

class RemoteSides : protected Pointers {
 public:
  explicit RemoteSides(class LAMMPS *lmp) : Pointers(lmp) {}

  // A pair of particle i and ghost j at the relative position x.
  struct Candidate {
    int i, j;
    deformable::Vector3 x;
    PairPast past;
  };

  // Leaves the candidates that the other rank has too, and gives both ranks the same past. Two images of a particle
  // in one direction are told apart by their positions.
  void match(std::vector<Candidate> &candidates, bool curved);

  // The contacts of this rank's particles that these pairs have, in the order of match, and the number of all its contacts.
  void arrange(const int *contacts_of_pairs, int contacts)
  {
    contact = contacts_of_pairs;
    own = contacts;
  }

  void arrange_rings(const int *rings_of_pairs, int rings)
  {
    ring = rings_of_pairs;
    own_rings = rings;
  }

  // Appends the values of the other ranks' contacts to those of this rank's; and of the rings of pairs.
  template <class Number, class Other = Number>
  void exchange(Number *values, Other *more = nullptr)
  {
    exchange(values, more, contact, own);
  }
  template <class Number> void exchange_rings(Number *values, Number *more = nullptr)
  {
    exchange(values, more, ring, own_rings);
  }

  double sum(double of_this_rank) const;        // over all ranks
  double largest(double of_this_rank) const;    // of all ranks

  // Whether all ranks find a list sufficient. `refused`: whether this rank goes no further; then whether any does.
  bool all_ranks_sufficient(bool sufficient, bool &refused) const;

  // From each particle to its ghosts.
  void to_ghosts(std::vector<double> &by_particle);

  double bytes() const { return bytes_of(buffer, rows, sent, received, sides); }

 private:
  const int *contact = nullptr, *ring = nullptr;    // see arrange
  int own = 0, own_rings = 0;
  int slots = 0;    // of a row, the same on all ranks
  std::vector<double> buffer;
  std::vector<double *> rows;              // of each particle: value by value, the slots
  std::vector<double *> sent, received;    // places of each pair in its rows, of the first value
  std::vector<int> sides;                  // of each particle: its pairs with other ranks
  void set_rows(int values);
  template <class Number, class Other>
  void exchange(Number *values, Other *more, const int *of_pairs, int end);
};

}    // namespace LAMMPS_NS

#endif
