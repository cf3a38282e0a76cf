// Stiffnesses and tensions of the species that fix adapt changes in a run.

#ifndef DEFORMABLE_SPECIES_RAMPS_H
#define DEFORMABLE_SPECIES_RAMPS_H

#include "styles/species.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

// Fix adapt writes to an array over pairs of types, and only there: pair styles below a hybrid one are not told. A
// species has the value of its type with itself.
class SpeciesRamps {
 public:
  // The array of a parameter by its name, filled with the present values; null for any other name.
  double **array_of(const char *name, const std::vector<Species> &);

  // The present values, where something else has changed them.
  void fill(const std::vector<Species> &);

  // A pair of different types with a value of its own, such as "kA of types 1 and 2", before the species take the values.
  // Empty if there is none.
  std::string of_two_types(const std::vector<Species> &) const;

  // Gives the species the values of the arrays. Returns the first type with a new value, or 0.
  int take(std::vector<Species> &) const;

 private:
  struct Array {
    std::vector<double> values;
    std::vector<double *> rows;    // by type
  };
  std::array<Array, deformable::MEMBERS> arrays;    // empty until someone asks for them
};

}    // namespace LAMMPS_NS

#endif
