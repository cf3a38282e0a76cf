#include "polygons/fix_deformable_stick.h"

#include "styles/lammps_release.h"
#include "styles/refusals.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "pair.h"

#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace deformable;
using namespace FixConst;

FixDeformableStick::FixDeformableStick(LAMMPS *lmp, int narg, char **arg)
    : FixMemory(lmp, narg, arg, "stick/wall")
{
  if (narg < 5) utils::missing_cmd_args(FLERR, "fix deformable/stick", error);
  region_id = arg[3];
  if (!domain->get_region_by_id(region_id))
    error->all(FLERR_WORD(3), "Region '{}' of fix deformable/stick does not exist", region_id);

  stiffness = utils::numeric(FLERR, arg[4], false, lmp);
  if (!(stiffness > 0.0 && std::isfinite(stiffness)))
    error->all(FLERR_WORD(4), "Fix deformable/stick: k is '{}': it must be positive and finite",
               arg[4]);
  if (narg > 5) {
    if (std::strcmp(arg[5], "radius") != 0)
      error->all(FLERR_WORD(5), "Unknown fix deformable/stick keyword '{}': it must be 'radius'",
                 arg[5]);
    if (narg < 7) utils::missing_cmd_args(FLERR, "fix deformable/stick radius", error);
    given_radius = utils::numeric(FLERR, arg[6], false, lmp);
    if (!(given_radius > 0.0 && std::isfinite(given_radius)))
      error->all(FLERR_WORD(6),
                 "Fix deformable/stick: radius is '{}': it must be positive and finite", arg[6]);
  }
  if (narg > 7)
    error->all(FLERR_WORD(7), "Unknown fix deformable/stick argument '{}' after 'radius'", arg[7]);

  scalar_flag = 1;
  extscalar = 1;
  vector_flag = 1;
  size_vector = 3;
  extvector = 1;
  global_freq = 1;
  energy_global_flag = 1;
  thermo_energy = 1;
  virial_global_flag = virial_peratom_flag = 1;
  dynamic_group_allow = 1;
  begin();
}

int FixDeformableStick::setmask()
{
  return POST_FORCE | MIN_POST_FORCE;
}

void FixDeformableStick::init()
{
  region = domain->get_region_by_id(region_id);
  if (!region)
    error->all(FLERR, "Region '{}' of fix {} deformable/stick does not exist", region_id, id);
  if (domain->dimension != 2)
    error->all(FLERR, "Fix {} deformable/stick is two-dimensional: use 'dimension 2'", id);
  refuse_respa(lmp, id, "deformable/stick");

  radii.assign(atom->ntypes + 1, given_radius);
  if (given_radius > 0.0) return;
  if (!force->pair)
    error->all(
        FLERR,
        "Fix {} deformable/stick takes the radius of beads from the pair style, but there is no "
        "pair style: use the keyword 'radius'",
        id);
  for (int type = 1; type <= atom->ntypes; ++type)
    radii[type] = 0.5 * std::sqrt(force->pair->cutsq[type][type]);
}

void FixDeformableStick::post_force(int vflag)
{
  v_init(vflag);
  energy = on_wall[0] = on_wall[1] = 0.0;
  region->prematch();
  Refusals(lmp).check([this] {
    for (int i = 0; i < atom->nlocal; ++i)
      particles[i] = atom->mask[i] & groupbit ? find_anchors(i) : Anchors{};
  });
}

/* ----------------------------------------------------------------------
   The faces that a bead touches, with their anchors. A new touch has its
   anchor at the position of the bead.
------------------------------------------------------------------------- */

Anchors FixDeformableStick::find_anchors(int i)
{
  const double *x = atom->x[i], radius = radii[atom->type[i]];
  if (!(radius > 0.0))
    refuse(i,
           "has no radius, as its type has no range in the pair style: use the keyword 'radius'");
  if (!region->match(x[0], x[1], x[2]))
    refuse(i, fmt::format("is outside of region '{}'", region_id));

  Anchors found;
  std::size_t touching = 0;
  const int n = region->surface(x[0], x[1], x[2], radius);
  for (int m = 0; m < n; ++m) {
    const Region::Contact &face = region->contact[m];
    if (face.delx == 0.0 && face.dely == 0.0 && face.delz != 0.0) continue;    // above or below
    if (!(face.r > 0.0)) refuse(i, fmt::format("lies on the surface of region '{}'", region_id));
    if (face.delz != 0.0)
      refuse(i, fmt::format(
                    "touches a surface of region '{}' that is not perpendicular to the xy plane",
                    region_id));
    if (touching == found.size())
      refuse(i, fmt::format("touches more than two faces of region '{}'", region_id));
    if (touching > 0 && found[0].face == face.iwall)
      refuse(i, fmt::format("touches two faces of region '{}' with the same number: define the "
                            "region with 'side in'",
                            region_id));
    Anchor &anchor = found[touching++];
    anchor = {static_cast<double>(face.iwall), x[0], x[1]};
    for (const Anchor &old : particles[i])
      if (old.face == face.iwall) anchor = old;
    add_springs(i, radius, face, anchor);
  }
  if (!std::isfinite(energy))
    refuse(i, "has a force that is not finite: use a smaller k or radius");
  return found;
}

/* ----------------------------------------------------------------------
   E = k/2 (p - r)^2 + k/2 t^2, t = s.(x - anchor) along the direction s of
   the face at the bead. The virial of a spring is its force times its length.
------------------------------------------------------------------------- */

void FixDeformableStick::add_springs(int i, double radius, const Region::Contact &face,
                                     const Anchor &anchor)
{
  const double nx = face.delx / face.r, ny = face.dely / face.r;    // s = (-ny, nx)
  double d[3] = {atom->x[i][0] - anchor.x, atom->x[i][1] - anchor.y, 0.0};
  minimum_image(domain, d);
  const double t = nx * d[1] - ny * d[0];
  const double normal = stiffness * (radius - face.r), tangential = -stiffness * t;
  const double fx = normal * nx - tangential * ny, fy = normal * ny + tangential * nx;

  energy += 0.5 * stiffness * ((radius - face.r) * (radius - face.r) + t * t);
  atom->f[i][0] += fx;
  atom->f[i][1] += fy;
  on_wall[0] -= fx;
  on_wall[1] -= fy;
  if (evflag) {
    const double nn = normal * face.r, tt = tangential * t;
    double v[6] = {nn * nx * nx + tt * ny * ny,
                   nn * ny * ny + tt * nx * nx,
                   0.0,
                   (nn - tt) * nx * ny,
                   0.0,
                   0.0};
    v_tally(i, v);
  }
}

void FixDeformableStick::refuse(int i, const std::string &problem)
{
  const double *x = atom->x[i];
  deformable::refuse("Fix {} deformable/stick: atom {} at ({:.6g}, {:.6g}) {}", id, atom->tag[i],
                     x[0], x[1], problem);
}

double FixDeformableStick::compute_scalar()
{
  return sum_of_ranks(world, energy);
}

/* ----------------------------------------------------------------------
   Force on the wall.
------------------------------------------------------------------------- */

double FixDeformableStick::compute_vector(int n)
{
  return n > 1 ? 0.0 : sum_of_ranks(world, on_wall[n]);
}
