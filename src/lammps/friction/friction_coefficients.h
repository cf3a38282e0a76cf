// The coefficients of fix deformable/friction, by the types of both sides: of all contacts, then of those of some types.

#ifndef LMP_FRICTION_COEFFICIENTS_H
#define LMP_FRICTION_COEFFICIENTS_H

#include "pointers.h"

#include "friction.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class FrictionCoefficients : protected Pointers {
 public:
  // mu kt gt keyword value ..., from arg[3] on
  FrictionCoefficients(class LAMMPS *, int narg, char **arg);

  static constexpr int WALL = 0;    // in place of a type
  const deformable::Friction &between(int a, int b) const { return table[a * types + b]; }

  // The largest time step for particles of this mass, and lever = 1 + m R^2/I.
  double largest_time_step(double mass, double lever) const;

 private:
  const std::string id;
  const int types;    // and the wall
  std::vector<deformable::Friction> table;
  double number(char *word) const;
  void require(const deformable::Friction &) const;
  void read_types(char **arg);
};

}    // namespace LAMMPS_NS

#endif
