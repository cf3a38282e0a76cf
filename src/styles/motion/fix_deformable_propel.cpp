#include "styles/motion/fix_deformable_propel.h"

#include "styles/lammps_release.h"

#include "styles/motion/counted_random.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "memory.h"
#include "update.h"

#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;

/* ---------------------------------------------------------------------- */

FixDeformablePropel::FixDeformablePropel(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
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

  // see fix_deformable_wall.h
  delete[] style;
  style = utils::strdup("propel/active");

  peratom_flag = 1;
  size_peratom_cols = 2;
  peratom_freq = 1;
  dynamic_group_allow = 1;
  restart_peratom = 1;
  create_attribute = 1;

  FixDeformablePropel::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
  for (int i = 0; i < atom->nlocal; ++i) {
    FixDeformablePropel::set_arrays(i);
    direction_of(i);
  }
}

FixDeformablePropel::~FixDeformablePropel()
{
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
  memory->destroy(directions);
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
   The directions of a step are those at its end: a run begins with those
   that the last one has left.
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
    double *n = direction_of(i);
    if (angle_per_deviation > 0.0) {
      deformable::CountedRandom random(seed, atom->tag[i], update->ntimestep);
      const double angle = std::atan2(n[1], n[0]) + angle_per_deviation * random.gaussian();
      n[0] = std::cos(angle);
      n[1] = std::sin(angle);
    }
    atom->f[i][0] += strength * n[0];
    atom->f[i][1] += strength * n[1];
  }
}

/* ----------------------------------------------------------------------
   A particle that is new gets one, which depends on its ID alone.
------------------------------------------------------------------------- */

double *FixDeformablePropel::direction_of(int i)
{
  double *n = directions[i];
  if (n[0] == 0.0 && n[1] == 0.0) {
    deformable::CountedRandom random(seed, atom->tag[i], ~std::uint64_t{0});
    const double angle = 2.0 * deformable::PI * random.uniform();
    n[0] = std::cos(angle);
    n[1] = std::sin(angle);
  }
  return n;
}

/* ----------------------------------------------------------------------
   Directions move with their particles: in memory, to other ranks, and into
   restart files.
------------------------------------------------------------------------- */

void FixDeformablePropel::grow_arrays(int nmax)
{
  memory->grow(directions, nmax, 2, "deformable/propel:directions");
  array_atom = directions;
}

void FixDeformablePropel::copy_arrays(int i, int j, int)
{
  pack_exchange(i, directions[j]);
}

void FixDeformablePropel::set_arrays(int i)
{
  directions[i][0] = directions[i][1] = 0.0;
}

int FixDeformablePropel::pack_exchange(int i, double *buf)
{
  buf[0] = directions[i][0];
  buf[1] = directions[i][1];
  return 2;
}

int FixDeformablePropel::unpack_exchange(int i, double *buf)
{
  directions[i][0] = buf[0];
  directions[i][1] = buf[1];
  return 2;
}

int FixDeformablePropel::pack_restart(int i, double *buf)
{
  buf[0] = 1 + pack_exchange(i, buf + 1);
  return maxsize_restart();
}

void FixDeformablePropel::unpack_restart(int i, int nth)
{
  double *extra = atom->extra[i];    // see FixDeformableStick
  for (int n = 0; n < nth; ++n) extra += static_cast<int>(extra[0]);
  unpack_exchange(i, extra + 1);
}

int FixDeformablePropel::size_restart(int)
{
  return maxsize_restart();
}

int FixDeformablePropel::maxsize_restart()
{
  return 3;
}

double FixDeformablePropel::memory_usage()
{
  return 2.0 * atom->nmax * sizeof(double);
}
