// The species of a parameter file: one line each, `name radius kA kP [skin] [keyword value ...]` with the keyword skin and
// those of PARAMETERS (laws/stiffness.h). And lines `adhesion name name value` for pairs of them, in any place.

#ifndef DEFORMABLE_SPECIES_H
#define DEFORMABLE_SPECIES_H

#include "laws/stiffness.h"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace LAMMPS_NS {

class LAMMPS;

struct Species {
  std::string name;
  double radius;
  deformable::Stiffness stiffness;
  double skin;    // thickness of the rigid shell around the ring
};

// All numbers of a species with their names, in the order of a line of the file.
std::vector<std::pair<std::string, double>> numbers_of(const Species &);

struct Adhesion {
  std::string first, second;    // names of species
  double energy;                // for each unit of length of a film
  int line;                     // of the file

  bool is_of(const std::string &a, const std::string &b) const
  {
    return (first == a && second == b) || (first == b && second == a);
  }
};

struct SpeciesFile {
  std::vector<Species> species;
  std::vector<Adhesion> adhesions;    // a pair once at most
};

// Reads the file on rank 0 and sends it to all ranks. Stops with LAMMPS' error on all of them if the file is missing
// or invalid.
SpeciesFile read_species(LAMMPS *lmp, const std::string &file);

// The problem of a species, or of the adhesion of two, in a phrase that names its value, empty if there is none.
std::string invalid_values(const Species &);
std::string invalid_adhesion(double adhesion, const Species &, const Species &);

// A text for error messages: shortened, with printable characters only.
std::string shown(const std::string &text);

// Stiffnesses and tensions of the species that fix adapt changes in a run. It writes to an array over pairs of types, and only
// there: pair styles below a hybrid one are not told. A species has the value of its type with itself.
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
