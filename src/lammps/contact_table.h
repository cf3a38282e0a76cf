// The contacts of particles on their way from the neighbour list to the contact law.

#ifndef DEFORMABLE_CONTACT_TABLE_H
#define DEFORMABLE_CONTACT_TABLE_H

#include "shape.h"

#include <vector>

namespace LAMMPS_NS {

// Memory that vectors hold.
template <class... Vector> double bytes_of(const Vector &...vector)
{
  return (static_cast<double>(vector.capacity() * sizeof(typename Vector::value_type)) + ... + 0.0);
}

// What a contact's force acts on.
struct Partner {
  int atom;                // local index, or -1 - w for wall w
  double d_indentation;    // da/dd, d the distance of the partner
  double per_lever;    // turn of the direction per sideways step of the partner: 1/d, walls aside
};

// The contacts found so far. Two particles of one rank share what belongs to their contact, so each is
// computed once, when the first of the two has its turn. Contacts live from then until the second one's
// turn: few particles have some at a time, and the rows they leave are taken again at once, so that the
// table stays in the cache however large the system.
struct ContactTable {
  int stride = 8;          // places in a row; doubled when a particle needs more
  std::vector<int> row;    // of each particle; -1: it has no contact yet
  std::vector<int> free_rows;
  std::vector<int> count;    // contacts in each row
  std::vector<deformable::Contact> contact;
  std::vector<Partner> partner;

  void clear(int nlocal);
  void make_room(int i);    // for one more contact of particle i; may move all of the above
  void add(int i, const deformable::Contact &, const Partner &);

  double bytes() const { return bytes_of(row, free_rows, count, contact, partner); }

  std::size_t first(int i) const { return static_cast<std::size_t>(row[i]) * stride; }

  deformable::Contacts of(int i) const
  {
    if (row[i] < 0) return {0, nullptr};
    return {count[row[i]], &contact[first(i)]};
  }

  void release(int i)
  {
    if (row[i] < 0) return;
    free_rows.push_back(row[i]);
    row[i] = -1;
  }
};

// What a law recalls of each particle's contacts from one call to the next, as a first guess: they come in
// the same order as long as none forms or breaks. start(first, last) fills it in where it is lost.
template <class T> struct Recall {
  int stride = 8;
  std::vector<T> value;
  std::vector<int> count;

  double bytes() const { return bytes_of(value, count); }

  template <class Start> T *of(int i, int n, Start &&start)
  {
    if (n > stride) {
      while (n > stride) stride *= 2;
      count.clear();
    }
    if (static_cast<std::size_t>(i) >= count.size()) {
      count.resize(i + 1, 0);
      value.resize(count.size() * stride);
    }
    T *const first = &value[static_cast<std::size_t>(i) * stride];
    if (count[i] != n) start(first, first + n);
    count[i] = n;
    return first;
  }
};

}    // namespace LAMMPS_NS

#endif
