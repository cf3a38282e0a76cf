// The words of fix deformable/friction:
//   mu kt gt [damp gn] [restitution e] [film c n] [types I J mu kt gt gn [restitution e] [film c n]] ...

#ifndef DEFORMABLE_FRICTION_COEFFICIENTS_H
#define DEFORMABLE_FRICTION_COEFFICIENTS_H

#include "laws/friction.h"

#include "styles/lammps_names.h"

#include <array>
#include <string>
#include <vector>

namespace deformable {

// The coefficients of fix deformable/friction, by the types of both sides: for all contacts, then for contacts of some types.
// Each is a number or an equal-style variable, whose value may change from step to step.
class FrictionCoefficients : protected Pointers {
 public:
  // mu kt gt keyword value ..., from arg[3] on
  FrictionCoefficients(LAMMPS *, int narg, char **arg);

  static constexpr int WALL = 0;    // in place of a type
  const Friction &between(int a, int b) const { return table[a * types + b]; }

  bool vary() const { return varying; }
  bool have_films() const;          // of any types
  bool have_restitution() const;    // of any types, below 1
  void find_variables();            // before a run, as others may have been defined since
  void evaluate();                  // as of this step

  // The largest time step for particles of this mass (force time^2/distance units), and lever = 1 + m R^2/I.
  double largest_time_step(double mass, double lever) const;

 private:
  struct Coefficient {
    double value = 0.0;
    std::string variable;    // its name; empty: a number
    int index = -1;          // of the variable
  };
  enum { MU, KT, GT, GN, FILM, POWER, RESTITUTION, COEFFICIENTS };
  struct Rule {
    int first[2], last[2];    // types
    std::array<Coefficient, COEFFICIENTS> of_friction = {};
    bool film_shears = true, film_squeezes = true;
  };
  const std::string id;
  const int types;            // and the wall
  std::vector<Rule> rules;    // the last one counts
  bool varying = false;
  std::vector<Friction> table;
  Coefficient read(char *word, double until_known = 0.0) const;    // of a variable
  void read_types(char **arg);
  int read_keywords(int iarg, int narg, char **arg);
  void apply(const Rule &);
};

}    // namespace deformable

#endif
