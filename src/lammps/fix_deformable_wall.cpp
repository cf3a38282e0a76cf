#include "fix_deformable_wall.h"

#include "domain.h"
#include "error.h"
#include "force.h"
#include "pair.h"
#include "update.h"

#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;

/* ---------------------------------------------------------------------- */

FixDeformableWall::FixDeformableWall(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  if (narg < 4) utils::missing_cmd_args(FLERR, "fix deformable/wall", error);
  if (narg > 4)
    error->all(FLERR, 4, "Unknown fix deformable/wall argument '{}': it takes a region ID only",
               arg[4]);
  region_id = arg[3];
  if (!domain->get_region_by_id(region_id))
    error->all(FLERR, 3, "Region '{}' of fix deformable/wall does not exist", region_id);

  delete[] style;
  style = utils::strdup(STYLE);

  vector_flag = 1;
  size_vector = 3;
  extvector = 1;
  global_freq = 1;
  virial_global_flag = virial_peratom_flag = 1;
  dynamic_group_allow = 1;
}

/* ---------------------------------------------------------------------- */

int FixDeformableWall::setmask()
{
  return PRE_FORCE | MIN_PRE_FORCE | POST_FORCE | MIN_POST_FORCE;
}

/* ---------------------------------------------------------------------- */

void FixDeformableWall::init()
{
  region = domain->get_region_by_id(region_id);
  if (!region)
    error->all(FLERR, "Region '{}' of fix {} deformable/wall does not exist", region_id, id);
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "Fix {} deformable/wall cannot be used with run_style respa", id);
  if (!force->pair_match("^deformable/", 0) && !force->pair_match("^deformable/", 0, 1))
    error->all(FLERR, "Fix {} deformable/wall needs a deformable pair style, but pair_style is {}",
               id, force->pair_style ? force->pair_style : "none");

  // Region::Contact::radius, made for granular particles, is twice the radius of a cylinder and the radius of a
  // sphere. It is unknown for other curved surfaces.
  curvature_factor = std::strcmp(region->style, "cylinder") == 0 ? 0.5
                     : std::strcmp(region->style, "sphere") == 0 ? 1.0
                                                                 : 0.0;
  if (curvature_factor == 0.0) require_flat(region, !region->interior);
  axis_checked = false;
}

/* ---------------------------------------------------------------------- */

void FixDeformableWall::require_flat(const Region *part, bool outside) const
{
  if (part->reglist) {
    for (int n = 0; n < part->nregion; ++n) {
      const Region *inner = part->reglist[n];
      require_flat(inner, outside != !inner->interior);
    }
    return;
  }
  if (std::strcmp(part->style, "plane") == 0) return;
  if (std::strcmp(part->style, "block") != 0 && std::strcmp(part->style, "prism") != 0)
    error->all(FLERR,
               "Fix {} deformable/wall: region '{}' of style {} has a curved surface; build the "
               "container from planes, blocks and prisms, or use one cylinder or sphere alone",
               id, part->id, part->style);
  if (outside)
    error->all(FLERR,
               "Fix {} deformable/wall: particles outside of region '{}' would touch the corners "
               "of a {}, which are no flat walls; build the obstacle from planes",
               id, part->id, part->style);
}

/* ---------------------------------------------------------------------- */

void FixDeformableWall::setup(int vflag)
{
  post_force(vflag);
}

void FixDeformableWall::min_setup(int vflag)
{
  post_force(vflag);
}

void FixDeformableWall::setup_pre_force(int vflag)
{
  pre_force(vflag);
}

/* ----------------------------------------------------------------------
   Clears the forces before the pair style is called; moves the region.
------------------------------------------------------------------------- */

void FixDeformableWall::pre_force(int)
{
  wall_forces.assign(atom->nlocal, WallForce{});
  callers.clear();
  region->prematch();
}

void FixDeformableWall::min_pre_force(int vflag)
{
  pre_force(vflag);
}

/* ---------------------------------------------------------------------- */

void FixDeformableWall::post_force(int vflag)
{
  v_init(vflag);
  double *const *const f = atom->f;
  on_wall[0] = on_wall[1] = 0.0;
  for (int i = 0; i < static_cast<int>(wall_forces.size()); ++i) {
    const WallForce &force = wall_forces[i];
    if (force.fx == 0.0 && force.fy == 0.0) continue;
    f[i][0] += force.fx;
    f[i][1] += force.fy;
    on_wall[0] -= force.fx;
    on_wall[1] -= force.fy;
    if (evflag) {
      double v[6] = {force.vxx, force.vyy, 0.0, force.vxy, 0.0, 0.0};
      v_tally(i, v);
    }
  }
}

void FixDeformableWall::min_post_force(int vflag)
{
  post_force(vflag);
}

/* ----------------------------------------------------------------------
   Force on the wall.
------------------------------------------------------------------------- */

double FixDeformableWall::compute_vector(int n)
{
  if (n > 1) return 0.0;
  double all;
  MPI_Allreduce(&on_wall[n], &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

/* ----------------------------------------------------------------------
   The tangent of a flat face does not rotate. That of a curved face rotates
   about its center of curvature, which is at radius - height behind a particle
   inside the curve, and at radius + height before a particle outside.
------------------------------------------------------------------------- */

double FixDeformableWall::per_lever(const Region::Contact &face) const
{
  return face.radius == 0.0 ? 0.0 : 1.0 / (curvature_factor * face.radius + face.r);
}

/* ----------------------------------------------------------------------
   A cylinder along x or y is flat in the plane. The check: whether the face
   rotates when the particle takes a small step along it.
------------------------------------------------------------------------- */

void FixDeformableWall::check_axis(const double *x, double cutoff, const Region::Contact &face)
{
  axis_checked = true;
  const double step = 1e-3 * face.r, tx = -face.dely / face.r, ty = face.delx / face.r;
  const int n = region->surface(x[0] + step * tx, x[1] + step * ty, x[2], 2.0 * cutoff);
  for (int m = 0; m < n; ++m) {
    const Region::Contact &moved = region->contact[m];
    if (moved.radius == 0.0) continue;
    const double rotation =
        std::fabs(face.delx * moved.dely - face.dely * moved.delx) / (face.r * moved.r);
    if (rotation < 0.5 * step * std::fabs(per_lever(face)))
      error->one(FLERR, "Fix {} deformable/wall: the axis of cylinder '{}' must be along z", id,
                 region_id);
  }
}

/* ---------------------------------------------------------------------- */

void FixDeformableWall::refuse_outside(int i)
{
  const double *x = atom->x[i];
  error->one(FLERR,
             "The center of atom {} at ({:.6g}, {:.6g}) is outside of region '{}' of fix {} "
             "deformable/wall",
             atom->tag[i], x[0], x[1], region_id, id);
}

void FixDeformableWall::refuse_face(int i, double distance)
{
  if (distance > 0.0)
    error->one(FLERR,
               "Fix {} deformable/wall: the surface of region '{}' is not perpendicular to the "
               "xy plane at atom {}",
               id, region_id, atom->tag[i]);
  error->one(FLERR,
             "The center of atom {} lies on the surface of region '{}' of fix {} deformable/wall",
             atom->tag[i], region_id, id);
}

/* ---------------------------------------------------------------------- */

double FixDeformableWall::memory_usage()
{
  return static_cast<double>(wall_forces.capacity() * sizeof(WallForce));
}
