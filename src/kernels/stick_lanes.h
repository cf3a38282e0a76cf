// What films that stick do to rings, several side by side: the formulas of contact_film.h in vectors.

#ifndef DEFORMABLE_STICK_LANES_H
#define DEFORMABLE_STICK_LANES_H

#include "kernels/force_kernels.h"
#include "kernels/lanes.h"
#include "laws/contact_film.h"

namespace deformable::DEFORMABLE_LEVEL {

// Those of the rings and contacts that these arrays have moved to.
DEFORMABLE_LANE_FUNCTION StickArrays films_of(const RingBatches &b, const ContactArrays &c,
                                              const RingArrays &r)
{
  StickArrays films = b.films;
  films.tension += r.radius - b.rings.radius;
  for (double *&term : films.terms) term += c.seat - b.contacts.seat;
  return films;
}

// The load of rings whose contacts stick, and their products.
DEFORMABLE_LANE_FUNCTION void stick_contacts(int n, const StickArrays &films, Lanes tension,
                                             const Lanes *force, Lanes *product, Lanes &work,
                                             Lanes &total)
{
  Lanes perimeter = Lanes{}, linear = Lanes{}, square = Lanes{};
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    perimeter += load<Lanes>(films.terms[0] + m * LANES);
    linear += force[m] * load<Lanes>(films.terms[1] + m * LANES);
    square += load<Lanes>(films.terms[2] + m * LANES);
  }
  const CurvedLoad<Lanes> loaded = film_load(work, total, tension, perimeter, linear, square);
  work = loaded.work;
  total = loaded.total;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m)
    product[m] += loaded.shift + tension * load<Lanes>(films.terms[3] + m * LANES);
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
