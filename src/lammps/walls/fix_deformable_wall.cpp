#include "fix_deformable_wall.h"

#include "lammps_release.h"

#include "parameter_rules.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "pair.h"
#include "update.h"

#include <cmath>
#include <cstring>
#include <utility>

using namespace LAMMPS_NS;
using namespace FixConst;

/* ---------------------------------------------------------------------- */

FixDeformableWall::FixDeformableWall(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  if (narg < 4) utils::missing_cmd_args(FLERR, "fix deformable/wall", error);
  narg = read_adhesion(narg, arg);
  if (narg > 4 && WallSources::is_word(arg[3])) {
    WallSources sources;
    require(sources.read_words(narg - 3, arg + 3, lmp));
    require(scene.assign(std::move(sources)));
  } else {
    region_id = arg[3];
    const bool exists = domain->get_region_by_id(region_id);
    if (narg > 4)
      error->all(FLERR_WORD(exists ? 4 : 3),
                 "Unknown fix deformable/wall argument '{}': it needs a region ID only, or shapes "
                 "that begin with 'plane', 'circle', 'disk', 'segment' or 'polygon'",
                 arg[exists ? 4 : 3]);
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
  size_vector = 3;
  extvector = 1;
  global_freq = 1;
  virial_global_flag = virial_peratom_flag = 1;
  dynamic_group_allow = 1;
}

/* ----------------------------------------------------------------------
   The keyword comes last. Returns the number of words before it.
------------------------------------------------------------------------- */

int FixDeformableWall::read_adhesion(int narg, char **arg)
{
  int words = 4;    // a region may be called adhesion
  while (words < narg && std::strcmp(arg[words], "adhesion") != 0) ++words;
  if (words == narg) return narg;
  if (words + 1 == narg) utils::missing_cmd_args(FLERR, "fix deformable/wall adhesion", error);
  if (words + 2 < narg)
    error->all(FLERR_WORD(words + 2),
               "Fix {} deformable/wall: unknown word '{}' after adhesion, which takes one number "
               "and comes last",
               id, arg[words + 2]);
  stickiness = utils::numeric(FLERR, arg[words + 1], false, lmp);
  require(deformable::invalid_adhesion(stickiness));
  return words;
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
  return PRE_FORCE | MIN_PRE_FORCE | POST_FORCE | MIN_POST_FORCE;
}

/* ---------------------------------------------------------------------- */

void FixDeformableWall::init()
{
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "Fix {} deformable/wall cannot be used with run_style respa", id);
  if (domain->dimension != 2)
    error->all(FLERR, "Fix {} deformable/wall is two-dimensional: use 'dimension 2'", id);
  if (!force->pair_match("^deformable/", 0) && !force->pair_match("^deformable/", 0, 1))
    error->all(FLERR, "Fix {} deformable/wall needs a deformable pair style, but pair_style is {}",
               id, force->pair_style ? force->pair_style : "none");
  if (thermo_energy)
    error->all(FLERR,
               "Fix {} deformable/wall has no energy for 'fix_modify {} energy yes': what walls "
               "compress is the energy of the particles, part of the pair energy. Use 'energy no'",
               id, id);
  if (!region_id.empty()) read_region();
  if (comm->me == 0) warn_of_box();
}

void FixDeformableWall::read_region()
{
  region = domain->get_region_by_id(region_id);
  if (!region)
    error->all(FLERR, "Region '{}' of fix {} deformable/wall does not exist", region_id, id);
  WallSources sources;
  require(sources.read_region(region, 0.5 * (domain->boxlo[0] + domain->boxhi[0]),
                              0.5 * (domain->boxlo[1] + domain->boxhi[1])));
  require(scene.assign(std::move(sources)));
}

// A shrink-wrapped boundary follows the particles; others hold them up before they meet the wall.
void FixDeformableWall::warn_of_box() const
{
  enum { PERIODIC, FIXED };
  constexpr double ROUNDING = 1e-9;    // of the box
  for (int axis = 0; axis < 2 && !domain->triclinic; ++axis) {
    const int *const kind = domain->boundary[axis];
    const double low = domain->boxlo[axis], high = domain->boxhi[axis];
    const double rest = ROUNDING * (high - low);
    const int wall = scene.first_outside(axis, kind[0] <= FIXED ? low - rest : -INFINITY,
                                         kind[1] <= FIXED ? high + rest : INFINITY);
    if (wall < 0) continue;
    error->warning(FLERR,
                   "Fix {} deformable/wall: '{}' lies outside of the simulation box in {} ({:.6g} "
                   "to {:.6g}): particles leave the box before they meet it. Enlarge the box "
                   "(change_box), or use a boundary s or m",
                   id, scene.source(wall).name, axis == 0 ? 'x' : 'y', low, high);
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
  scene.period = {domain->xperiodic ? domain->xprd : 0.0, domain->yperiodic ? domain->yprd : 0.0,
                  domain->triclinic ? domain->xy : 0.0};
  if (!scene.moves()) return;
  region->prematch();
  require(scene.update());
  scene.begin_step(counts);
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
  if (scene.moves()) scene.end_step();
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
  double here = scene.energy_given();
  double all;
  MPI_Allreduce(&here, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
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

/* ---------------------------------------------------------------------- */

void FixDeformableWall::refuse_center(int i, const WallScene::Refused &refused)
{
  const double *x = atom->x[i];
  const WallSource &source = scene.source(refused.wall);
  const bool solid = source.kind == WallSource::DISK || source.kind == WallSource::POLYGON ||
                     (source.kind == WallSource::FACE && source.sides[0].reversed);
  const std::string name = region_id.empty() ? "'" + source.name + "'"
                           : source.name == region_id
                               ? "region '" + region_id + "'"
                               : "part '" + source.name + "' of region '" + region_id + "'";
  const std::string place = refused.height > 0.0 ? fmt::format("only {:.3g} from", refused.height)
                            : solid              ? "in the obstacle"
                                                 : "outside of";
  error->one(FLERR, "The center of atom {} at ({:.6g}, {:.6g}) is {} {} of fix {} deformable/wall",
             atom->tag[i], x[0], x[1], place, name, id);
}

/* ---------------------------------------------------------------------- */

double FixDeformableWall::memory_usage()
{
  return static_cast<double>(wall_forces.capacity() * sizeof(WallForce)) + scene.memory_usage();
}
