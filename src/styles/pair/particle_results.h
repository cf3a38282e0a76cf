// Per-particle results of the pair styles, for fix pair.

#ifndef DEFORMABLE_PARTICLE_RESULTS_H
#define DEFORMABLE_PARTICLE_RESULTS_H

#include "laws/shape.h"

#include <array>
#include <cstddef>
#include <vector>

namespace LAMMPS_NS {

class ParticleResults {
 public:
  explicit ParticleResults(int dimension) : dimension(dimension) {}

  bool requested = false;    // by extract

  // Values of all particles, null before the next call of resize; null for an unknown name.
  double *extract(const char *name);

  void resize(std::size_t particles);
  void clear(std::size_t particles);

  // Particle i, whose ring has this radius when undeformed.
  void store_shape(int i, double radius, int contacts, const deformable::Shape &, double pressure);
  void store_circle(int i, double radius, double pressure);
  // Droplet i in three dimensions: of its surface and of its facets.
  struct Surface {
    double area;
    int contacts;
    double pressure, contact_area, load;
  };
  void store_surface(int i, const Surface &);

  double bytes() const;

 private:
  enum { AREA, PERIMETER, CONTACTS, PRESSURE, ARC_RADIUS, CONTACT_LENGTH, SIZE };
  static constexpr const char *NAMES[] = {"area",     "perimeter",  "contacts",
                                          "pressure", "arc_radius", "contact_length"};
  // in the places of those of the plane
  enum { CONTACT_AREA = PERIMETER, LOAD = ARC_RADIUS };
  static constexpr int SIZE_OF_SURFACE = 5;
  static constexpr const char *NAMES_OF_SURFACE[] = {"area", "contact_area", "contacts", "pressure",
                                                     "load"};
  const int dimension;
  std::array<std::vector<double>, SIZE> values;
};

}    // namespace LAMMPS_NS

#endif
