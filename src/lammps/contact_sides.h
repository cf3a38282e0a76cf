// The two sides of each contact of two particles, on the same rank or on two: which side is the other one's mirror,
// and which shifts of the contact line they keep from one neighbor list to the next.

#ifndef LMP_CONTACT_SIDES_H
#define LMP_CONTACT_SIDES_H

#include "pointers.h"

#include "contact_table.h"

#include <vector>

namespace LAMMPS_NS {

// A number for each side, in rows of equal length, one row for each particle, ghosts included.
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
  std::vector<int> mirror;    // the other side of each side; itself if that is out of reach
  SideValues shifts, last_shifts, second_last_shifts;    // s now, and one and two calls ago

  int side(int i, int c) const { return i * stride + c; }
  void exchange(SideValues &);
  void match_sides(const ContactTable &);    // for a new neighbor list
  double memory_usage() const;

 private:
  bool matching = false;

  // A side as the last neighbor list had it.
  struct OldSide {
    tagint tag, partner;
    double x, y, shift, last_shift, second_last_shift;
    bool operator<(const OldSide &other) const
    {
      return tag != other.tag ? tag < other.tag : partner < other.partner;
    }
  };
  std::vector<tagint> tags;       // of particles of this rank
  SideValues partners, xs, ys;    // of sides: tag and relative position of the other particle
  std::vector<OldSide> old_sides();
};

}    // namespace LAMMPS_NS

#endif
