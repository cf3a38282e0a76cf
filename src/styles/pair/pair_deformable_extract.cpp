// What another program, such as the Python package, asks of a pair style to know whether it still is the one that it
// defined, and what else acts on its contacts. LAMMPS' library passes it on (extract_pair). And what a restart file tells.

#include "styles/pair/pair_deformable.h"

#include "styles/friction/fix_deformable_friction.h"
#include "styles/walls/fix_deformable_wall.h"

#include "fix.h"
#include "modify.h"
#include "neighbor.h"

#include <cstring>
#include <string>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

void PairDeformable::number_definition()
{
  static double last = 0.0;
  asked.definition = ++last;
}

/* ---------------------------------------------------------------------- */

void *PairDeformable::extract(const char *name, int &dim)
{
  dim = 0;
  if (!strcmp(name, "definition")) return &asked.definition;
  if (!strcmp(name, "walls")) {
    asked.walls = static_cast<double>(modify->get_fix_by_style(FixDeformableWall::STYLE).size());
    return &asked.walls;
  }
  if (!strcmp(name, "friction")) {
    asked.friction =
        static_cast<double>(modify->get_fix_by_style(FixDeformableFriction::STYLE).size());
    return &asked.friction;
  }
  if (!strcmp(name, "exclusions")) {
    asked.exclusions = neighbor->exclude;
    return &asked.exclusions;
  }
  // the number of the first fix whose forces minimizers pass over, or 0; those of the package know better
  if (!strcmp(name, "forces of motion")) {
    asked.forces_of_motion = 0.0;
    for (int n = modify->nfix - 1; n >= 0; --n) {
      const int mask = modify->fmask[n];
      const bool passed = (mask & FixConst::POST_FORCE && !(mask & FixConst::MIN_POST_FORCE)) ||
                          (mask & FixConst::PRE_REVERSE && !(mask & FixConst::MIN_PRE_REVERSE));
      if (passed && !utils::strmatch(modify->fix[n]->id, "^deformable_"))
        asked.forces_of_motion = n + 1.0;
    }
    return &asked.forces_of_motion;
  }
  // what the species file says, by atom type: "species radius"
  if (!utils::strmatch(name, "^species ")) return nullptr;
  asked.by_type.clear();
  for (const Species &s : species)
    for (const auto &[of_species, value] : numbers_of(s))
      if (name == "species " + of_species) asked.by_type.push_back(value);
  if (asked.by_type.empty()) return nullptr;
  dim = 1;
  return asked.by_type.data();
}

void *PairDeformable::extract_peratom(const char *name, int &ncol)
{
  ncol = 0;
  return results.extract(name);
}

/* ----------------------------------------------------------------------
   Values of pair_coeff, which fix adapt may change later.
------------------------------------------------------------------------- */

void PairDeformable::describe_species()
{
  defined.clear();
  for (std::size_t type = 1; type < species.size(); ++type) {
    const Species &s = species[type];
    if (s.name.empty()) continue;
    std::string text = s.name;
    for (const auto &[name, value] : numbers_of(s)) text += fmt::format(" {} {}", name, value);
    defined[fmt::format("type {}", type)] = text;
    for (std::size_t other = type; other < species.size(); ++other)
      if (const double w = adhesions.between(static_cast<int>(type), static_cast<int>(other)))
        defined[fmt::format("adhesion of types {} and {}", type, other)] = fmt::format("{}", w);
  }
}

std::map<std::string, std::string> PairDeformable::description() const
{
  std::map<std::string, std::string> all = defined;
  const std::string of_atoms = radius_by_atom ? " radius atom" : "";
  for (std::size_t type = 1; type < species.size(); ++type)
    if (!species[type].name.empty()) all[fmt::format("law of type {}", type)] = law() + of_atoms;
  return all;
}
