#include "styles/walls/fix_deformable_wall.h"

#include "styles/all_ranks.h"
#include "styles/friction/fix_deformable_friction.h"
#include "styles/lammps_release.h"
#include "styles/pair/pair_deformable.h"
#include "styles/refusals.h"

#include "laws/parameter_rules.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

using namespace LAMMPS_NS;
using namespace deformable;
using namespace FixConst;

FixDeformableWall::FixDeformableWall(LAMMPS *lmp, int narg, char **arg)
    : Fix(lmp, narg, arg),
      words(utils::join_words({arg + std::min(3, narg), arg + narg}, " ")),
      dimension(domain->dimension),
      walls(dimension)
{
  if (narg < 4) utils::missing_cmd_args(FLERR, "fix deformable/wall", error);
  if (modify->get_fix_by_style(STYLE).size() == MOST_WALLS)
    error->all(
        FLERR,
        "Fix {} deformable/wall: there are {} fixes deformable/wall already, and no more can "
        "be: give one fix several walls, as the sides and obstacles of one region",
        id, MOST_WALLS);
  narg = read_keywords(narg, arg);
  if (narg > 4 && Walls::is_word(arg[3])) {
    Walls found(dimension);
    require(found.read_words(narg - 3, arg + 3, lmp));
    take(std::move(found));
  } else {
    region_id = arg[3];
    const bool exists = domain->get_region_by_id(region_id);
    if (narg > 4)
      error->all(FLERR_WORD(exists ? 4 : 3),
                 "Unknown fix deformable/wall argument '{}': it needs a region ID only, or shapes "
                 "that begin with {}",
                 arg[exists ? 4 : 3], Walls::known_words(dimension));
    if (!exists)
      error->all(FLERR_WORD(3), "Region '{}' of fix deformable/wall does not exist", region_id);
  }

  delete[] style;
  style = utils::strdup(STYLE);

  // or fix_modify refuses its option by a message with the other name of the style
  energy_global_flag = 1;
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

// And how many values they have.
static constexpr struct {
  const char *name;
  int values;
} KEYWORDS[] = {{"adhesion", 1}, {"shear", 2}, {"load", 2}, {"move", 3}, {"rotate", 7}};

/* ----------------------------------------------------------------------
   Keywords come last. Returns the number of words before them.
------------------------------------------------------------------------- */

int FixDeformableWall::read_keywords(int narg, char **arg)
{
  const auto is_keyword = [&](const char *word) {
    return std::any_of(std::begin(KEYWORDS), std::end(KEYWORDS),
                       [&](const auto &keyword) { return std::strcmp(word, keyword.name) == 0; });
  };
  int first = 4;    // a region may be called adhesion
  while (first < narg && !is_keyword(arg[first])) ++first;
  for (int iarg = first; iarg < narg;) {
    if (!is_keyword(arg[iarg]))
      error->all(
          FLERR_WORD(iarg),
          "Fix {} deformable/wall: unknown word '{}' after {}: only adhesion w, shear dim v, "
          "load F m, move and rotate come last",
          id, arg[iarg], arg[first]);
    for (int before = first; before < iarg; ++before)
      if (!std::strcmp(arg[before], arg[iarg]))
        error->all(FLERR_WORD(iarg), "Fix {} deformable/wall: {} is there twice", id, arg[iarg]);
    iarg = read_keyword(iarg, narg, arg);
  }
  return first;
}

// Returns the place of what follows it.
int FixDeformableWall::read_keyword(int iarg, int narg, char **arg)
{
  const std::string keyword = arg[iarg];
  const int values = std::find_if(std::begin(KEYWORDS), std::end(KEYWORDS), [&](const auto &each) {
                       return keyword == each.name;
                     })->values;
  if (iarg + values >= narg)
    utils::missing_cmd_args(FLERR, "fix deformable/wall " + keyword, error);
  const char *const first = arg[iarg + 1];
  if (keyword == "adhesion") {
    stickiness = utils::numeric(FLERR, first, false, lmp);
    require(invalid_adhesion(stickiness));
  } else if (keyword == "shear") {
    shear.axis = first[0] - 'x';
    if (std::strlen(first) != 1 || shear.axis < 0 || shear.axis >= dimension)
      error->all(FLERR_WORD(iarg + 1), "Fix {} deformable/wall: shear goes along {}, not '{}'", id,
                 dimension == 2 ? "x or y" : "x, y or z", first);
    require(shear.speed.read("shear", arg[iarg + 2], lmp));
  } else if (keyword == "move" || keyword == "rotate") {
    read_ride(iarg, arg);
  } else {
    require(load.force.read("load", first, lmp));
    load.mass = utils::numeric(FLERR, arg[iarg + 2], false, lmp);
    if (!(load.mass > 0.0) || !std::isfinite(load.mass))
      error->all(FLERR_WORD(iarg + 2),
                 "Fix {} deformable/wall: the mass of a wall under a load must be positive and "
                 "finite, not {}",
                 id, arg[iarg + 2]);
  }
  return iarg + values + 1;
}

/* ----------------------------------------------------------------------
   As for a region: move v_x v_y v_z, with NULL for none, and
   rotate v_theta Px Py Pz Rx Ry Rz.
------------------------------------------------------------------------- */

void FixDeformableWall::read_ride(int iarg, char **arg)
{
  ride.is_given = true;
  if (!std::strcmp(arg[iarg], "move")) {
    for (int axis = 0; axis < 3; ++axis) {
      const char *const word = arg[iarg + 1 + axis];
      if (!std::strcmp(word, "NULL")) continue;
      require(ride.step[axis].read("move", word, lmp));
      if (axis == 2 && dimension == 2)
        error->all(FLERR_WORD(iarg + 3),
                   "Fix {} deformable/wall: in two dimensions nothing moves along z: use NULL, "
                   "not '{}'",
                   id, word);
    }
    return;
  }
  require(ride.angle.read("rotate", arg[iarg + 1], lmp));
  double value[6];
  for (int k = 0; k < 6; ++k) value[k] = utils::numeric(FLERR, arg[iarg + 2 + k], false, lmp);
  ride.point = {value[0], value[1], dimension == 2 ? 0.0 : value[2]};
  ride.axis = {value[3], value[4], value[5]};
  const double size = length(ride.axis);
  if (!(size > 0.0) || !std::isfinite(size) || !std::isfinite(length(ride.point)))
    error->all(FLERR_WORD(iarg), "Fix {} deformable/wall: rotate needs a point and an axis, not {}",
               id, utils::join_words({arg + iarg + 2, arg + iarg + 8}, " "));
  if (dimension == 2 && (value[3] != 0.0 || value[4] != 0.0))
    error->all(FLERR_WORD(iarg),
               "Fix {} deformable/wall: in two dimensions the axis of rotate is along z, 0 0 1",
               id);
  ride.axis = (1.0 / size) * ride.axis;
}

// What is not known yet has not begun.
Motion FixDeformableWall::ride_now() const
{
  const auto value = [](const WallVariable &v) { return v.is_known() ? v.now : 0.0; };
  Motion motion = {{}, value(ride.angle), ride.axis};
  motion.step = ride.point - motion.turned(ride.point) +
                Vector3{value(ride.step[0]), value(ride.step[1]), value(ride.step[2])};
  return motion;
}

/* ----------------------------------------------------------------------
   Whether the walls are such as can slide, bear a load, or ride.
------------------------------------------------------------------------- */

void FixDeformableWall::check_keywords(Walls &given) const
{
  if (load.mass > 0.0) {
    const bool one = given.walls.size() == 1 && given.sources[0].side.sign != 0;
    if (!one || given.sources[0].moves())
      error->all(
          FLERR,
          "Fix {} deformable/wall: load needs one side, such as zhi 20, with the number where "
          "it begins: give other walls fixes of their own",
          id);
    given.sources[0].side.is_loaded = true;
  }
  for (const Wall &wall : given.walls)
    if (ride.is_given && wall.kind != Wall::ROOM && wall.kind != Wall::SURFACE)
      error->all(FLERR,
                 "Fix {} deformable/wall: only a surface or a room has the keywords move and "
                 "rotate, not '{}': use a region that moves, or a side at a variable",
                 id, wall.name);
  for (const Wall &wall : given.walls) {
    if (shear.axis < 0) break;
    const bool straight = wall.kind == Wall::FACE;
    const Region *const its_region = given.sources[wall.shape].region;
    const Vector3 n = straight ? given.shapes[wall.shape].planes[wall.sides[0].plane].n : Vector3{};
    if (!straight || std::fabs(component(n, shear.axis)) > 1e-12 ||
        (its_region && its_region->rotateflag))
      error->all(FLERR,
                 "Fix {} deformable/wall: '{}' cannot slide along {}, as sides and planes along it "
                 "do: give it a fix of its own without shear, or a region that rotates",
                 id, wall.name, "xyz"[shear.axis]);
  }
}

// 'run ... pre no' would call this fix once more: the next run has its setup in any case.
FixDeformableWall::~FixDeformableWall()
{
  if (update) update->first_update = 0;
}

int FixDeformableWall::setmask()
{
  int mask = PRE_FORCE | MIN_PRE_FORCE | POST_FORCE | MIN_POST_FORCE;
  if (load.mass > 0.0) mask |= INITIAL_INTEGRATE | FINAL_INTEGRATE;
  if (!variables().empty()) mask |= END_OF_STEP;
  return mask;
}

void FixDeformableWall::init()
{
  refuse_respa(lmp, id, "deformable/wall");
  require_deformable_pairs(lmp, fmt::format("Fix {} deformable/wall", id));
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
  Walls found(dimension);
  require(found.read_region(region, 0.5 * (domain->boxlo[0] + domain->boxhi[0]),
                            0.5 * (domain->boxlo[1] + domain->boxhi[1])));
  take(std::move(found));
}

void FixDeformableWall::take(Walls &&found)
{
  check_keywords(found);
  found.moves = shear.axis >= 0 || ride.is_given;
  for (const WallSource &source : found.sources) found.moves |= source.moves();
  found.restore(walls.energy_given());
  walls = std::move(found);
  walls.ride = ride_now();
  require(walls.follow());
}

// A shrink-wrapped boundary follows the particles; others hold them up before they meet the wall. What is at a periodic side is on
// both sides of it.
void FixDeformableWall::warn_of_box() const
{
  enum { PERIODIC, FIXED };
  constexpr double ROUNDING = 1e-9;    // of the box
  const bool tilted[] = {domain->xy != 0.0 || domain->xz != 0.0, domain->yz != 0.0, false};
  for (int axis = 0; axis < dimension; ++axis) {
    if (tilted[axis]) continue;    // its sides are no planes across the axis
    const int *const kind = domain->boundary[axis];
    const double low = domain->boxlo[axis], high = domain->boxhi[axis];
    const double rest = ROUNDING * (high - low);
    const double from = kind[0] <= FIXED ? low - rest : -INFINITY,
                 to = kind[1] <= FIXED ? high + rest : INFINITY;
    const int wall = walls.first_outside(axis, from, to);
    const int end = walls.first_outside(axis, low + rest, high - rest);
    if (wall < 0 && end >= 0 && domain->periodicity[axis])
      error->warning(FLERR,
                     "Fix {} deformable/wall: '{}' lies at a side of the box that is periodic: "
                     "particles touch each other through it. Use a boundary f in {}",
                     id, walls.walls[end].name, "xyz"[axis]);
    if (wall < 0) continue;
    error->warning(FLERR,
                   "Fix {} deformable/wall: '{}' lies outside of the simulation box in {} ({:.6g} "
                   "to {:.6g}): particles leave the box before they meet it. Enlarge the box "
                   "(change_box), or use a boundary s or m",
                   id, walls.walls[wall].name, "xyz"[axis], low, high);
  }
}

void FixDeformableWall::require(const std::string &problem)
{
  if (!problem.empty()) error->all(FLERR, "Fix {} deformable/wall: {}", id, problem);
}

void FixDeformableWall::setup(int vflag)
{
  post_force(vflag);
  end_of_step();
  require(load.force.begin_step(lmp, false));
}

std::vector<WallVariable *> FixDeformableWall::variables()
{
  std::vector<WallVariable *> found = {&shear.speed,  &load.force,   &ride.step[0],
                                       &ride.step[1], &ride.step[2], &ride.angle};
  for (WallSource &source : walls.sources) found.push_back(&source.side.place);
  found.erase(std::remove_if(found.begin(), found.end(),
                             [](const WallVariable *variable) { return !variable->varies(); }),
              found.end());
  return found;
}

void FixDeformableWall::end_of_step()
{
  const std::vector<WallVariable *> all = variables();
  if (std::none_of(all.begin(), all.end(), [](const WallVariable *v) { return v->waits(); }))
    return;
  modify->clearstep_compute();
  for (WallVariable *variable : all) require(variable->end_step(lmp));
  modify->addstep_compute(update->ntimestep + 1);
}

// Minimizers need the wall from their first energy on.
void FixDeformableWall::check_places()
{
  for (const WallSource &source : walls.sources)
    if (source.side.sign != 0 && !source.side.place.is_known())
      error->all(FLERR,
                 "Fix {} deformable/wall: the place of {} depends on what computes, fixes or "
                 "thermo keywords find in a run: use 'run 0' before minimize",
                 id, source.name);
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

void FixDeformableWall::place(bool counts)
{
  wall_forces.assign(atom->nlocal, WallForce{});
  callers.clear();
  const bool tilted = domain->triclinic != 0;
  walls.period = {};
  if (domain->xperiodic) walls.period[0] = {domain->xprd, 0.0, 0.0};
  if (domain->yperiodic) walls.period[1] = {tilted ? domain->xy : 0.0, domain->yprd, 0.0};
  if (domain->zperiodic && dimension == 3)
    walls.period[2] = {tilted ? domain->xz : 0.0, tilted ? domain->yz : 0.0, domain->zprd};
  if (!walls.moves) return;
  require(walls.place_sides(lmp, counts));
  if (update->whichflag == 2) check_places();
  require(shear.speed.begin_step(lmp, counts));
  if (shear.axis >= 0) component(walls.slide, shear.axis) = shear.speed.now * update->dt;
  require(load.force.begin_step(lmp, counts));
  if (region) match_region();
  for (WallVariable *variable : {&ride.step[0], &ride.step[1], &ride.step[2], &ride.angle})
    require(variable->begin_step(lmp, counts));
  walls.ride = ride_now();
  require(walls.follow());
  walls.begin_step(counts);
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
  add(i, push,
      {n.x * a.x + b.x * n.x, n.y * a.y + b.y * n.y, n.z * a.z + b.z * n.z, n.x * a.y + b.x * n.y,
       n.x * a.z + b.x * n.z, n.y * a.z + b.y * n.z});
  if (walls.moves) walls.add_force(feature, center(i), force, beside, cutoff);
  return push;
}

void FixDeformableWall::post_force(int vflag)
{
  v_init(vflag);
  double *const *const f = atom->f;
  on_wall = {};
  for (int i = 0; i < static_cast<int>(wall_forces.size()); ++i) {
    WallForce &wall = wall_forces[i];
    // forces of opposite walls may cancel to the last bit
    const Vector3 &push = wall.force;
    if (push.x == 0.0 && push.y == 0.0 && push.z == 0.0 && wall.virial[0] == 0.0 &&
        wall.virial[1] == 0.0 && wall.virial[2] == 0.0)
      continue;
    f[i][0] += push.x;
    f[i][1] += push.y;
    f[i][2] += push.z;
    on_wall = on_wall - push;
    if (evflag) v_tally(i, wall.virial.data());
  }
  if (walls.moves) walls.end_step();
  if (load.mass > 0.0) load.pushed = compute_vector(walls.sources[0].side.axis);
}

/* ----------------------------------------------------------------------
   Energy that the particles have given to the moving wall in runs.
------------------------------------------------------------------------- */

double FixDeformableWall::compute_scalar()
{
  return sum_of_ranks(world, walls.energy_given());
}

/* ----------------------------------------------------------------------
   Force on the wall; place and velocity of one under a load.
------------------------------------------------------------------------- */

double FixDeformableWall::compute_vector(int n)
{
  if (n >= 3) return n == 3 ? walls.sources[0].side.place.now : load.v;
  return sum_of_ranks(world, component(on_wall, n));
}

/* ----------------------------------------------------------------------
   A wall under a load: m a = f - F along its axis, with the force f of the
   particles, by velocity Verlet as they are.
------------------------------------------------------------------------- */

// Half a step of the velocity.
void FixDeformableWall::kick()
{
  const int sign = walls.sources[0].side.sign;
  load.v += 0.5 * update->dt * force->ftm2v * (load.pushed - sign * load.force.now) / load.mass;
}

void FixDeformableWall::initial_integrate(int)
{
  kick();
  walls.sources[0].side.place.now += update->dt * load.v;
}

/* ----------------------------------------------------------------------
   Places of the sides that move by variables or a load; velocity; and the
   energy that particles have given.
------------------------------------------------------------------------- */

std::vector<double *> FixDeformableWall::moving_places()
{
  std::vector<double *> found;
  for (WallSource &source : walls.sources)
    if (source.side.is_loaded || source.side.place.varies())
      found.push_back(&source.side.place.now);
  for (WallVariable *variable : {&ride.step[0], &ride.step[1], &ride.step[2], &ride.angle})
    if (variable->varies()) found.push_back(&variable->now);
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
  walls.restore(comm->me == 0 ? list[3] : 0.0);
  list += 4;
  for (double *place : places) *place = *list++;
}

void FixDeformableWall::refuse_center(int i, double radius, const RefusedCenter &refused)
{
  const double *x = atom->x[i];
  const Wall &wall = walls.walls[refused.wall];
  const bool solid = wall.kind == Wall::DISK || wall.kind == Wall::POLYGON ||
                     wall.kind == Wall::SURFACE ||
                     (wall.kind == Wall::FACE && wall.sides[0].reversed);
  const std::string name = region_id.empty() ? "'" + wall.name + "'"
                           : wall.name == region_id
                               ? "region '" + region_id + "'"
                               : "part '" + wall.name + "' of region '" + region_id + "'";
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

double FixDeformableWall::memory_usage()
{
  return bytes_of(wall_forces) + walls.memory_usage();
}
