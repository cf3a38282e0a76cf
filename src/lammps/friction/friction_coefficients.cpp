#include "friction_coefficients.h"

#include "lammps_release.h"

#include "atom.h"
#include "error.h"

#include <algorithm>
#include <limits>

using namespace LAMMPS_NS;
using deformable::Friction;

FrictionCoefficients::FrictionCoefficients(LAMMPS *lmp, int narg, char **arg)
    : Pointers(lmp),
      id(arg[0]),
      types(atom->ntypes + 1)
{
  if (narg < 6) utils::missing_cmd_args(FLERR, "fix deformable/friction", error);
  Friction all = {number(arg[3]), number(arg[4]), number(arg[5]), 0.0};
  int iarg = 6;
  if (iarg < narg && std::string(arg[iarg]) == "damp") {
    if (iarg + 1 == narg) utils::missing_cmd_args(FLERR, "fix deformable/friction damp", error);
    all.gn = number(arg[iarg + 1]);
    iarg += 2;
  }
  require(all);
  table.assign(types * types, all);
  for (; iarg < narg; iarg += 7) {
    if (std::string(arg[iarg]) != "types")
      error->all(FLERR_WORD(iarg),
                 "Fix {} deformable/friction: unknown word '{}': after mu, kt and gt come 'damp' "
                 "and its value, then any number of 'types'",
                 id, arg[iarg]);
    if (iarg + 6 >= narg) utils::missing_cmd_args(FLERR, "fix deformable/friction types", error);
    read_types(arg + iarg + 1);
  }
}

/* ----------------------------------------------------------------------
   I J mu kt gt gn: types or ranges of them; J may be the word wall.
------------------------------------------------------------------------- */

void FrictionCoefficients::read_types(char **arg)
{
  const Friction c = {number(arg[2]), number(arg[3]), number(arg[4]), number(arg[5])};
  require(c);
  int first[2], last[2];
  for (int n = 0; n < 2; ++n) {
    first[n] = last[n] = WALL;
    if (n == 0 || std::string(arg[n]) != "wall")
      utils::bounds(FLERR, arg[n], 1, types - 1, first[n], last[n], error);
  }
  for (int a = first[0]; a <= last[0]; ++a)
    for (int b = first[1]; b <= last[1]; ++b) table[a * types + b] = table[b * types + a] = c;
}

/* ---------------------------------------------------------------------- */

double FrictionCoefficients::number(char *word) const
{
  if (std::string(word) == "inf") return std::numeric_limits<double>::infinity();
  return utils::numeric(FLERR, word, false, lmp);
}

void FrictionCoefficients::require(const Friction &c) const
{
  const std::string problem = deformable::invalid_friction(c);
  if (!problem.empty()) error->all(FLERR, "Fix {} deformable/friction: {}", id, problem);
}

double FrictionCoefficients::largest_time_step(double mass, double lever) const
{
  double least = std::numeric_limits<double>::infinity();
  for (const Friction &c : table)
    least = std::min(least, deformable::largest_time_step(c, mass, lever));
  return least;
}
