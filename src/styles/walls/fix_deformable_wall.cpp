#include "styles/walls/fix_deformable_wall.h"

#include "styles/friction/fix_deformable_friction.h"
#include "styles/lammps_release.h"
#include "styles/pair/deformable_pairs.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "modify.h"
#include "update.h"

#include <cmath>
#include <utility>

using namespace LAMMPS_NS;
using namespace FixConst;
using deformable::SurfacePoint;
using deformable::Vector3;

/* ---------------------------------------------------------------------- */

FixDeformableWall::FixDeformableWall(LAMMPS *lmp, int narg, char **arg)
    : Fix(lmp, narg, arg),
      words(utils::join_words({arg + std::min(3, narg), arg + narg}, " ")),
      dimension(domain->dimension)
{
  if (narg < 4) utils::missing_cmd_args(FLERR, "fix deformable/wall", error);
  narg = read_keywords(narg, arg);
  if (narg > 4 && WallSources::is_word(arg[3])) {
    WallSources sources;
    sources.dimension = dimension;
    require(sources.read_words(narg - 3, arg + 3, lmp));
    check_keywords(sources);
    take(std::move(sources));
  } else {
    region_id = arg[3];
    const bool exists = domain->get_region_by_id(region_id);
    if (narg > 4)
      error->all(FLERR_WORD(exists ? 4 : 3),
                 "Unknown fix deformable/wall argument '{}': it needs a region ID only, or shapes "
                 "that begin with {}",
                 arg[exists ? 4 : 3], WallSources::known_words(dimension));
    if (!exists)
      error->all(FLERR_WORD(3), "Region '{}' of fix deformable/wall does not exist", region_id);
  }

  delete[] style;
  style = utils::strdup(STYLE);

  energy_global_flag =
      1;    // or fix_modify refuses its option by a message with the other name of the style
  scalar_flag = 1;
  extscalar = 1;
  ecouple_flag = 1;
  vector_flag = 1;
  size_vector = load.mass > 0.0 ? 5 : 3;
  extvector = -1;
  static int extensive[] = {1, 1, 1, 0, 0};
  extlist = extensive;
  global_freq = nevery = 1;
  restart_global = moving_places().empty() ? 0 : 1;
  virial_global_flag = virial_peratom_flag = 1;
  dynamic_group_allow = 1;
}

/* ---------------------------------------------------------------------- */

// 'run ... pre no' would call this fix once more: the next run has its setup in any case.
FixDeformableWall::~FixDeformableWall()
{
  if (update) update->first_update = 0;
}

/* ---------------------------------------------------------------------- */

int FixDeformableWall::setmask()
{
  int mask = PRE_FORCE | MIN_PRE_FORCE | POST_FORCE | MIN_POST_FORCE;
  if (load.mass > 0.0) mask |= INITIAL_INTEGRATE | FINAL_INTEGRATE;
  if (!variables().empty()) mask |= END_OF_STEP;
  return mask;
}

/* ---------------------------------------------------------------------- */

void FixDeformableWall::init()
{
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "Fix {} deformable/wall cannot be used with run_style respa", id);
  if (deformable_pairs(*force).empty())
    error->all(FLERR,
               "Fix {} deformable/wall needs pair_style deformable/ring, deformable/sector or "
               "deformable/droplet, but pair_style is {}",
               id, force->pair_style ? force->pair_style : "none");
  if (thermo_energy)
    error->all(FLERR,
               "Fix {} deformable/wall has no energy for 'fix_modify {} energy yes': what walls "
               "compress is the energy of the particles, part of the pair energy. Use 'energy no'",
               id, id);
  if (!region_id.empty()) read_region();
  for (WallVariable *variable : variables()) require(variable->init(lmp));
  if (shear.axis >= 0 && comm->me == 0 &&
      modify->get_fix_by_style(FixDeformableFriction::STYLE).empty())
    error->warning(
        FLERR, "Fix {} deformable/wall: shear moves nothing without fix deformable/friction", id);
}

void FixDeformableWall::read_region()
{
  region = domain->get_region_by_id(region_id);
  if (!region)
    error->all(FLERR, "Region '{}' of fix {} deformable/wall does not exist", region_id, id);
  WallSources sources;
  sources.dimension = dimension;
  require(sources.read_region(region, 0.5 * (domain->boxlo[0] + domain->boxhi[0]),
                              0.5 * (domain->boxlo[1] + domain->boxhi[1])));
  check_keywords(sources);
  take(std::move(sources));
}

void FixDeformableWall::take(WallSources &&sources)
{
  require(dimension == 2 ? scene.assign(std::move(sources)) : space.assign(std::move(sources)));
}

// A shrink-wrapped boundary follows the particles; others hold them up before they meet the wall.
void FixDeformableWall::warn_of_box() const
{
  enum { PERIODIC, FIXED };
  constexpr double ROUNDING = 1e-9;    // of the box
  for (int axis = 0; axis < dimension && !domain->triclinic; ++axis) {
    const int *const kind = domain->boundary[axis];
    const double low = domain->boxlo[axis], high = domain->boxhi[axis];
    const double rest = ROUNDING * (high - low);
    const double from = kind[0] <= FIXED ? low - rest : -INFINITY,
                 to = kind[1] <= FIXED ? high + rest : INFINITY;
    const int wall =
        dimension == 2 ? scene.first_outside(axis, from, to) : space.first_outside(axis, from, to);
    if (wall < 0) continue;
    error->warning(FLERR,
                   "Fix {} deformable/wall: '{}' lies outside of the simulation box in {} ({:.6g} "
                   "to {:.6g}): particles leave the box before they meet it. Enlarge the box "
                   "(change_box), or use a boundary s or m",
                   id, dimension == 2 ? scene.source(wall).name : space.source(wall).name,
                   "xyz"[axis], low, high);
  }
}

/* ---------------------------------------------------------------------- */

void FixDeformableWall::require(const std::string &problem)
{
  if (!problem.empty()) error->all(FLERR, "Fix {} deformable/wall: {}", id, problem);
}

/* ---------------------------------------------------------------------- */

void FixDeformableWall::setup(int vflag)
{
  post_force(vflag);
  evaluate_at_the_end();
  require(load.force.begin_step(lmp, false));
}

void FixDeformableWall::min_setup(int vflag)
{
  post_force(vflag);
}

/* ----------------------------------------------------------------------
   Clears the forces before the pair style is called; moves the walls. Work is
   counted from one step of a run to the next.
------------------------------------------------------------------------- */

void FixDeformableWall::setup_pre_force(int)
{
  place(false);
  if (comm->me == 0) warn_of_box();
}

void FixDeformableWall::pre_force(int)
{
  place(true);
}

void FixDeformableWall::min_pre_force(int)
{
  place(false);
}

void FixDeformableWall::place(bool counts)
{
  wall_forces.assign(atom->nlocal, WallForce{});
  callers.clear();
  const bool tilted = domain->triclinic != 0;
  const double lx = domain->xperiodic ? domain->xprd : 0.0,
               ly = domain->yperiodic ? domain->yprd : 0.0,
               lz = domain->zperiodic ? domain->zprd : 0.0, xy = tilted ? domain->xy : 0.0,
               xz = tilted ? domain->xz : 0.0, yz = tilted ? domain->yz : 0.0;
  scene.period = {lx, ly, xy};
  space.period = {{{lx, 0.0, 0.0}, {xy, ly, 0.0}, {xz, yz, lz}}};
  if (!moves()) return;
  require(sources().place_sides(lmp, counts));
  if (update->whichflag == 2) check_places();
  require(shear.speed.begin_step(lmp, counts));
  if (shear.axis >= 0)
    (shear.axis == 0 ? scene.slide.x : scene.slide.y) = shear.speed.now * update->dt;
  require(load.force.begin_step(lmp, counts));
  if (region) match_region();
  require(dimension == 2 ? scene.update() : space.update());
  dimension == 2 ? scene.begin_step(counts) : space.begin_step(counts);
}

/* ----------------------------------------------------------------------
   Energies and virials of this step are not known yet. Computes that a variable
   of the region uses say so, and do not take those of an earlier step.
------------------------------------------------------------------------- */

void FixDeformableWall::match_region()
{
  bigint *const steps[] = {&update->eflag_global, &update->eflag_atom, &update->vflag_global,
                           &update->vflag_atom};
  bigint kept[4];
  for (int k = 0; k < 4; ++k) kept[k] = std::exchange(*steps[k], -1);
  modify->clearstep_compute();
  region->prematch();
  for (int k = 0; k < 4; ++k) *steps[k] = kept[k];
}

/* ----------------------------------------------------------------------
   A sideways step turns the contact as well. The virial is the derivative of
   the energy by a strain of droplets and walls: the wall's normal turns with
   it, which the torque feels, and where the wall is round the nearest point
   moves on.
------------------------------------------------------------------------- */

Vector3 FixDeformableWall::add_contact(int i, int feature, double force, const Vector3 &torque,
                                       const SurfacePoint &point, double cutoff)
{
  const Vector3 beside = across(torque, point.n), turned = point.turned(beside), &n = point.n;
  const Vector3 push = -force * n - turned;
  if (!first_call) return push;
  const double h = point.height;
  const Vector3 a = force * h * n + h * turned, b = h * turned - beside;    // n a + b n
  WallForce &sum = wall_forces[i];
  sum.fx += push.x;
  sum.fy += push.y;
  sum.fz += push.z;
  sum.vxx += n.x * a.x + b.x * n.x;
  sum.vyy += n.y * a.y + b.y * n.y;
  sum.vzz += n.z * a.z + b.z * n.z;
  sum.vxy += n.x * a.y + b.x * n.y;
  sum.vxz += n.x * a.z + b.x * n.z;
  sum.vyz += n.y * a.z + b.y * n.z;
  const double *const x = atom->x[i];
  if (space.moves()) space.add_force(feature, {x[0], x[1], x[2]}, force, beside, cutoff);
  return push;
}

/* ---------------------------------------------------------------------- */

void FixDeformableWall::post_force(int vflag)
{
  v_init(vflag);
  double *const *const f = atom->f;
  for (double &sum : on_wall) sum = 0.0;
  for (int i = 0; i < static_cast<int>(wall_forces.size()); ++i) {
    const WallForce &force = wall_forces[i];
    // forces of opposite walls may cancel to the last bit
    if (force.fx == 0.0 && force.fy == 0.0 && force.fz == 0.0 && force.vxx == 0.0 &&
        force.vyy == 0.0 && force.vzz == 0.0)
      continue;
    f[i][0] += force.fx;
    f[i][1] += force.fy;
    f[i][2] += force.fz;
    on_wall[0] -= force.fx;
    on_wall[1] -= force.fy;
    on_wall[2] -= force.fz;
    if (evflag) {
      double v[6] = {force.vxx, force.vyy, force.vzz, force.vxy, force.vxz, force.vyz};
      v_tally(i, v);
    }
  }
  if (moves()) dimension == 2 ? scene.end_step() : space.end_step();
  if (load.mass > 0.0) load.pushed = compute_vector(sources().shapes[0].side.axis);
}

void FixDeformableWall::min_post_force(int vflag)
{
  post_force(vflag);
}

/* ----------------------------------------------------------------------
   Energy that the particles have given to the moving wall in runs.
------------------------------------------------------------------------- */

double FixDeformableWall::compute_scalar()
{
  double here = dimension == 2 ? scene.energy_given() : space.energy_given();
  double all;
  MPI_Allreduce(&here, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

/* ----------------------------------------------------------------------
   Force on the wall; place and velocity of one under a load.
------------------------------------------------------------------------- */

double FixDeformableWall::compute_vector(int n)
{
  if (n >= 3) return n == 3 ? sources().shapes[0].side.place.now : load.v;
  double all;
  MPI_Allreduce(&on_wall[n], &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

/* ---------------------------------------------------------------------- */

void FixDeformableWall::refuse_center(int i, double radius, const RefusedCenter &refused)
{
  const double *x = atom->x[i];
  const WallSource &source =
      dimension == 2 ? scene.source(refused.wall) : space.source(refused.wall);
  const bool solid = source.kind == WallSource::DISK || source.kind == WallSource::POLYGON ||
                     (source.kind == WallSource::FACE && source.sides[0].reversed);
  const std::string name = region_id.empty() ? "'" + source.name + "'"
                           : source.name == region_id
                               ? "region '" + region_id + "'"
                               : "part '" + source.name + "' of region '" + region_id + "'";
  if (refused.room > 0.0)
    refuse("Atom {} of radius {:.6g} is wider than {} of fix {} deformable/wall, whose radius is "
           "{:.6g} there: it would have one contact or none. Use a wider container, or planes",
           atom->tag[i], radius, name, id, refused.room);
  const std::string place = refused.height > 0.0 ? fmt::format("only {:.3g} from", refused.height)
                            : solid              ? "in the obstacle"
                                                 : "outside of";
  const std::string at = dimension == 2 ? fmt::format("({:.6g}, {:.6g})", x[0], x[1])
                                        : fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0], x[1], x[2]);
  refuse("The center of atom {} at {} is {} {} of fix {} deformable/wall", atom->tag[i], at, place,
         name, id);
}

/* ---------------------------------------------------------------------- */

double FixDeformableWall::memory_usage()
{
  return static_cast<double>(wall_forces.capacity() * sizeof(WallForce)) + scene.memory_usage() +
         space.memory_usage();
}
