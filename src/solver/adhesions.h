// Adhesion of all pairs of atom types: the energy that two particles gain for each unit of length of their film.

#ifndef DEFORMABLE_ADHESIONS_H
#define DEFORMABLE_ADHESIONS_H

#include "styles/species.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

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

}    // namespace LAMMPS_NS

#endif
