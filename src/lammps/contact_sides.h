// The two sides of each pair of particles: which one faces which, on whatever rank it is, and what is recalled of
// them from one neighbour list to the next.

#ifndef LMP_CONTACT_SIDES_H
#define LMP_CONTACT_SIDES_H

#include "pointers.h"

#include "contact_table.h"

#include <vector>

namespace LAMMPS_NS {

// A number of each side, in rows of one length, one for each particle, ghosts included.
struct SideValues {
  std::vector<double> value;
  std::vector<double *> row;

  void reset(int rows, int stride);
  double bytes() const { return bytes_of(value, row); }
  double &operator[](std::size_t side) { return value[side]; }
};

class ContactSides : protected Pointers {
 protected:
  explicit ContactSides(class LAMMPS *lmp) : Pointers(lmp) {}

  int stride = 0;             // of rows, the same on all ranks
  std::vector<int> count;     // sides of each particle of this rank
  std::vector<int> mirror;    // of each side the other one; itself where that is out of reach
  SideValues shifts, before, earlier;    // s, and what it was one and two calls ago

  int side(int i, int c) const { return i * stride + c; }
  void exchange(SideValues &);
  void face(const ContactTable &);    // a new list of pairs
  double memory_usage() const;

 private:
  bool facing = false;    // mirrors are being sought

  // Of pairs whose list is gone.
  struct Known {
    tagint tag, partner;
    double x, y, shift, before, earlier;
    bool operator<(const Known &other) const
    {
      return tag != other.tag ? tag < other.tag : partner < other.partner;
    }
  };
  std::vector<tagint> tags;    // of particles of this rank
  SideValues partners, xs,
      ys;    // of sides: tag of the other particle, and where it is as seen from here
  std::vector<Known> recall();
};

}    // namespace LAMMPS_NS

#endif
