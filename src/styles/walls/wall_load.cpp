// A wall under a load: m a = f - F along its axis, with the force f of the particles, by velocity Verlet as they are. What sides
// that move write to restart files.

#include "styles/walls/fix_deformable_wall.h"

#include "comm.h"
#include "error.h"
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
   Places of the sides that move by variables or a load; velocity; and the
   energy that particles have given.
------------------------------------------------------------------------- */

std::vector<double *> FixDeformableWall::moving_places()
{
  std::vector<double *> found;
  for (WallShape &shape : sources().shapes)
    if (shape.side.is_loaded || shape.side.place.varies()) found.push_back(&shape.side.place.now);
  return found;
}

void FixDeformableWall::write_restart(FILE *file)
{
  const std::vector<double *> places = moving_places();
  std::vector<double> list = {static_cast<double>(places.size()), load.mass, load.v,
                              compute_scalar()};
  for (const double *place : places) list.push_back(*place);
  if (comm->me != 0) return;
  const int size = static_cast<int>(list.size() * sizeof(double));
  fwrite(&size, sizeof(int), 1, file);
  fwrite(list.data(), sizeof(double), list.size(), file);
}

void FixDeformableWall::restart(char *buffer)
{
  const auto *list = reinterpret_cast<const double *>(buffer);
  const std::vector<double *> places = moving_places();
  const bool was_loaded = list[1] > 0.0, is_loaded = load.mass > 0.0;
  if (list[0] != static_cast<double>(places.size()) || was_loaded != is_loaded) {
    if (comm->me == 0)
      error->warning(FLERR,
                     "Fix {} deformable/wall: the restart file has {:.0f} sides of it that move{}, "
                     "here are {}{}, which begin anew",
                     id, list[0], was_loaded ? " under a load" : "", places.size(),
                     is_loaded ? " under a load" : "");
    return;
  }
  load.v = list[2];
  restore_energy(comm->me == 0 ? list[3] : 0.0);
  list += 4;
  for (double *place : places) *place = *list++;
}
