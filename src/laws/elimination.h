// Small systems of linear equations.

#ifndef DEFORMABLE_ELIMINATION_H
#define DEFORMABLE_ELIMINATION_H

#include <cmath>
#include <utility>
#include <vector>

namespace deformable {

// X of A X = B by elimination with pivots, rows of both one after the other; X replaces B. False: A is singular.
inline bool solve_by_elimination(std::vector<double> a, std::vector<double> &b, int n, int columns)
{
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int r = k + 1; r < n; ++r)
      if (std::fabs(a[r * n + k]) > std::fabs(a[pivot * n + k])) pivot = r;
    if (!(std::fabs(a[pivot * n + k]) > 0.0)) return false;
    for (int c = 0; c < n; ++c) std::swap(a[k * n + c], a[pivot * n + c]);
    for (int c = 0; c < columns; ++c) std::swap(b[k * columns + c], b[pivot * columns + c]);
    for (int r = 0; r < n; ++r) {
      if (r == k) continue;
      const double part = a[r * n + k] / a[k * n + k];
      if (part == 0.0) continue;
      for (int c = k; c < n; ++c) a[r * n + c] -= part * a[k * n + c];
      for (int c = 0; c < columns; ++c) b[r * columns + c] -= part * b[k * columns + c];
    }
  }
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < columns; ++c) b[k * columns + c] /= a[k * n + k];
  return true;
}

}    // namespace deformable

#endif
