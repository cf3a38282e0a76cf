#include "python/laws.h"

#include "kernels/spring_matrix.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

using namespace deformable;

namespace {

// Disk j, in three dimensions sphere j, lies at x_j + shift - x_i from i. They touch at the distance contact = R_i + R_j.
template <int dimension> struct DiskPair {
  int i, j;
  double shift[dimension], contact;
};

// Values of all pairs, and the gradient of the energy, (x, y) or (x, y, z) of one disk after another.
struct DiskEnergy {
  double energy = 0.0, virial = 0.0;
  std::vector<double> gradient;
};

// E = 1/2 sum_c o_c^2, o = max(R_i + R_j - d, 0), with d = scale |x_j + shift - x_i|: lengths are
// scale times those of x, the radii are not. The virial is sum_c o_c d_c, the gradient that by x:
// dE/dx_j = -scale^2 (o/d) (x_j + shift - x_i).
template <int dimension>
inline void disk_energy(const std::vector<DiskPair<dimension>> &pairs, const double *x,
                        std::size_t disks, double scale, DiskEnergy &result)
{
  result.energy = result.virial = 0.0;
  result.gradient.assign(dimension * disks, 0.0);
  double *gradient = result.gradient.data();
  const double squared = scale * scale;
  for (const DiskPair<dimension> &pair : pairs) {
    const double *xi = x + dimension * pair.i, *xj = x + dimension * pair.j;
    double step[dimension], square = 0.0;
    for (int k = 0; k < dimension; ++k) {
      step[k] = xj[k] - xi[k] + pair.shift[k];
      square += step[k] * step[k];
    }
    const double apart = squared * square;
    // disks at one place push each other in no direction
    if (!(apart < pair.contact * pair.contact)) continue;
    const double distance = std::sqrt(apart), overlap = pair.contact - distance;
    result.energy += 0.5 * overlap * overlap;
    result.virial += overlap * distance;
    const double force = distance > 0.0 ? squared * overlap / distance : 0.0;
    for (int k = 0; k < dimension; ++k) {
      gradient[dimension * pair.i + k] += force * step[k];
      gradient[dimension * pair.j + k] -= force * step[k];
    }
  }
}

using Numbers = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using Lengths = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <int dimension>
using Places = nb::ndarray<const double, nb::shape<-1, dimension>, nb::c_contig, nb::device::cpu>;

template <int dimension> struct SoftDisks {
  std::size_t disks;
  std::vector<DiskPair<dimension>> pairs;
  DiskEnergy result = {};
};

template <int dimension>
SoftDisks<dimension> soft_disks(std::size_t disks, Numbers i, Numbers j, Places<dimension> shift,
                                Lengths contact)
{
  const std::size_t count = i.size();
  if (j.size() != count || shift.shape(0) != count || contact.size() != count)
    refuse("i, j, shift and contact must have one value for each of " + std::to_string(count) +
           " pairs");
  SoftDisks<dimension> found = {disks, {}};
  for (std::size_t c = 0; c < count; ++c) {
    for (const std::int64_t k : {i.data()[c], j.data()[c]})
      if (k < 0 || static_cast<std::size_t>(k) >= disks)
        refuse("pair " + std::to_string(c) + " has the disk " + std::to_string(k) + " of " +
               std::to_string(disks));
    DiskPair<dimension> pair = {
        static_cast<int>(i.data()[c]), static_cast<int>(j.data()[c]), {}, contact.data()[c]};
    std::copy_n(shift.data() + dimension * c, dimension, pair.shift);
    found.pairs.push_back(pair);
  }
  return found;
}

template <int dimension>
nb::tuple evaluate(SoftDisks<dimension> &disks, Places<dimension> x, double scale)
{
  if (x.shape(0) != disks.disks)
    refuse("x has " + std::to_string(x.shape(0)) + " rows: it must have one for each of " +
           std::to_string(disks.disks) + " disks");
  disk_energy(disks.pairs, x.data(), disks.disks, scale, disks.result);
  return nb::make_tuple(disks.result.energy, disks.result.virial, to_numpy(disks.result.gradient));
}

template <int dimension> void bind(nb::module_ &m, const char *name, const char *about)
{
  nb::class_<SoftDisks<dimension>>(m, name, about)
      .def(nb::new_(&soft_disks<dimension>), "disks"_a, "i"_a, "j"_a, "shift"_a, "contact"_a)
      .def(
          "__call__", &evaluate<dimension>, "x"_a, "scale"_a,
          R"(Energy, virial and the gradient of the energy, shape (2 disks,), of spheres (3 disks,).

E = 1/2 sum_c o_c^2 with the overlaps o = max(R_i + R_j - d, 0) and d = scale |x_j + shift - x_i|, of unit
stiffness. The virial is sum_c o_c d_c.)");
}

// The springs of disks, or of spheres.
struct Springs {
  int dimension;
  SpringMatrix matrix;
};

// Directions are unit vectors; j < 0 stands for a wall.
Springs springs(Table x, Numbers i, Numbers j, Table direction, Lengths weight, double epsilon)
{
  const std::size_t dimension = x.shape(1);
  if ((dimension != 2 && dimension != 3) || direction.shape(1) != dimension)
    refuse("x and direction must both have two columns, or three");
  const std::size_t count = i.size(), disks = x.shape(0);
  if (j.size() != count || direction.shape(0) != count || weight.size() != count)
    refuse("i, j, direction and weight must have one value for each of " + std::to_string(count) +
           " springs");
  std::vector<SpringMatrix::Element> elements;
  for (std::size_t c = 0; c < count; ++c) {
    const std::int64_t first = i.data()[c], second = j.data()[c];
    const std::int64_t number = static_cast<std::int64_t>(disks);
    if (first < 0 || first >= number || second >= number)
      refuse("spring " + std::to_string(c) + " has the disks " + std::to_string(first) + " and " +
             std::to_string(second) + " of " + std::to_string(disks));
    if (first == second) continue;    // its own image moves with it
    const double *const n = direction.data() + dimension * c;
    elements.push_back({static_cast<int>(first),
                        static_cast<int>(std::max<std::int64_t>(second, -1)),
                        {n[0], n[1], dimension == 3 ? n[2] : 0.0},
                        weight.data()[c]});
  }
  std::vector<double> places(3 * disks, 0.0);
  for (std::size_t k = 0; k < disks; ++k)
    std::copy_n(x.data() + dimension * k, dimension, &places[3 * k]);
  Springs found = {static_cast<int>(dimension), {}};
  found.matrix.factorize(batch_kernels("")->fronts, found.dimension, static_cast<int>(disks),
                         places.data(), std::vector<char>(3 * disks, 0), elements, epsilon);
  return found;
}

Vector solve(Springs &springs, Lengths q)
{
  const std::size_t disks = springs.matrix.particles(), dimension = springs.dimension;
  if (q.size() != dimension * disks)
    refuse("q has " + std::to_string(q.size()) + " numbers: it must have " +
           std::to_string(dimension * disks));
  std::vector<int> index(disks);
  std::vector<double> of_three(3 * disks, 0.0), found(3 * disks), result(q.size());
  for (std::size_t k = 0; k < disks; ++k) {
    index[k] = static_cast<int>(k);
    std::copy_n(q.data() + dimension * k, dimension, &of_three[3 * k]);
  }
  springs.matrix.solve(index, of_three.data(), found.data());
  for (std::size_t k = 0; k < disks; ++k)
    std::copy_n(&found[3 * k], dimension, &result[dimension * k]);
  return to_numpy(result);
}

}    // namespace

void deformable::bind_disk_pairs(nb::module_ &m)
{
  bind<2>(m, "SoftDisks", R"(Pairs of soft disks that may touch.

Parameters
----------
disks : int
    Number of disks.
i, j : (M,) int64
    Their numbers in each pair.
shift : (M, 2)
    Disk j lies at x_j + shift - x_i from disk i [length].
contact : (M,)
    R_i + R_j [length].

Raises
------
ValueError
    Arrays of different lengths; numbers of disks that are not there.)");
  bind<3>(
      m, "SoftSpheres",
      "Pairs of soft spheres that may touch: `SoftDisks` in three dimensions, with shift (M, 3).");
  nb::class_<Springs>(m, "DiskSprings",
                      R"(Springs between disks, or spheres, as a matrix P, which is factorized.

P = sum over springs of w (n, -n) (n, -n)^T + epsilon <diagonal> 1, in single precision. In
space springs between parts of some 256 spheres count for the diagonal of P only.

Parameters
----------
x : (N, d)
    Centers, d = 2 or 3; they order the factor only [length].
i, j : (M,) int64
    Numbers of the disks of each spring; j < 0: a wall.
direction : (M, d)
    Unit vectors n.
weight : (M,)
    w.
epsilon : float
    In mean elements of the diagonal.

Raises
------
ValueError
    Arrays of different lengths; numbers of disks that are not there.)")
      .def(nb::new_(&springs), "x"_a, "i"_a, "j"_a, "direction"_a, "weight"_a, "epsilon"_a)
      .def("__call__", &solve, "q"_a, "P^-1 q, shape (d N,).");
}
