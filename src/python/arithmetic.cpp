// What numpy and its library of linear algebra compute by kernels for each processor, whose last digits differ. These are
// the same everywhere.

#include "python/laws.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>

using namespace deformable;

namespace {

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

using Values = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Vectors = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

double dot_of(Values a, Values b)
{
  if (a.size() != b.size())
    refuse("a and b must have as many numbers, not " + std::to_string(a.size()) + " and " +
           std::to_string(b.size()));
  return dot(a.data(), b.data(), a.size());
}

using Changing = nb::ndarray<double, nb::c_contig, nb::device::cpu>;

void axpy(Changing y, double a, Values x)
{
  if (y.size() != x.size())
    refuse("y and x must have as many numbers, not " + std::to_string(y.size()) + " and " +
           std::to_string(x.size()));
  double *const to = y.data();
  const double *const from = x.data();
  for (std::size_t k = 0; k < x.size(); ++k) to[k] += a * from[k];
}

// From long double: in double the C library has a version with fused multiply-adds, and one without.
Matrix unit_vectors(nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu> angle)
{
  std::vector<double> found;
  for (std::size_t k = 0; k < angle.size(); ++k) {
    const long double of = angle.data()[k];
    found.insert(found.end(),
                 {static_cast<double>(std::cos(of)), static_cast<double>(std::sin(of))});
  }
  return to_numpy<Matrix>(found.data(), {angle.size(), 2});
}

Vector angles(Vectors vector)
{
  std::vector<double> found;
  for (std::size_t k = 0; k < vector.shape(0); ++k) {
    const long double x = vector.data()[2 * k], y = vector.data()[2 * k + 1];
    found.push_back(static_cast<double>(std::atan2(y, x)));
  }
  return to_numpy(found);
}

// A number as Python's repr writes it: the fewest digits that read back exactly.
void append(std::string &text, double value, bool whole)
{
  if (!std::isfinite(value)) {
    text += std::isnan(value) ? "nan" : value < 0.0 ? "-inf" : "inf";
    return;
  }
  char digits[32];
  const double size = std::abs(value);
  const bool fixed = size == 0.0 || (size >= 1e-4 && size < 1e16);
  const auto end =
      whole ? std::to_chars(digits, digits + sizeof digits, static_cast<long long>(value)).ptr
            : std::to_chars(digits, digits + sizeof digits, value,
                            fixed ? std::chars_format::fixed : std::chars_format::scientific)
                  .ptr;
  text.append(digits, end);
  if (!whole && fixed && std::find(digits, end, '.') == end) text += ".0";
}

std::string rows_of(Values values, const std::vector<bool> &whole)
{
  std::string text;
  const std::size_t columns = whole.size();
  if (columns == 0 || values.size() % columns != 0)
    refuse("values must be rows of " + std::to_string(columns) + " numbers, not " +
           std::to_string(values.size()) + " numbers");
  for (std::size_t k = 0; k < values.size(); ++k) {
    append(text, values.data()[k], whole[k % columns]);
    text += (k + 1) % columns == 0 ? '\n' : ' ';
  }
  return text;
}

}    // namespace

void deformable::bind_arithmetic(nb::module_ &m)
{
  m.def("dot", &dot_of, "a"_a, "b"_a, R"(sum_k a_k b_k, the same to the last bit on every processor.

Parameters
----------
a, b : arrays of the same size
    Of any shape, taken in the order of their memory.

Raises
------
ValueError
    Arrays of different sizes.)");
  m.def("axpy", &axpy, "y"_a, "a"_a, "x"_a, R"(y += a x in place, without the memory of a product.

Parameters
----------
y, x : arrays of the same size
    Of any shape, taken in the order of their memory.
a : float

Raises
------
ValueError
    Arrays of different sizes.)");
  m.def(
      "norm", [](Values a) { return std::sqrt(dot(a.data(), a.data(), a.size())); }, "a"_a,
      "sqrt(sum_k a_k^2), the same to the last bit on every processor.");
  m.def(
      "unit_vectors", &unit_vectors, "angle"_a,
      R"((cos, sin) of angles [rad], shape (n, 2), the same to the last bit on every processor.)");
  m.def(
      "rows_of", &rows_of, "values"_a, "whole"_a,
      R"(Text of rows of numbers, as Python's repr writes each: the fewest digits that read back exactly.

Args:
    values: shape (n, m).
    whole: which columns have integers, m of them, below 2^53.)");
  m.def(
      "angles", &angles, "vector"_a,
      R"(Angles of vectors, shape (n, 2), from -pi to pi, the same to the last bit on every processor.)");
}
