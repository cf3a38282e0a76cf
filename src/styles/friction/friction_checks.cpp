// What fix deformable/friction needs before a run, and what it refuses.

#include "styles/friction/fix_deformable_friction.h"

#include "styles/pair/deformable_pairs.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <limits>

using namespace LAMMPS_NS;

void FixDeformableFriction::init()
{
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "Fix {} deformable/friction cannot be used with run_style respa", id);
  if (thermo_energy)
    error->all(FLERR,
               "Fix {} deformable/friction: 'fix_modify {} energy yes' would count its losses as "
               "potential energy. Use the thermo keyword econserve, or f_{}[1] for the springs",
               id, id, id);
  pairs = deformable_pairs(*force);
  if (pairs.empty())
    error->all(FLERR,
               "Fix {} deformable/friction needs pair_style deformable/ring, but pair_style is {}",
               id, force->pair_style ? force->pair_style : "none");
  for (const PairDeformable *pair : pairs)
    if (!pair->slips())
      error->all(FLERR,
                 "Fix {} deformable/friction needs contacts that slip, but those of pair_style "
                 "deformable/sector stick: use deformable/ring",
                 id);
  if (!atom->tag_enable)
    error->all(FLERR, "Fix {} deformable/friction needs atom IDs: use 'atom_modify id yes'", id);
  comm->ghost_velocity = 1;
  find_partners();
  check_spins();
  check_box();
  coefficients.find_variables();
  find_lightest();
  if (!coefficients.vary()) check_time_step();    // variables have no values before the first step
}

/* ----------------------------------------------------------------------
   Particles by their IDs: partners that are not in contact any more.
------------------------------------------------------------------------- */

void FixDeformableFriction::find_partners()
{
  if (atom->map_style != Atom::MAP_NONE) return;
  atom->map_init();
  atom->map_set();
}

/* ----------------------------------------------------------------------
   What LAMMPS does not say by itself.
------------------------------------------------------------------------- */

void FixDeformableFriction::check_spins()
{
  if (told) return;
  told = true;
  if (comm->me != 0) return;
  if (!atom->omega_flag || !atom->torque_flag) {
    utils::logmesg(
        lmp,
        "Fix {} deformable/friction: atoms of atom_style {} have no spins, so that they "
        "only translate. For rotation use 'atom_style sphere' and 'fix nve/sphere disc'\n",
        id, atom->get_style());
    return;
  }
  const std::vector<Fix *> &fixes = modify->get_fix_list();
  const bool any = std::any_of(fixes.begin(), fixes.end(), [](const Fix *fix) {
    return utils::strmatch(fix->style, "sphere") || utils::strmatch(fix->style, "^rigid");
  });
  if (!any)
    error->warning(FLERR,
                   "Fix {} deformable/friction: no fix turns the particles, so that their spins do "
                   "not change. Use 'fix nve/sphere disc' or another style with 'sphere'",
                   id);
}

void FixDeformableFriction::check_box()
{
  if (told_box || !domain->deform_flag || domain->deform_vremap) return;
  told_box = true;
  if (comm->me == 0)
    error->warning(
        FLERR,
        "Fix {} deformable/friction: fix deform without 'remap v' leaves its shear out of "
        "the velocities, so that contacts do not rub by it",
        id);
}

void FixDeformableFriction::find_lightest()
{
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < atom->nlocal; ++i)
    if (atom->mask[i] & groupbit)
      least = std::min(least, atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]]);
  MPI_Allreduce(&least, &lightest, 1, MPI_DOUBLE, MPI_MIN, world);
}

void FixDeformableFriction::check_time_step() const
{
  if (update->whichflag != 1) return;             // minimizers pass over friction
  constexpr double SPHERE = 3.5;                  // 1 + m R^2/I; 3 of a disk
  const double mass = lightest / force->ftm2v;    // force time^2/distance units
  const double longest = coefficients.largest_time_step(mass, atom->omega_flag ? SPHERE : 1.0);
  if (update->dt > longest)
    error->all(FLERR,
               "Fix {} deformable/friction: the time step {:.6g} is too long for these stiffnesses "
               "and particles of mass {:.6g}: use {:.3g} or less, or smaller kt, gt or damp",
               id, update->dt, lightest, longest);
}

void FixDeformableFriction::reset_dt()
{
  check_time_step();
}
