// What another program, such as the Python package, asks of a pair style to know whether it still is the one that it
// defined, and what else acts on its contacts. LAMMPS' library passes it on (extract_pair).

#include "pair_deformable.h"

#include "fix_deformable_wall.h"

#include "modify.h"
#include "neighbor.h"

#include <cstring>

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
  if (!strcmp(name, "exclusions")) {
    asked.exclusions = neighbor->exclude;
    return &asked.exclusions;
  }
  return nullptr;
}
