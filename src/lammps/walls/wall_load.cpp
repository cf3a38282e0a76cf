// A wall under a load: m a = f - F along its axis, with the force f of the particles, by velocity Verlet as they are.

#include "fix_deformable_wall.h"

#include "comm.h"
#include "force.h"
#include "update.h"

using namespace LAMMPS_NS;

// Half a step of the velocity.
void FixDeformableWall::kick()
{
  const int sign = sources().shapes[0].side.sign;
  load.v += 0.5 * update->dt * force->ftm2v * (load.pushed - sign * load.force.now) / load.mass;
}

void FixDeformableWall::initial_integrate(int)
{
  kick();
  sources().shapes[0].side.place.now += update->dt * load.v;
}

void FixDeformableWall::final_integrate()
{
  kick();
}

/* ----------------------------------------------------------------------
   Place and velocity, and the energy that the wall has been given.
------------------------------------------------------------------------- */

void FixDeformableWall::write_restart(FILE *file)
{
  const double list[] = {sources().shapes[0].side.place.now, load.v, compute_scalar()};
  if (comm->me != 0) return;
  const int size = sizeof(list);
  fwrite(&size, sizeof(int), 1, file);
  fwrite(list, sizeof(list), 1, file);
}

void FixDeformableWall::restart(char *buffer)
{
  const auto *const list = reinterpret_cast<const double *>(buffer);
  sources().shapes[0].side.place.now = list[0];
  load.v = list[1];
  restore_energy(comm->me == 0 ? list[2] : 0.0);
}
