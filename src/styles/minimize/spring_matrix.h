// Springs between particles as a matrix P, and P^-1 q:
//
//   P = sum over springs of w (n, -n) (n, -n)^T + epsilon <diagonal> 1
//
// P is factorized, P = L L^T, with one block of d x d numbers for each particle or pair. Nested dissection keeps L sparse: a
// line (in space: a surface) of particles that parts the others comes after them, and so on in both parts. L has some
// 3 N log2 N blocks in the plane.

#ifndef DEFORMABLE_SPRING_MATRIX_H
#define DEFORMABLE_SPRING_MATRIX_H

#include "geometry/surface.h"

#include <vector>

namespace LAMMPS_NS {

class SpringMatrix {
 public:
  struct Element {
    int i, j;    // j < 0: something that does not move
    deformable::Vector3 n;
    double weight;
  };

  // Of n particles at x. A coordinate that is held has no spring to others: it is 3 i + axis.
  void factorize(int dimension, int n, const double *x, const std::vector<char> &held,
                 const std::vector<Element> &elements);
  // z = P^-1 q, three numbers for each particle; index[i] is that of particle i when P was factorized, or -1: P is diagonal for a
  // newcomer, and those that have left stay. In the plane the third number is divided by the diagonal.
  void solve(const std::vector<int> &index, const double *q, double *z);
  double solves_per_factor() const;    // that take as long as to factorize P
  double memory_usage() const;

 private:
  static constexpr double EPSILON = 0.003;

  int dimension = 0, size = 0;
  double products = 0.0;            // of blocks, to factorize
  double mean = 1.0;                // of the diagonal
  std::vector<int> order, place;    // particle at each place, and back
  std::vector<int> first, row;      // blocks of each column, below the diagonal
  std::vector<double> value;        // of these blocks
  std::vector<double> diagonal;     // inverses of the lower triangles on it
  std::vector<double> unknown;

  // neighbors of each particle
  std::vector<int> first_neighbor, neighbor;
  // Where a part is too large it is cut instead: springs between `group`s are left out.
  std::vector<int> side, group;
  int sides = 0, groups = 0;
  void dissect(const double *x, int begin, int end);
  void find_structure();
  template <int D>
  void factorize(const std::vector<char> &held, const std::vector<Element> &elements);
  template <int D> void solve_blocks();
};

}    // namespace LAMMPS_NS

#endif
