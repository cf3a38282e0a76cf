// The species of a parameter file: one line each, `name radius kA kP [skin] [keyword value ...]` with the keyword skin and
// those of PARAMETERS (laws/stiffness.h). And lines `adhesion name name value` for pairs of them, in any place.

#ifndef DEFORMABLE_SPECIES_H
#define DEFORMABLE_SPECIES_H

#include "laws/stiffness.h"
#include "styles/lammps_names.h"

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace deformable {

struct Species {
  std::string name;
  double radius;
  Stiffness stiffness;
  double skin;    // thickness of the rigid shell around the ring
};

// All numbers of a species with their names, in the order of a line of the file.
std::vector<std::pair<std::string, double>> numbers_of(const Species &);

struct Adhesion {
  std::string first, second;    // names of species
  double energy;                // for each unit of length of a film, or of its area in space
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

  // Gives the species the values of the arrays. Returns whether one has changed.
  bool take(std::vector<Species> &) const;

 private:
  struct Array {
    std::vector<double> values;
    std::vector<double *> rows;    // by type
  };
  std::array<Array, MEMBERS> arrays;    // empty until someone asks for them
};

// The stiffness of each particle.
struct Materials {
  const Species *species = nullptr;    // by atom type
  const int *type = nullptr;           // by local index
  // of single particles, in place of those of their species; or null
  const double *kA = nullptr, *tension = nullptr;
  // areas that kA = inf conserves give way beyond this times gamma/r + kP/2; 0: never
  double yield = 0.0;

  bool vary() const { return kA || tension; }    // from particle to particle and from call to call
  const Species &species_of(int i) const { return species[type[i]]; }

  // ring_radius: without the skin
  Stiffness stiffness_of(int i, double ring_radius) const
  {
    Stiffness k = species_of(i).stiffness;
    if (kA) k.kA = kA[i];
    if (tension) k.tension = tension[i];
    if (yield > 0.0 && std::isinf(k.kA))
      k.yield = yield * (k.rest_pressure(ring_radius) + 0.5 * k.kP);
    return k;
  }
};

// Adhesion of all pairs of atom types: the energy that two particles gain for each unit of length of their film, or of its area.
class Adhesions {
 public:
  // Those of a species file, for the species of each type. A type without a name belongs to another pair style.
  void assign(const std::vector<Species> &, const std::vector<Adhesion> &);

  double between(int itype, int jtype) const { return values[itype * types + jtype]; }
  bool any() const { return adhesive; }

  // The array that fix adapt writes to, at [i][j] with i <= j only; null as long as there are no types.
  double **array();

  // Takes the values of the array, which is symmetric again then. Returns whether one has changed.
  bool take();

  // The first pair of types whose species cannot have its adhesion, in a phrase. Empty if there is none.
  std::string problem(const std::vector<Species> &) const;

 private:
  std::size_t types = 0;         // and one more, since they begin with 1
  std::vector<double> values;    // symmetric
  bool adhesive = false;
  std::vector<double> written;    // the array; empty until someone asks for it
  std::vector<double *> rows;
  void set(std::size_t i, std::size_t j, double adhesion);
  void update();    // what follows from the values
};

}    // namespace deformable

#endif
