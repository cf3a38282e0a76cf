// Arguments from Python, checked, and results for it.

#ifndef DEFORMABLE_ARGUMENTS_H
#define DEFORMABLE_ARGUMENTS_H

#include "geometry/polygon.h"
#include "laws/shape.h"
#include "laws/stiffness.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <vector>

namespace deformable {

namespace nb = nanobind;
using namespace nb::literals;

using Vector = nb::ndarray<nb::numpy, double, nb::ndim<1>>;
using Integers = nb::ndarray<nb::numpy, int, nb::ndim<1>>;
using Points = nb::ndarray<nb::numpy, double, nb::shape<-1, 2>>;
using Matrix = nb::ndarray<nb::numpy, double, nb::ndim<2>>;
using Arcs = nb::ndarray<nb::numpy, double, nb::shape<-1, 5>>;

// A copy of these numbers, which Python owns.
template <class Array>
Array to_numpy(const typename Array::Scalar *begin, std::initializer_list<std::size_t> shape)
{
  using Number = typename Array::Scalar;
  std::size_t count = 1;
  for (std::size_t n : shape) count *= n;
  auto *data = new Number[count];
  std::copy(begin, begin + count, data);
  nb::capsule owner(data, [](void *p) noexcept { delete[] static_cast<Number *>(p); });
  return Array(data, shape, owner);
}
inline Vector to_numpy(const std::vector<double> &numbers)
{
  return to_numpy<Vector>(numbers.data(), {numbers.size()});
}
inline Integers to_numpy(const std::vector<int> &numbers)
{
  return to_numpy<Integers>(numbers.data(), {numbers.size()});
}

// value(c) of each of so many contacts.
template <class Value> Vector per_contact(std::size_t contacts, Value &&value)
{
  std::vector<double> values;
  for (std::size_t c = 0; c < contacts; ++c) values.push_back(value(c));
  return to_numpy(values);
}

[[noreturn]] void refuse(const std::string &message);

// An array of numbers without gaps in memory, from anything that numpy converts to one.
nb::object contiguous(nb::handle given);

// A vector of finite numbers; flat_vector_of: of any shape, row by row.
std::vector<double> vector_of(const std::string &name, nb::handle given);
std::vector<double> flat_vector_of(const std::string &name, nb::handle given);

// Angles at which an outline meets its contacts, 0 if not given.
std::vector<double> contact_angles_of(nb::handle given, std::size_t contacts);

// The stiffness of a call: kA and kP, then the other parameters of stiffness.h in their order or by name.
Stiffness stiffness_of(double kA, double kP, const nb::args &more, const nb::kwargs &named);

// None if there is no problem.
nb::object or_none(const std::string &problem);

// The polygon nx x + ny y <= offset.
std::vector<Edge> polygon_of(nb::handle nx, nb::handle ny, nb::handle offset);

void require_positive(const std::string &name, double value);

// The contacts of a call, checked, and their memory.
struct Call {
  double radius;
  std::vector<Contact> contacts;
  std::vector<int> order;
  Contacts view() const { return {static_cast<int>(contacts.size()), contacts.data()}; }
};

Call checked(double radius, nb::handle angles, nb::handle indentations);

// Tables of particles and of the sides of their contacts.

using Table = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// A table of rows of so many numbers.
Table table_of(const std::string &name, nb::handle given, std::size_t columns);

// use(particle, its row, first and end of the rows of its sides), for each particle. The first column of particles is the
// number of sides.
template <class Use> void for_particles(const Table &particles, const Table &sides, Use &&use)
{
  std::size_t next = 0;
  for (std::size_t i = 0; i < particles.shape(0); ++i) {
    const double *const of = particles.data() + particles.shape(1) * i;
    if (!(of[0] >= 0.0 && of[0] <= static_cast<double>(sides.shape(0) - next)))
      refuse("sides has fewer rows than the particles need, or particle " + std::to_string(i) +
             " a number of them that is none");
    const std::size_t end = next + static_cast<std::size_t>(of[0]);
    use(i, of, next, end);
    next = end;
  }
  if (next != sides.shape(0)) refuse("sides has more rows than the particles need");
}

}    // namespace deformable

#endif
