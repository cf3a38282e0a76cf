#include "styles/pair/pair_deformable_droplet.h"

#include "laws/droplet_film.h"
#include "laws/parameter_rules.h"
#include "styles/all_ranks.h"
#include "styles/lammps_release.h"
#include "styles/memory/fix_deformable_films.h"
#include "styles/refusals.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "group.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

using namespace LAMMPS_NS;
using namespace deformable;

// With 1e-8 slow motion of dense packings cools, by 0.15 % of the kinetic energy in 1e5 steps, with 3e-9 too. With 1e-9 it is a
// hundredth of that, as with 1e-10 and 1e-11, and a step takes up to 1.4 times as long. benchmarks/droplet_energy.py
static constexpr double TOLERANCE = 1e-9;

/* ----------------------------------------------------------------------
   After an error that the caller has caught all is as before.
------------------------------------------------------------------------- */

void PairDeformableDroplet::settings(int narg, char **arg)
{
  double given_reach = LARGEST_BULGE;
  bool by_atom = false;
  int threads = 0;
  Balance balance;
  balance.tolerance = TOLERANCE;
  for (int iarg = 0; iarg < narg;) {
    const std::string keyword = arg[iarg];
    const int values = keyword == "balance" ? 2 : 1;
    if (keyword != "balance" && keyword != "reach" && keyword != "radius" && keyword != "threads")
      error->all(FLERR_WORD(iarg),
                 "Unknown pair_style deformable/droplet keyword '{}': it must be 'balance', "
                 "'reach', 'radius' or 'threads'",
                 keyword);
    if (iarg + values >= narg)
      utils::missing_cmd_args(FLERR, "pair_style deformable/droplet " + keyword, error);
    if (keyword == "radius") {
      by_atom = is_by_atom(iarg + 1, arg);
    } else if (keyword == "threads") {
      threads = read_threads("deformable/droplet", arg[iarg + 1]);
    } else if (keyword == "reach") {
      given_reach = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
      if (!(given_reach > 0.0 && given_reach <= LARGEST_BULGE))
        error->all(FLERR_WORD(iarg + 1),
                   "pair_style deformable/droplet reach {} must be positive, and {} at most: no "
                   "droplet bulges farther",
                   arg[iarg + 1], LARGEST_BULGE);
    } else {
      balance = read_balance("deformable/droplet", iarg, arg);
    }
    iarg += 1 + values;
  }
  solver = std::make_unique<DropletSolver>(lmp, *kernels, balance.tolerance, balance.evaluations);
  solver->wanted_threads = threads;
  forget_films();
  number_definition();
  reach = given_reach;
  radius_by_atom = by_atom;
  whole_list = false;
}

void PairDeformableDroplet::check_species(const Species &s) const
{
  const std::string problem = invalid_for_droplets(s.stiffness, s.skin);
  if (!problem.empty()) error->all(FLERR, "Species {}: {}", s.name, problem);
}

void PairDeformableDroplet::coeff(int narg, char **arg)
{
  PairDeformable::coeff(narg, arg);
  find_films();
}

void PairDeformableDroplet::check_films(const std::vector<Species> &of_types,
                                        const Adhesions &of_pairs) const
{
  for (std::size_t i = 1; i < of_types.size(); ++i)
    for (std::size_t j = 1; j < of_types.size(); ++j) {
      const double w = of_pairs.between(static_cast<int>(i), static_cast<int>(j));
      if (w == 0.0) continue;
      const std::string problem = invalid_for_droplet_film(
          w, film_rise(of_types[i].stiffness.tension, of_types[j].stiffness.tension, w));
      if (!problem.empty())
        error->all(FLERR, "Species {} at species {}: {}", of_types[i].name, of_types[j].name,
                   problem);
    }
}

std::string PairDeformableDroplet::invalid_at_wall(double adhesion, int i) const
{
  const std::string problem = PairDeformable::invalid_at_wall(adhesion, i);
  if (!problem.empty()) return problem;
  return invalid_for_droplet_film(adhesion,
                                  film_side_of_wall(stiffness_of(i).tension, adhesion).rise);
}

void PairDeformableDroplet::init_style()
{
  PairDeformable::init_style();
  check_room();
  if (!atom->tag_enable)
    error->all(FLERR, "Pair style deformable/droplet needs atom IDs: use 'atom_modify id yes'");
  find_films();
}

/* ----------------------------------------------------------------------
   Of what fix adapt may change only tension and adhesion are not fixed by the
   theory.
------------------------------------------------------------------------- */

void *PairDeformableDroplet::extract(const char *name, int &dim)
{
  const bool is_adhesion = std::strcmp(name, "adhesion") == 0;
  if (!is_adhesion && std::strcmp(name, "tension") != 0) return PairDeformable::extract(name, dim);
  take_ramps();    // values that no force call has seen yet
  double **const array = is_adhesion ? adhesions.array() : ramps.array_of(name, species);
  if (!array) return PairDeformable::extract(name, dim);
  dim = 2;
  return array;
}

void PairDeformableDroplet::compute(int eflag, int vflag)
{
  const bool new_material = take_ramps(), new_list = neighbor->ago == 0;
  begin_call(eflag, vflag);
  if (films && (new_list || new_material)) refusals.check([this] { check_adhesive_walls(); });
  if (new_list) check_room();
  solve(new_material);
  if (eflag_atom || needs_shapes()) finish_droplets();
  if (comm->me == 0) {    // compute pair sums over ranks
    pvector[2] = solver->summary.evaluations;
    pvector[3] = solver->summary.imbalance;
    pvector[4] = static_cast<int>(solver->summary.termination);
    pvector[5] = films ? films->compute_scalar() : 0.0;
  }
  end_call();
}

/* ----------------------------------------------------------------------
   Where droplets have no room, contacts would be many, and mean nothing; far
   too many, LAMMPS finds no memory for its neighbor lists. Across a side that
   is not periodic a droplet reaches as far as it bulges.
------------------------------------------------------------------------- */

void PairDeformableDroplet::check_room()
{
  constexpr double LEAST_SIDE = 0.5;    // of a periodic box, over the radius
  double volume = 0.0, largest = 0.0;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (neighbor->includegroup && !(atom->mask[i] & group->bitmask[neighbor->includegroup]))
      continue;
    const Species &s = species[atom->type[i]];
    if (s.name.empty()) continue;    // of another style
    double r = s.radius;
    if (radius_by_atom) r = std::min(r, atom->radius[i]);
    volume += 4.0 * PI / 3.0 * r * r * r;
    largest = std::max(largest, r);
  }
  volume = sum_of_ranks(world, volume);
  largest = largest_of_ranks(world, largest);
  double room = 1.0;
  for (int axis = 0; axis < 3; ++axis)
    room *= domain->prd[axis] +
            (domain->periodicity[axis] ? 0.0 : 2.0 * (1.0 + LARGEST_BULGE) * largest);
  if (volume > room)
    error->all(FLERR,
               "The droplets have {:.4g} times the volume of their box, {:.6g} x {:.6g} x {:.6g}: "
               "as they keep their volumes, use a larger box, or fewer or smaller droplets",
               volume / (domain->xprd * domain->yprd * domain->zprd), domain->xprd, domain->yprd,
               domain->zprd);
  for (int axis = 0; axis < 3; ++axis)
    if (domain->periodicity[axis] && domain->prd[axis] < LEAST_SIDE * largest)
      error->all(FLERR,
                 "The periodic box is {:.6g} wide along {}, less than half of the largest radius, "
                 "{:.6g}: a droplet has its own images inside, use a larger box",
                 domain->prd[axis], "xyz"[axis], largest);
}

void PairDeformableDroplet::solve(bool new_material)
{
  ForceCall call = force_call();
  call.new_material = new_material;
  call.adhesions = &adhesions;
  call.films = films;
  const auto push_pairs = [this](int begin, int end, double part, bool is_final) {
    return push(begin, end, part, is_final);
  };
  if (!solver->solve(call, push_pairs)) {
    refusals.collect([&] {
      const int k = solver->refused_pair();
      if (k < 0) return;
      const int i = solver->pairs().i[k], j = solver->pairs().j[k];
      const double *const a = atom->x[i], *const b = atom->x[j];
      refuse_behind_center(i, j, b[0] - a[0], b[1] - a[1] + b[2] - a[2]);
    });
    refusals.stop();
  }
  if (films && update->whichflag == 1 && !update->setupflag)
    films->lose(solver->summary.lost_energy);
  if (rubbing) load_contacts();
  if (eflag_global || neighbor->ago == 0) beyond_model = solver->beyond_model();
  if (neighbor->ago == 0)
    bulge_over_reach = std::max(bulge_over_reach, solver->largest_bulge / reach);
  impossible = 0.0;
  if (!eflag_global) return;
  const double of_overlaps = solver->pushed_energy;
  eng_vdwl += of_overlaps;
  for (int ii = 0; ii < list->inum; ++ii) eng_vdwl -= solver->work(list->ilist[ii]);
  if (update->whichflag == 1 && !films) check_energy(of_overlaps);
  if (solver->is_meaningless()) eng_vdwl = HUGE_VAL;
}

/* ----------------------------------------------------------------------
   Spheres have the least surface. Forces that are off by more than themselves
   may have less energy, and would push anything anywhere. Minimizers go on; a
   Monte Carlo move to such a place has no chance.
------------------------------------------------------------------------- */

void PairDeformableDroplet::check_energy(double of_overlaps)
{
  // of the energy of the overlaps, and of that of the surfaces, which is the larger one where droplets hardly touch
  constexpr double ROUNDING = 1e-9, OF_SURFACES = 1e-20;
  const double energy = sum_of_ranks(world, eng_vdwl);
  if (!(energy < 0.0)) return;
  if (energy > -ROUNDING * std::fabs(sum_of_ranks(world, of_overlaps))) return;
  double surfaces = 0.0;
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    surfaces += stiffness_of(i).tension * radii[i] * radii[i];
  }
  if (energy > -OF_SURFACES * sum_of_ranks(world, surfaces)) return;
  impossible = energy;
  eng_vdwl = HUGE_VAL;
}

void PairDeformableDroplet::check_state() const
{
  solver->check_balance("deformable/droplet");
  if (impossible < 0.0)
    error->all(
        FLERR,
        "The energy of the droplets is {:.6g}, but no shapes have less than spheres, 0: they "
        "overlap so far that their forces do not balance. Use 'minimize' before, a smaller "
        "timestep, or a larger box",
        impossible);
}

/* ----------------------------------------------------------------------
   The force F along the line of centers, and dW/dn over the distance across
   it, of both droplets. Of a pair that two ranks share each adds the part of
   its own droplet, and half of F.
------------------------------------------------------------------------- */

double PairDeformableDroplet::push(int begin, int end, double part, bool is_final)
{
  const NearPairs &p = solver->pairs();
  double *const pushes = solver->pushes.data();
  double energy = 0.0;
  for (int k = begin; k < end; ++k) {
    const double whole = p.force[k], force = part * whole;
    if (k < p.wall) std::fill_n(pushes + 3 * k, 3, 0.0);
    if (force == 0.0) continue;
    const int i = p.i[k], j = p.j[k];
    if (is_final) energy += p.part(k) * whole * p.overlap[k];
    if (k >= p.wall) {    // which bears no energy of its own
      wall(j).add_contact(i, wall_feature_of(j), force, part * torque(k, 0), p.surfaces[k - p.wall],
                          (1.0 + reach) * radii[i]);
      continue;
    }
    const Vector3 n = p.normal(k);
    Vector3 turning = torque(k, 0);
    if (k < p.remote) turning = turning - torque(k, 1);
    const Vector3 push = -(p.part(k) * force * n + part * p.per_distance[k] * turning);    // on i
    pushes[3 * k] = push.x;
    pushes[3 * k + 1] = push.y;
    pushes[3 * k + 2] = push.z;
    if (vflag_either) {
      const Vector3 d = (1.0 / p.per_distance[k]) * n;
      ev_tally_xyz(i, j, atom->nlocal, 1, 0.0, 0.0, push.x, push.y, push.z, -d.x, -d.y, -d.z);
    }
  }
  return energy;
}

double PairDeformableDroplet::memory_usage()
{
  return PairDeformable::memory_usage() + solver->memory_usage();
}

double PairDeformableDroplet::energy_alone(int i, int partner, double force) const
{
  const double r = radii[i], tension = stiffness_of(i).tension;
  const double ratio =
      partner < 0 ? 1.0 : film_ratio(r, tension, radii[partner], stiffness_of(partner).tension);
  const double energy = droplet_energy_alone(force / (r * tension), std::log(ratio));
  return energy * r * r * tension;
}

/* ----------------------------------------------------------------------
   What is asked for of droplets and their contacts.
------------------------------------------------------------------------- */

void PairDeformableDroplet::finish_droplets()
{
  const NearPairs &p = solver->pairs();
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    double energy = -solver->work(i), rest = 0.0;
    for (int n = 0; n < solver->contacts_of(i); ++n) {
      const int c = solver->place_of_contact(i, n);
      const int k = solver->pair_side(c) >> 1;
      energy += p.force[k] * solver->indentation(c);
      // more precise than solver->residual_overlap(k)
      const double left =
          p.overlap[k] - solver->indentation(p.side[0][k]) - solver->indentation(p.side[1][k]);
      rest += (k < p.wall ? 0.5 : 1.0) * p.force[k] * left;
    }
    if (eflag_atom) eatom[i] += energy + rest;
    if (needs_shapes()) store_droplet(i, energy);
  }
}

void PairDeformableDroplet::store_droplet(int i, double energy)
{
  if (!results.requested) return;
  const NearPairs &p = solver->pairs();
  const double r = radii[i], tension = stiffness_of(i).tension;
  double moment = 0.0, area = 0.0, more = 0.0;
  int contacts = 0;
  for (int n = 0; n < solver->contacts_of(i); ++n) {
    const int c = solver->place_of_contact(i, n);
    const int k = solver->pair_side(c) >> 1;
    if (!solver->bears(k)) continue;
    const double force = p.force[k], facet = facet_of(k, i), film = PI * facet * facet;
    moment += force * (r - solver->indentation(c));
    area += film;
    more += solver->film_rise(c) * film;
    ++contacts;
  }
  // films count in the energy with the cosine of their contact angle
  results.store_surface(i, {4.0 * PI * r * r + energy / tension + more, contacts,
                            droplet_pressure(r, tension, energy, moment), area, solver->load(i)});
}

// The radius of the facet of pair k on droplet i. Where nothing sticks the two facets of a pair have unlike areas, F R/(2 g), if its
// droplets have unlike pressures.
double PairDeformableDroplet::facet_of(int k, int i) const
{
  return films ? solver->film_radius(k)
               : facet_radius(solver->pairs().force[k], radii[i], stiffness_of(i).tension);
}

void PairDeformableDroplet::load_contacts()
{
  const NearPairs &p = solver->pairs();
  const auto area = [&](int k, int i) {
    const double facet = facet_of(k, i);
    return PI * facet * facet;
  };
  for (int k = 0; k < p.size; ++k) {
    if (!solver->bears(k)) continue;
    const int i = p.i[k], j = p.j[k];
    const bool is_wall = k >= p.wall;
    loaded.push_back({i, j, is_wall ? -1 : p.second(k), p.normal(k),
                      (radii[i] - solver->indentation(p.side[0][k])) * p.normal(k), p.force[k],
                      is_wall ? area(k, i) : 0.5 * (area(k, i) + area(k, j)), false});
  }
}

// On the droplet, from its own energy; from a wall all of it.
Vector3 PairDeformableDroplet::force_of_contact(int k, int side) const
{
  const NearPairs &p = solver->pairs();
  if (k >= p.wall) {
    const SurfacePoint &point = p.surfaces[k - p.wall];
    return -p.force[k] * point.n - point.turned(torque(k, 0));
  }
  const double along = (side ? 0.5 : -0.5) * p.force[k];
  return along * p.normal(k) - p.per_distance[k] * torque(k, side);
}

// By the difference of pressures, 2 g/R each, over the tension of the film: positive where it is convex for the first droplet.
double PairDeformableDroplet::film_curvature(int i, int j) const
{
  const double gi = stiffness_of(i).tension, gj = stiffness_of(j).tension;
  return (gi / radii[i] - gj / radii[j]) / (gi + gj);
}

/* ----------------------------------------------------------------------
   One row for each side of a contact: the particle, its partner, indentation,
   radius of the facet, force, its middle, its normal, distance of the centers
   or of the wall, the force on the particle from its own energy, the turn of
   the normal, the curvature of the film, the angle at which the surface meets
   a film that sticks, and whether there is one.
------------------------------------------------------------------------- */

void PairDeformableDroplet::list_contacts(int groupbit, std::vector<double> &rows) const
{
  const NearPairs &p = solver->pairs();
  if (p.size == 0) return;    // there may be no neighbor list yet
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    if (!(atom->mask[i] & groupbit)) continue;
    for (int m = 0; m < solver->contacts_of(i); ++m) {
      const int c = solver->place_of_contact(i, m);
      const int k = solver->pair_side(c) >> 1, side = solver->pair_side(c) & 1,
                other = side ? p.i[k] : p.j[k];
      const double force = p.force[k], sign = side ? -1.0 : 1.0;
      if (!solver->bears(k)) continue;
      const Vector3 n = sign * p.normal(k), push = force_of_contact(k, side),
                    at = Vector3{atom->x[i][0], atom->x[i][1], atom->x[i][2]} +
                         (radii[i] - solver->indentation(c)) * n;
      const Vector3 tilt = sign * solver->tilt(k);
      const double distance = k >= p.wall ? p.surfaces[k - p.wall].height : 1.0 / p.per_distance[k];
      const tagint partner = k >= p.wall ? wall_code(wall_of(p.j[k]), 0) : atom->tag[other];
      double angle = 0.0, attached = 0.0;
      if (solver->is_attached(k)) {
        angle = std::acos(1.0 - solver->film_rise(c));
        attached = k >= p.wall ? p.j[k] : 1.0;
      }
      rows.insert(rows.end(), {static_cast<double>(atom->tag[i]), static_cast<double>(partner),
                               solver->indentation(c), facet_of(k, i), force, at.x, at.y, at.z, n.x,
                               n.y, n.z, distance, push.x, push.y, push.z, tilt.x, tilt.y, tilt.z,
                               k >= p.wall ? 0.0 : film_curvature(i, other)});
      rows.insert(rows.end(), {angle, attached});
    }
  }
}
