// Pairs that two ranks share: each rank has the contact of its own particle, and the values of the other one from
// the other rank. Two ranks send each other one number of each pair that they share, and nothing to other ranks, so neither a
// particle of many contacts nor a rank without any costs anything.

#ifndef DEFORMABLE_REMOTE_SIDES_H
#define DEFORMABLE_REMOTE_SIDES_H

#include "solver/near_pairs.h"
#include "styles/lammps_names.h"

#include <cstring>
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
  std::vector<int> sent_at, received_at;                   // places of each pair
  static constexpr int MOST_BYTES = 4 * sizeof(double);    // of a pair that are exchanged at once
  std::vector<char> sent, received;    // of each place: the values of all arrays

  void send(const void *sent, void *received, int bytes_of_place);

  // As they are: those in single precision take half of the bytes.
  template <class... Number> void exchange_of(const int *of_pairs, int end, Number *...values)
  {
    constexpr std::size_t BYTES = (sizeof(Number) + ...);
    static_assert(BYTES <= MOST_BYTES, "`sent` has room for so many");
    if (messages.empty()) return;
    const int pairs = static_cast<int>(sent_at.size());
    for (int c = 0; c < pairs; ++c) {
      char *to = sent.data() + BYTES * sent_at[c];
      ((std::memcpy(to, &values[of_pairs[c]], sizeof(Number)), to += sizeof(Number)), ...);
    }
    send(sent.data(), received.data(), BYTES);
    for (int c = 0; c < pairs; ++c) {
      const char *from = received.data() + BYTES * received_at[c];
      ((std::memcpy(&values[end + c], from, sizeof(Number)), from += sizeof(Number)), ...);
    }
  }
};

}    // namespace deformable

#endif
