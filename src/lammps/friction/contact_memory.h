// What contacts remember from step to step: of each particle, by its partners. It goes with the particles, to other ranks and
// into restart files.
//
// Of two particles the one with the smaller ID remembers. A contact is the same from both sides but for its directions: the
// spring keeps its sign.

#ifndef LMP_CONTACT_MEMORY_H
#define LMP_CONTACT_MEMORY_H

#include "friction.h"

#include "lmptype.h"

#include <cstddef>
#include <vector>

namespace LAMMPS_NS {

// A contact as the particle that remembers sees it.
struct ContactPlace {
  double x, y;      // center of the partner, from that of the particle; 0 for a wall
  double bx, by;    // middle of the contact
  double nx, ny;    // towards the partner
};

struct RememberedContact {
  double partner;    // ID, or the code < 0 of a wall
  double kt;
  ContactPlace place;
  double xi, force, damping;
  double is_here;    // in this step

  static constexpr int SIZE = 12;    // numbers of it
};

class ContactMemory {
 public:
  // The contact with this partner whose place is the nearest one, as a small box has several images of it; or null. Between
  // a particle and its own image both directions are one.
  RememberedContact *find(int i, double partner, const ContactPlace &, bool own_image);
  RememberedContact &add(int i, double partner, double kt, const ContactPlace &);

  std::vector<RememberedContact> &of(int i) { return rows[i]; }

  void resize(std::size_t particles) { rows.resize(particles); }
  void copy(int from, int to) { rows[to] = rows[from]; }
  void clear(int i) { rows[i].clear(); }

  // Numbers in a buffer: how many there are, and its contacts.
  int size(int i) const { return 1 + RememberedContact::SIZE * static_cast<int>(rows[i].size()); }
  int pack(int i, double *) const;
  int unpack(int i, const double *);

  double bytes() const;

 private:
  std::vector<std::vector<RememberedContact>> rows;    // by local index
};

}    // namespace LAMMPS_NS

#endif
