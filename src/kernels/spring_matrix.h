// Springs between particles as a matrix P, and P^-1 q:
//
//   P = sum over springs of w (n, -n) (n, -n)^T + epsilon <diagonal> 1
//
// P is factorized, P = L L^T. Nested dissection keeps L sparse: a line (in space: a surface) of particles that parts the others
// comes after them, and so on in both parts. The columns of such a line, or of the few particles of a last part, are a front: they
// have the same rows below, and are factorized as one dense matrix, what they subtract from these rows being added to the front that
// comes next of these (the multifrontal method: I. S. Duff and J. K. Reid, ACM Trans. Math. Softw. 9, 302 (1983)). L is in single
// precision, which is enough for a preconditioner.

#ifndef DEFORMABLE_SPRING_MATRIX_H
#define DEFORMABLE_SPRING_MATRIX_H

#include "geometry/surface.h"
#include "kernels/batch_kernels.h"

#include <cstddef>
#include <vector>

namespace deformable {

class SpringMatrix {
 public:
  struct Element {
    int i, j;    // j < 0: something that does not move
    Vector3 n;
    double weight;
  };

  // Of n particles at x. A coordinate that is held has no spring to others: it is 3 i + axis.
  void factorize(const FrontKernels &, int dimension, int n, const double *x,
                 const std::vector<char> &held, const std::vector<Element> &elements,
                 double epsilon);
  // z = P^-1 q, three numbers for each particle; index[i] is that of particle i when P was factorized, or -1: P is diagonal for a
  // newcomer, and those that have left stay. In the plane the third number is divided by the diagonal.
  void solve(const std::vector<int> &index, const double *q, double *z);
  int particles() const { return size; }
  double solves_per_factor() const;    // that take as long as to factorize P
  double memory_usage() const;

 private:
  FrontKernels kernels{};
  int dimension = 0, size = 0;
  double mean = 1.0;                // of the diagonal
  std::vector<int> order, place;    // particle at each place, and back

  // Places begin to end, and those of the rows below: `rows` from first_row on. Columns of L of all coordinates follow each other in
  // `lower` from `at` on, each of `height` numbers, with one over the element on the diagonal in its place.
  struct Front {
    int begin, end, first_row, last_row, height;
    std::size_t at;
  };
  std::vector<Front> fronts;
  std::vector<int> rows;
  std::vector<float> lower, unknown, column;

  // springs by the first place of both
  struct Block {
    int later;
    double number[9];
  };
  std::vector<int> first_block;
  std::vector<Block> blocks;
  std::vector<double> diagonal;

  // neighbors of each particle
  std::vector<int> first_neighbor, neighbor;
  // Where a part is too large it is cut instead: springs between `group`s are left out.
  std::vector<int> side, group;
  int sides = 0, groups = 0;
  void find_neighbors(const std::vector<Element> &);
  void dissect(const double *x, int begin, int end);
  void add_front(int begin, int end);
  void find_blocks(const std::vector<char> &held, const std::vector<Element> &, double epsilon);
  void factorize_fronts();
};

}    // namespace deformable

#endif
