// Pairs of particles that meet: where their contact line lies, for many at a time.

#ifndef DEFORMABLE_CONTACT_PAIRS_H
#define DEFORMABLE_CONTACT_PAIRS_H

#include <cstddef>
#include <vector>

namespace LAMMPS_NS {

// A structure of arrays, so that vector registers can be filled from it.
struct ContactPairs {
  int size = 0;
  // who meets
  std::vector<int> i, j;
  std::vector<double> dx, dy;    // from i to j
  std::vector<double> radius_i, radius_j;
  // and how
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

// Fills in how all pairs meet.
void meet(ContactPairs &);

}    // namespace LAMMPS_NS

#endif
