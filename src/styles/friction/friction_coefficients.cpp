#include "styles/friction/friction_coefficients.h"

#include "styles/lammps_release.h"

#include "atom.h"
#include "error.h"
#include "input.h"
#include "modify.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <limits>

namespace deformable {

FrictionCoefficients::FrictionCoefficients(LAMMPS *lmp, int narg, char **arg)
    : Pointers(lmp),
      id(arg[0]),
      types(atom->ntypes + 1),
      table(types * types)
{
  if (narg < 6) utils::missing_cmd_args(FLERR, "fix deformable/friction", error);
  Rule all = {{WALL, WALL}, {types - 1, types - 1}};
  for (int n = MU; n <= GT; ++n) all.of_friction[n] = read(arg[3 + n]);
  int iarg = 6;
  if (iarg < narg && std::string(arg[iarg]) == "damp") {
    if (iarg + 1 == narg) utils::missing_cmd_args(FLERR, "fix deformable/friction damp", error);
    all.of_friction[GN] = read(arg[iarg + 1]);
    iarg += 2;
  }
  rules.push_back(all);
  iarg = read_keywords(iarg, narg, arg);
  while (iarg < narg) {
    if (std::string(arg[iarg]) != "types")
      error->all(FLERR_WORD(iarg),
                 "Fix {} deformable/friction: unknown word '{}': after mu, kt and gt come 'damp' "
                 "or 'restitution' and its value, 'film' and its two, then any number of 'types'",
                 id, arg[iarg]);
    if (iarg + 6 >= narg) utils::missing_cmd_args(FLERR, "fix deformable/friction types", error);
    read_types(arg + iarg + 1);
    iarg = read_keywords(iarg + 7, narg, arg);
  }
  for (const Rule &rule : rules) {
    for (const Coefficient &c : rule.of_friction) varying |= !c.variable.empty();
    apply(rule);
  }
}

/* ----------------------------------------------------------------------
   I J mu kt gt gn: types or ranges of them; J may be the word wall.
------------------------------------------------------------------------- */

void FrictionCoefficients::read_types(char **arg)
{
  Rule rule = {{WALL, WALL}, {WALL, WALL}};
  for (int n = 0; n < 2; ++n)
    if (n == 0 || std::string(arg[n]) != "wall")
      utils::bounds(FLERR, arg[n], 1, types - 1, rule.first[n], rule.last[n], error);
  for (int n = MU; n <= GN; ++n) rule.of_friction[n] = read(arg[2 + n]);
  rules.push_back(rule);
}

// [restitution e] [film c n [tangential or normal]] of the last rule. Returns the place of the next word. The restitution and the
// power n are 1 where they are not given, and as long as a variable is not known.
int FrictionCoefficients::read_keywords(int iarg, int narg, char **arg)
{
  Rule &rule = rules.back();
  rule.of_friction[RESTITUTION].value = rule.of_friction[POWER].value = 1.0;
  if (iarg < narg && std::string(arg[iarg]) == "restitution") {
    if (iarg + 1 == narg)
      utils::missing_cmd_args(FLERR, "fix deformable/friction restitution", error);
    rule.of_friction[RESTITUTION] = read(arg[iarg + 1], 1.0);
    iarg += 2;
  }
  if (iarg >= narg || std::string(arg[iarg]) != "film") return iarg;
  if (iarg + 2 >= narg) utils::missing_cmd_args(FLERR, "fix deformable/friction film", error);
  rule.of_friction[FILM] = read(arg[iarg + 1]);
  rule.of_friction[POWER] = read(arg[iarg + 2], 1.0);
  const std::string only = iarg + 3 < narg ? arg[iarg + 3] : "";
  rule.film_squeezes = only != "tangential";
  rule.film_shears = only != "normal";
  return iarg + (rule.film_squeezes && rule.film_shears ? 3 : 4);
}

bool FrictionCoefficients::have_films() const
{
  return std::any_of(rules.begin(), rules.end(), [](const Rule &rule) {
    return rule.of_friction[FILM].value > 0.0 || !rule.of_friction[FILM].variable.empty();
  });
}

bool FrictionCoefficients::have_restitution() const
{
  return std::any_of(rules.begin(), rules.end(), [](const Rule &rule) {
    const Coefficient &e = rule.of_friction[RESTITUTION];
    return e.value < 1.0 || !e.variable.empty();
  });
}

FrictionCoefficients::Coefficient FrictionCoefficients::read(char *word, double until_known) const
{
  if (utils::strmatch(word, "^v_.")) return {until_known, word + 2};
  if (std::string(word) == "inf") return {std::numeric_limits<double>::infinity(), ""};
  return {utils::numeric(FLERR, word, false, lmp), ""};
}

void FrictionCoefficients::find_variables()
{
  for (Rule &rule : rules)
    for (Coefficient &c : rule.of_friction) {
      if (c.variable.empty()) continue;
      c.index = input->variable->find(c.variable.c_str());
      if (c.index < 0 || !input->variable->equalstyle(c.index))
        error->all(FLERR,
                   "Fix {} deformable/friction: v_{} needs an equal-style variable: use "
                   "'variable {} equal ...'",
                   id, c.variable, c.variable);
    }
}

void FrictionCoefficients::evaluate()
{
  modify->clearstep_compute();
  for (Rule &rule : rules) {
    for (Coefficient &c : rule.of_friction)
      if (c.index >= 0) c.value = input->variable->compute_equal(c.index);
    apply(rule);
  }
  modify->addstep_compute(update->ntimestep + 1);
}

void FrictionCoefficients::apply(const Rule &rule)
{
  const auto &[mu, kt, gt, gn, film, power, restitution] = rule.of_friction;
  Friction c = {mu.value,    kt.value,         gt.value,           gn.value,         film.value,
                power.value, rule.film_shears, rule.film_squeezes, restitution.value};
  const std::string problem = deformable::invalid_friction(c);
  if (!problem.empty()) error->all(FLERR, "Fix {} deformable/friction: {}", id, problem);
  c.ratio = deformable::damping_ratio(c.restitution);
  for (int a = rule.first[0]; a <= rule.last[0]; ++a)
    for (int b = rule.first[1]; b <= rule.last[1]; ++b)
      table[a * types + b] = table[b * types + a] = c;
}

double FrictionCoefficients::largest_time_step(double mass, double lever) const
{
  double least = std::numeric_limits<double>::infinity();
  for (const Friction &c : table)
    least = std::min(least, deformable::largest_time_step(c, mass, lever));
  return least;
}

}    // namespace deformable
