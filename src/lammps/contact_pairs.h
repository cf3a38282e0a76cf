// Pairs of particles from the neighbor list: their contact lines, computed for many pairs at a time.

#ifndef DEFORMABLE_CONTACT_PAIRS_H
#define DEFORMABLE_CONTACT_PAIRS_H

#include "contact_table.h"

#include <cstddef>
#include <vector>

namespace LAMMPS_NS {

// A structure of arrays, which the compiler can vectorize.
struct ContactPairs {
  int size = 0;
  std::vector<int> i, j;
  std::vector<double> dx, dy;    // from i to j
  std::vector<double> radius_i, radius_j;
  // the contact line
  std::vector<double> per_distance, nx, ny, angle;
  std::vector<double> indentation_i, indentation_j, d_indentation_i, d_indentation_j;

  void reserve(std::size_t most);
  void add(int i_, int j_, double dx_, double dy_, double ri, double rj)
  {
    i[size] = i_;
    j[size] = j_;
    dx[size] = dx_;
    dy[size] = dy_;
    radius_i[size] = ri;
    radius_j[size] = rj;
    ++size;
  }
};

void compute_contact_lines(ContactPairs &);

// Adds each pair to the row of i and, if j is one of the first nlocal particles, to the row of j. Returns -1,
// or the first pair whose contact line does not lie in front of the center of both particles.
int insert_pairs(const ContactPairs &, int nlocal, ContactTable &);

}    // namespace LAMMPS_NS

#endif
