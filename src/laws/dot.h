// Sums whose last digit is the same everywhere.

#ifndef DEFORMABLE_DOT_H
#define DEFORMABLE_DOT_H

#include <cstddef>

namespace deformable {

// sum_k a_k b_k, in eight parts: every processor adds them in the same order. Libraries of linear algebra have kernels for
// each processor, whose last digits differ, and a minimizer of disks makes another packing of that.
inline double dot(const double *a, const double *b, std::size_t size)
{
  constexpr std::size_t PARTS = 8;
  double part[PARTS] = {};
  std::size_t k = 0;
  for (; k + PARTS <= size; k += PARTS)
    for (std::size_t p = 0; p < PARTS; ++p) part[p] += a[k + p] * b[k + p];
  for (std::size_t p = 0; k < size; ++k, ++p) part[p] += a[k] * b[k];
  return ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
}

}    // namespace deformable

#endif
