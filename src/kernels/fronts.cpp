// Columns of the Cholesky factor of a sparse matrix that have the same rows (kernels/spring_matrix.h): a lower triangle, and
// what stands below. Each column has `height` numbers; those above the diagonal are nothing, and in the place of that on it is one
// over it. Compiled for each level of SIMD instructions, see cmake/sources.cmake.

#include "kernels/batch_kernels.h"
#include "kernels/lanes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace deformable::DEFORMABLE_LEVEL {

extern const FrontKernels front_kernels;

// from - sum_k v_k[0] v_k, one after the other, of columns v_k that are `height` numbers apart.
template <int COLUMNS>
DEFORMABLE_LANE_FUNCTION void subtract(float *from, const float *v, std::size_t height, int size)
{
  float factor[COLUMNS];
  for (int k = 0; k < COLUMNS; ++k) factor[k] = v[k * height];
  int n = 0;
  for (; n + FLOATS <= size; n += FLOATS) {
    Floats left = load<Floats>(from + n);
#pragma GCC unroll 8
    for (int k = 0; k < COLUMNS; ++k) left = left - factor[k] * load<Floats>(v + k * height + n);
    store_floats(from + n, left);
  }
  for (; n < size; ++n)
    for (int k = 0; k < COLUMNS; ++k) from[n] -= factor[k] * v[k * height + n];
}

// The same sum on every level. Behind b are FRONT_MARGIN zeros.
DEFORMABLE_LANE_FUNCTION float product(const float *a, const float *b, int size)
{
  Floats parts[FRONT_MARGIN / FLOATS] = {};
  for (int n = 0; n < size; n += FRONT_MARGIN)
    for (int k = 0; k < FRONT_MARGIN / FLOATS; ++k)
      parts[k] += load<Floats>(a + n + k * FLOATS) * load<Floats>(b + n + k * FLOATS);
  float part[FRONT_MARGIN];
  for (int k = 0; k < FRONT_MARGIN / FLOATS; ++k) store_floats(part + k * FLOATS, parts[k]);
  return ((part[0] + part[4]) + (part[2] + part[6])) + ((part[1] + part[5]) + (part[3] + part[7]));
}

// A few columns are subtracted from all later ones at once, which are then read and written less often.
static void factorize_front(float *lower, int width, int height, float *left)
{
  constexpr int PANEL = 4;
  const std::size_t all = height, below = height - width;
  for (int begin = 0; begin < width; begin += PANEL) {
    const int end = std::min(begin + PANEL, width);
    const float *const panel = lower + begin * all;
    for (int c = begin; c < end; ++c) {
      float *const column = lower + c * all;
      const float inverse = 1.0F / std::sqrt(column[c]);
      for (int r = c + 1; r < height; ++r) column[r] *= inverse;
      column[c] = inverse;
      for (int s = c + 1; s < end; ++s)
        subtract<1>(lower + s * all + s, column + s, all, height - s);
    }
    for (int s = end; s < height; ++s) {
      float *const from = s < width ? lower + s * all + s : left + (s - width) * (below + 1);
      if (end - begin == PANEL)
        subtract<PANEL>(from, panel + s, all, height - s);
      else
        for (int k = 0; k < end - begin; ++k)
          subtract<1>(from, panel + k * all + s, all, height - s);
    }
  }
}

static void forward(const float *column, int width, int height, float *y)
{
  for (int c = 0; c < width; ++c, column += height) {
    const float here = y[c] *= column[c];
    for (int r = c + 1; r < height; r += FLOATS)    // and some of the margin
      store_floats(y + r, load<Floats>(y + r) - here * load<Floats>(column + r));
  }
}

static void backward(const float *column, int width, int height, float *y)
{
  column += static_cast<std::size_t>(width) * height;
  std::fill_n(y + height, FRONT_MARGIN, 0.0F);
  for (int c = width - 1; c >= 0; --c) {
    column -= height;
    y[c] = (y[c] - product(column + c + 1, y + c + 1, height - c - 1)) * column[c];
  }
}

const FrontKernels front_kernels = {factorize_front, forward, backward};

}    // namespace deformable::DEFORMABLE_LEVEL
