// Pairs that two ranks share: each rank has the contact of its own particle, and the values of the other one from
// the other rank. Two ranks send each other one number of each pair that they share, and nothing to other ranks, so neither a
// particle of many contacts nor a rank without any costs anything.

#ifndef DEFORMABLE_REMOTE_SIDES_H
#define DEFORMABLE_REMOTE_SIDES_H

#include "solver/near_pairs.h"
#include "styles/lammps_names.h"

#include <vector>

namespace deformable {

class RemoteSides : protected Pointers {
 public:
  explicit RemoteSides(LAMMPS *lmp) : Pointers(lmp) {}

  // A pair of particle i and ghost j of another rank, at the relative position x.
  struct Candidate {
    int i, j, rank;
    Vector3 x;
    PairPast past;
  };

  // Leaves the candidates that the other rank has too, and gives a rank that knows no past that of the other. Two images of a particle
  // in one direction are told apart by their positions.
  void match(std::vector<Candidate> &candidates);

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

  // Appends the values of the other ranks' contacts to those of this rank's, to each of these arrays, that of remote pair c at
  // own + c; and of the rings of pairs.
  template <class... Number> void exchange(Number *...values)
  {
    exchange_of(contact, own, values...);
  }
  template <class... Number> void exchange_rings(Number *...values)
  {
    exchange_of(ring, own_rings, values...);
  }

  double sum(double of_this_rank) const;        // over all ranks
  double largest(double of_this_rank) const;    // of all ranks

  // Whether all ranks find a list sufficient. `refused`: whether this rank goes no further; then whether any does.
  bool all_ranks_sufficient(bool sufficient, bool &refused) const;

  // From each particle to its ghosts.
  void to_ghosts(std::vector<double> &by_particle);

  double bytes() const { return bytes_of(messages, sent_at, received_at, sent, received); }

 private:
  const int *contact = nullptr, *ring = nullptr;    // see arrange
  int own = 0, own_rings = 0;

  struct Message {    // to another rank and from it: of so many candidates, from these places on
    int rank, sent, first_sent, received, first_received;
  };
  std::vector<Message> messages;
  std::vector<int> sent_at, received_at;    // places of each pair
  static constexpr int MOST_ARRAYS = 4;     // that are exchanged at once
  std::vector<double> sent, received;       // of each place: the values of all arrays

  template <class Item> void send(const std::vector<Item> &sent, std::vector<Item> &received,
                                  int items);

  template <class... Number> void exchange_of(const int *of_pairs, int end, Number *...values)
  {
    constexpr int ARRAYS = sizeof...(Number);
    static_assert(ARRAYS <= MOST_ARRAYS, "`sent` has room for so many");
    if (messages.empty()) return;
    const int pairs = static_cast<int>(sent_at.size());
    for (int c = 0; c < pairs; ++c) {
      double *to = sent.data() + ARRAYS * sent_at[c];
      ((*to++ = values[of_pairs[c]]), ...);
    }
    send(sent, received, ARRAYS);
    for (int c = 0; c < pairs; ++c) {
      const double *from = received.data() + ARRAYS * received_at[c];
      ((values[end + c] = static_cast<Number>(*from++)), ...);
    }
  }
};

}    // namespace deformable

#endif
