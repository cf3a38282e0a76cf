#include "styles/motion/fix_deformable_propel.h"

#include "laws/vector3.h"
#include "styles/lammps_release.h"
#include "styles/motion/drawn_directions.h"
#include "styles/pair/pair_deformable.h"
#include "styles/refusals.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

using namespace LAMMPS_NS;
using namespace deformable;
using namespace FixConst;

namespace {

// How directions in space diffuse in a time step: n turns toward any side by Fisher's density, with
//   <cos(theta)> = coth(kappa) - 1/kappa = exp(-dt/tau),
// so that <n(t).n(0)> is that of diffusion for any dt. <(3 (n(t).n(0))^2 - 1)/2> decays at its rate 3/tau to the
// order (dt/tau)^2. Returns kappa.
double concentration_of(double persisted)
{
  const double less = -std::expm1(-persisted), c = 1.0 - less;
  double kappa = std::max(c * (3.0 - c * c) / (less * (1.0 + c)), 1e-8);    // to a few per cent
  if (kappa > 50.0) return 1.0 / less;                                      // coth = 1
  constexpr int STEPS = 6;    // of Newton's method; four are enough
  constexpr double SMALL = 1e-2;
  for (int n = 0; n < STEPS && kappa > SMALL; ++n) {
    const double over = 1.0 / kappa, rise = 1.0 / std::sinh(kappa);
    kappa += (c - 1.0 / std::tanh(kappa) + over) / (over * over - rise * rise);
  }
  return kappa;
}

// The unit vector n after a time x/|h| in the field h, of dn/dt = (n x h) x n: the tangent of half of its angle to h decays by
// exp(-x). It is a boost of n along h,
//   n' = (n + (sinh x + (cosh x - 1) n.e) e)/(cosh x + sinh x n.e),   e = h/|h|
Vector3 turned_toward(const Vector3 &e, double x, const Vector3 &n)
{
  x = std::min(x, 50.0);    // it has turned all the way
  const double c = dot(n, e), cosh = std::cosh(x), sinh = std::sinh(x);
  const Vector3 along = n + (sinh + (cosh - 1.0) * c) * e;
  return (1.0 / length(along)) * along;
}

}    // namespace

FixDeformablePropel::FixDeformablePropel(LAMMPS *lmp, int narg, char **arg)
    : FixMemory(lmp, narg, arg, STYLE)
{
  if (narg < 6) utils::missing_cmd_args(FLERR, "fix deformable/propel", error);
  strength = utils::numeric(FLERR, arg[3], false, lmp);
  if (!(strength > 0.0))
    error->all(FLERR_WORD(3), "Fix deformable/propel: f is '{}': it must be positive", arg[3]);
  const bool stay = !std::strcmp(arg[4], "inf");    // which LAMMPS does not take for a number
  persistence = stay ? HUGE_VAL : utils::numeric(FLERR, arg[4], false, lmp);
  if (!(persistence > 0.0))
    error->all(FLERR_WORD(4), "Fix deformable/propel: tau is '{}': it must be positive", arg[4]);
  const int number = utils::inumeric(FLERR, arg[5], false, lmp);
  if (number < 0)
    error->all(FLERR_WORD(5), "Fix deformable/propel: the seed is '{}': it must not be negative",
               arg[5]);
  seed = static_cast<std::uint64_t>(number);
  for (int iarg = 6; iarg < narg;) {
    const std::string keyword = arg[iarg];
    double *const rate = keyword == "velocity"    ? &of_velocity
                         : keyword == "neighbors" ? &of_neighbors
                         : keyword == "free"      ? &of_free
                                                  : nullptr;
    if (!rate)
      error->all(FLERR_WORD(iarg),
                 "Unknown fix deformable/propel keyword '{}': it must be 'velocity', 'neighbors' "
                 "or 'free'",
                 keyword);
    const int values = keyword == "neighbors" ? 2 : 1;
    if (iarg + values >= narg)
      utils::missing_cmd_args(FLERR, "fix deformable/propel " + keyword, error);
    *rate = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
    if (keyword == "neighbors") {
      by_contact = !std::strcmp(arg[iarg + 2], "contact");
      distance = by_contact ? 0.0 : utils::numeric(FLERR, arg[iarg + 2], false, lmp);
      if (!by_contact && !(distance > 0.0))
        error->all(FLERR_WORD(iarg + 2),
                   "Fix deformable/propel: the distance of neighbors is '{}': it must be positive, "
                   "or 'contact'",
                   arg[iarg + 2]);
    }
    iarg += 1 + values;
  }
  if (of_neighbors == 0.0) by_contact = false;
  if (of_neighbors != 0.0) comm_forward = domain->dimension;
  if (!atom->tag_enable)
    error->all(FLERR,
               "Fix {} deformable/propel needs atom IDs, without which no random number "
               "belongs to an atom: use 'atom_modify id yes'",
               id);

  peratom_flag = 1;
  size_peratom_cols = columns = domain->dimension;
  peratom_freq = 1;
  dynamic_group_allow = 1;
  begin();
  for (int i = 0; i < atom->nlocal; ++i) direction_of(i);
}

int FixDeformablePropel::setmask()
{
  return POST_FORCE;
}

void FixDeformablePropel::init()
{
  refuse_respa(lmp, id, "deformable/propel");
  if (needs_contacts())
    pairs = require_deformable_pairs(lmp, fmt::format("Fix {} deformable/propel", id));
  if (of_neighbors == 0.0 || by_contact) return;
  if (comm->mode != Comm::SINGLE)
    error->all(
        FLERR,
        "Fix {} deformable/propel: neighbors within a distance need 'comm_modify mode single'", id);
  comm->cutghostuser = std::max(comm->cutghostuser, distance + neighbor->skin);
  neighbor->add_request(this, NeighConst::REQ_FULL)->set_cutoff(distance);
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
  push(update->dt);
}

/* ----------------------------------------------------------------------
   Align, turn for this time over tau, then push. In the plane the angle
   changes by a normal deviate.
------------------------------------------------------------------------- */

void FixDeformablePropel::push(double dt)
{
  if (dt > 0.0 && aligns()) align(dt);
  const bool in_space = columns == 3;
  const double persisted = dt / persistence, angle_per_deviation = std::sqrt(2.0 * persisted);
  const double kappa = in_space && persisted > 0.0 ? concentration_of(persisted) : 0.0;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    double *const n = direction_of(i);
    if (persisted > 0.0) {
      CountedRandom random(seed, atom->tag[i], update->ntimestep);
      if (in_space) {
        const Vector3 now = drawn_in_space({n[0], n[1], n[2]}, kappa, random);
        std::copy_n(&now.x, 3, n);
      } else {
        const double angle = std::atan2(n[1], n[0]) + angle_per_deviation * random.gaussian();
        n[0] = std::cos(angle);
        n[1] = std::sin(angle);
      }
    }
    for (int k = 0; k < columns; ++k) atom->f[i][k] += strength * n[k];
  }
}

/* ----------------------------------------------------------------------
   Directions turn in the fields
     h = k_v v/|v| + k_n <n_j> - k_f sum_c n_c
   at the end of the step but for the directions, which are those of all at its
   begin: then no order of particles matters.
------------------------------------------------------------------------- */

void FixDeformablePropel::align(double dt)
{
  const int nlocal = atom->nlocal, *const mask = atom->mask;
  fields.assign(nlocal, {});
  for (int i = 0; i < nlocal; ++i)
    if (mask[i] & groupbit) direction_of(i);
  if (of_neighbors != 0.0) {
    comm->forward_comm(this);
    sums.assign(nlocal, {});
    numbers.assign(nlocal, 0);
    if (!by_contact) add_near();
  }
  if (needs_contacts()) add_contacts();
  for (int i = 0; i < nlocal; ++i) {
    if (!(mask[i] & groupbit)) continue;
    Vector3 h = fields[i];
    if (of_velocity != 0.0) {
      const double *const v = atom->v[i];
      const Vector3 moved = {v[0], v[1], columns == 3 ? v[2] : 0.0};
      const double speed = length(moved);
      if (speed > 0.0) h = h + (of_velocity / speed) * moved;
    }
    if (of_neighbors != 0.0 && numbers[i] > 0) h = h + (of_neighbors / numbers[i]) * sums[i];
    const double strongest = length(h);
    if (!(strongest > 0.0)) continue;
    const Vector3 now = turned_toward(h / strongest, strongest * dt, direction(i));
    std::copy_n(&now.x, columns, of(i));
  }
}

void FixDeformablePropel::add_neighbor(int i, int j)
{
  if (!(atom->mask[i] & groupbit) || !(atom->mask[j] & groupbit)) return;
  sums[i] = sums[i] + direction(j);
  ++numbers[i];
}

void FixDeformablePropel::add_near()
{
  const double *const *const x = atom->x;
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii], *const neighbors = list->firstneigh[i];
    for (int jj = 0; jj < list->numneigh[i]; ++jj) {
      const int j = neighbors[jj] & NEIGHMASK;
      const Vector3 r = {x[j][0] - x[i][0], x[j][1] - x[i][1], x[j][2] - x[i][2]};
      if (dot(r, r) < distance * distance) add_neighbor(i, j);
    }
  }
}

// A contact between two ranks is on both. One with two rows has a row for each side.
void FixDeformablePropel::add_contacts()
{
  for (const PairDeformable *pair : pairs)
    for (const LoadedContact &c : pair->loaded) {
      const int other = c.one_side ? -1 : c.owned;
      fields[c.i] = fields[c.i] - of_free * c.n;
      if (other >= 0) fields[other] = fields[other] + of_free * c.n;
      if (!by_contact || c.j < 0) continue;
      add_neighbor(c.i, c.j);
      if (other >= 0) add_neighbor(other, c.i);
    }
}

int FixDeformablePropel::pack_forward_comm(int n, int *list, double *buffer, int, int *)
{
  for (int k = 0; k < n; ++k) buffer = std::copy_n(of(list[k]), columns, buffer);
  return n * columns;
}

void FixDeformablePropel::unpack_forward_comm(int n, int first, double *buffer)
{
  for (int k = 0; k < n; ++k) std::copy_n(buffer + k * columns, columns, of(first + k));
}

/* ----------------------------------------------------------------------
   A particle that is new gets one, which depends on its ID alone.
------------------------------------------------------------------------- */

double *FixDeformablePropel::direction_of(int i)
{
  double *const n = of(i);
  if (std::any_of(n, n + columns, [](double component) { return component != 0.0; })) return n;
  CountedRandom random(seed, atom->tag[i], ~std::uint64_t{0});
  const double angle = 2.0 * PI * random.uniform();
  const double height = columns == 3 ? 2.0 * random.uniform() - 1.0 : 0.0;
  const double out = std::sqrt(1.0 - height * height);
  const double first[] = {out * std::cos(angle), out * std::sin(angle), height};
  std::copy_n(first, columns, n);
  return n;
}

Vector3 FixDeformablePropel::direction(int i)
{
  const double *const n = of(i);
  return {n[0], n[1], columns == 3 ? n[2] : 0.0};
}

double FixDeformablePropel::memory_usage()
{
  return FixMemory::memory_usage() + bytes_of(rows, fields, sums, numbers);
}

// For the output of each particle.
void FixDeformablePropel::grow_arrays(int size)
{
  FixMemory::grow_arrays(size);
  rows.resize(size);
  for (int i = 0; i < size; ++i) rows[i] = of(i);
  array_atom = rows.data();
}
