// Tables of particles and of the sides of their contacts.

#ifndef DEFORMABLE_TABLES_H
#define DEFORMABLE_TABLES_H

#include "python/arguments.h"

namespace deformable {

using Table = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

// A table of rows of so many numbers, from anything that numpy converts to one.
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
