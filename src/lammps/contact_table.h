// The table of contacts: from the neighbor list to the contact law.

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

// The other side of a contact, on which its force acts too.
struct Partner {
  int atom;                // local index, or -1 - (w + n feature) for wall fix w of n
  double d_indentation;    // da/dd, d the distance of the partner
  double
      per_lever;    // rotation of the direction per sideways step of the partner: 1/d except for walls
};

// A row of contacts for each particle that has some. A contact of two particles of one rank is computed once,
// for both, when the first of them is evaluated. Its row is released after the second one is evaluated, and
// used again, so that few rows are in use and the table stays in the cache for any size of the system.
struct ContactTable {
  int stride = 8;          // places in a row; doubled when a particle needs more
  std::vector<int> row;    // of each particle; -1: it has no contact yet
  std::vector<int> free_rows;
  std::vector<int> count;    // contacts in each row
  std::vector<deformable::Contact> contact;
  std::vector<Partner> partner;

  void clear(int nlocal);
  void make_room(int i);    // for one more contact of particle i; may move all memory of the table
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

// A value of each contact of a particle that a law keeps from one call to the next, as a first guess. Contacts
// stay in the same order as long as none forms or breaks; otherwise start(first, last) sets the values anew.
template <class T> struct WarmStart {
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
