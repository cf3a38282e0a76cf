#include "styles/motion/fix_deformable_propel.h"

#include "styles/lammps_release.h"
#include "styles/motion/counted_random.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "update.h"

#include <cmath>
#include <cstdint>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;
using deformable::CountedRandom;
using deformable::PI;

/* ---------------------------------------------------------------------- */

FixDeformablePropel::FixDeformablePropel(LAMMPS *lmp, int narg, char **arg)
    : FixMemory(lmp, narg, arg, "propel/active")
{
  if (narg < 6) utils::missing_cmd_args(FLERR, "fix deformable/propel", error);
  if (narg > 6)
    error->all(FLERR_WORD(6), "Unknown fix deformable/propel argument '{}' after the seed", arg[6]);
  strength = utils::numeric(FLERR, arg[3], false, lmp);
  if (!(strength > 0.0))
    error->all(FLERR_WORD(3), "Fix deformable/propel: f is '{}': it must be positive", arg[3]);
  const bool stay = !std::strcmp(arg[4], "inf");    // which LAMMPS does not take for a number
  persistence = stay ? HUGE_VAL : utils::numeric(FLERR, arg[4], false, lmp);
  if (!(persistence > 0.0))
    error->all(FLERR_WORD(4), "Fix deformable/propel: tau is '{}': it must be positive", arg[4]);
  const int number = utils::inumeric(FLERR, arg[5], false, lmp);
  if (number <= 0)
    error->all(FLERR_WORD(5), "Fix deformable/propel: the seed is '{}': it must be positive",
               arg[5]);
  seed = static_cast<std::uint64_t>(number);
  if (!atom->tag_enable)
    error->all(FLERR,
               "Fix {} deformable/propel needs atom IDs, without which no random number "
               "belongs to an atom: use 'atom_modify id yes'",
               id);

  peratom_flag = 1;
  size_peratom_cols = 2;
  peratom_freq = 1;
  dynamic_group_allow = 1;
  begin();
  for (int i = 0; i < atom->nlocal; ++i) direction_of(i);
}

/* ---------------------------------------------------------------------- */

int FixDeformablePropel::setmask()
{
  return POST_FORCE;
}

void FixDeformablePropel::init()
{
  if (domain->dimension != 2)
    error->all(FLERR, "Fix {} deformable/propel is two-dimensional: use 'dimension 2'", id);
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "Fix {} deformable/propel cannot be used with run_style respa", id);
}

/* ----------------------------------------------------------------------
   A step has the directions at its end: a run begins with the directions that
   the last run has left.
------------------------------------------------------------------------- */

void FixDeformablePropel::setup(int)
{
  push(0.0);
}

void FixDeformablePropel::post_force(int)
{
  push(std::sqrt(2.0 * update->dt / persistence));
}

/* ----------------------------------------------------------------------
   Turn by a normal deviate times this angle, then push.
------------------------------------------------------------------------- */

void FixDeformablePropel::push(double angle_per_deviation)
{
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    Direction &n = direction_of(i);
    if (angle_per_deviation > 0.0) {
      CountedRandom random(seed, atom->tag[i], update->ntimestep);
      const double angle = std::atan2(n.y, n.x) + angle_per_deviation * random.gaussian();
      n.x = std::cos(angle);
      n.y = std::sin(angle);
    }
    atom->f[i][0] += strength * n.x;
    atom->f[i][1] += strength * n.y;
  }
}

/* ----------------------------------------------------------------------
   A particle that is new gets one, which depends on its ID alone.
------------------------------------------------------------------------- */

Direction &FixDeformablePropel::direction_of(int i)
{
  Direction &n = particles[i];
  if (n.x == 0.0 && n.y == 0.0) {
    CountedRandom random(seed, atom->tag[i], ~std::uint64_t{0});
    const double angle = 2.0 * PI * random.uniform();
    n.x = std::cos(angle);
    n.y = std::sin(angle);
  }
  return n;
}

// For the output of each particle.
void FixDeformablePropel::grow_arrays(int size)
{
  FixMemory::grow_arrays(size);
  rows.resize(size);
  for (int i = 0; i < size; ++i) rows[i] = &particles[i].x;
  array_atom = rows.data();
}
