// Per-particle results of the pair styles, for fix pair.

#ifndef DEFORMABLE_PARTICLE_RESULTS_H
#define DEFORMABLE_PARTICLE_RESULTS_H

#include "shape.h"

#include <array>
#include <cstddef>
#include <vector>

namespace LAMMPS_NS {

class ParticleResults {
 public:
  bool requested = false;    // by extract

  // Values of all particles, null before the next call of resize; null for an unknown name.
  double *extract(const char *name);

  void resize(std::size_t particles);
  void clear(std::size_t particles);

  // Particle i, whose ring has this radius when undeformed.
  void store_shape(int i, double radius, int contacts, const deformable::Shape &, double pressure);
  void store_circle(int i, double radius, double pressure);

  double bytes() const;

 private:
  enum { AREA, PERIMETER, CONTACTS, PRESSURE, ARC_RADIUS, CONTACT_LENGTH, SIZE };
  static constexpr const char *NAMES[] = {"area",     "perimeter",  "contacts",
                                          "pressure", "arc_radius", "contact_length"};
  std::array<std::vector<double>, SIZE> values;
};

}    // namespace LAMMPS_NS

#endif
