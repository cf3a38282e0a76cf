#include "styles/pair/pair_deformable_ring.h"

#include "laws/contact.h"
#include "laws/parameter_rules.h"
#include "laws/support.h"
#include "styles/all_ranks.h"
#include "styles/lammps_release.h"
#include "styles/refusals.h"

#include "comm.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <string>

using namespace LAMMPS_NS;
using namespace deformable;

// A ring of constant perimeter, even pressed flat, bulges by (pi/2 - 1) R. Far more than this is not an outline,
// and its candidates overflow the neighbor list.
static constexpr double LARGEST_REACH = 3.0;

/* ----------------------------------------------------------------------
   After an error that the caller has caught all is as before.
------------------------------------------------------------------------- */

void PairDeformableRing::settings(int narg, char **arg)
{
  struct {
    bool radius = false, kA = false, tension = false;
  } of_atoms;
  double given_reach = 0.0;
  std::string law = "balanced";
  int balance_keyword = -1, threads = 0;
  Balance balance;
  for (int iarg = 0; iarg < narg;) {
    const std::string keyword = arg[iarg];
    const int values = keyword == "balance" ? 2 : 1;
    bool *const by_atom = keyword == "radius"    ? &of_atoms.radius
                          : keyword == "kA"      ? &of_atoms.kA
                          : keyword == "tension" ? &of_atoms.tension
                                                 : nullptr;
    if (keyword != "contact" && keyword != "balance" && keyword != "reach" &&
        keyword != "threads" && !by_atom)
      error->all(FLERR_WORD(iarg),
                 "Unknown pair_style deformable/ring keyword '{}': it must be 'contact', "
                 "'balance', 'reach', 'radius', 'kA', 'tension' or 'threads'",
                 keyword);
    if (iarg + values >= narg)
      utils::missing_cmd_args(FLERR, "pair_style deformable/ring " + keyword, error);
    if (keyword == "contact") {
      law = arg[iarg + 1];
      if (law != "radical" && law != "balanced" && law != "curved")
        error->all(
            FLERR_WORD(iarg + 1),
            "pair_style deformable/ring contact '{}' is not 'balanced', 'curved' or 'radical'",
            law);
    } else if (keyword == "balance") {
      balance_keyword = iarg;
      balance = read_balance("deformable/ring", iarg, arg);
    } else if (keyword == "threads") {
      threads = read_threads("deformable/ring", arg[iarg + 1]);
    } else if (by_atom) {
      *by_atom = is_by_atom(iarg + 1, arg);
    } else {
      given_reach = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
      if (!(given_reach > 0.0))
        error->all(FLERR_WORD(iarg + 1), "pair_style deformable/ring reach {} must be positive",
                   arg[iarg + 1]);
      if (given_reach > LARGEST_REACH)
        error->all(FLERR_WORD(iarg + 1),
                   "pair_style deformable/ring reach {} must be {} at most: no outline bulges "
                   "farther",
                   arg[iarg + 1], LARGEST_REACH);
    }
    iarg += 1 + values;
  }
  const bool radical = law == "radical";
  if (radical && balance_keyword >= 0)
    error->all(FLERR_WORD(balance_keyword),
               "pair_style deformable/ring balance is for 'contact balanced' and 'curved' only");
  if (radical && threads > 0)
    error->all(FLERR,
               "pair_style deformable/ring threads is for 'contact balanced' and 'curved' only");
  balanced.reset(radical ? nullptr
                         : new RingSolver(lmp, kernels->forces, law == "curved", balance.tolerance,
                                          balance.evaluations));
  if (balanced) balanced->wanted_threads = threads;
  number_definition();
  radius_by_atom = of_atoms.radius;
  kA_by_atom = of_atoms.kA;
  tension_by_atom = of_atoms.tension;
  // a larger reach costs nothing where a list of near pairs filters
  reach = given_reach > 0.0 ? given_reach : radical ? 0.3 : 0.6;
  forget_films();
  whole_list = radical;
}

std::string PairDeformableRing::law() const
{
  const char *const contact = !balanced                  ? "radical"
                              : balanced->pairs().curved ? "curved"
                                                         : "balanced";
  return fmt::format("deformable/ring contact {}{}{}", contact, kA_by_atom ? " kA atom" : "",
                     tension_by_atom ? " tension atom" : "");
}

void PairDeformableRing::init_style()
{
  PairDeformable::init_style();
  soft_since = NEVER;
  find_properties();
  if (balanced && !atom->tag_enable)
    error->all(FLERR, "Pair style deformable/ring needs atom IDs: use 'atom_modify id yes', or "
                      "'contact radical'");
  find_films();
}

void PairDeformableRing::coeff(int narg, char **arg)
{
  PairDeformable::coeff(narg, arg);
  if (bends_lines()) find_films();
}

void *PairDeformableRing::extract(const char *name, int &dim)
{
  if ((kA_by_atom && !strcmp(name, "kA")) || (tension_by_atom && !strcmp(name, "tension")))
    return PairDeformable::extract(name, dim);    // those of species have no effect
  take_ramps();                                   // values that no force call has seen yet
  double **const array =
      !strcmp(name, "adhesion") ? adhesions.array() : ramps.array_of(name, species);
  if (!array) return PairDeformable::extract(name, dim);
  dim = 2;
  return array;
}

void PairDeformableRing::compute(int eflag, int vflag)
{
  const bool ramped = take_ramps(), new_material = choose_yield() || ramped;
  materials.kA = kA_by_atom ? atom->dvector[kA_of_atoms] : nullptr;
  materials.tension = tension_by_atom ? atom->dvector[tension_of_atoms] : nullptr;
  begin_call(eflag, vflag);
  if (materials.vary()) refusals.check([this] { check_properties(); });
  if (films && (neighbor->ago == 0 || new_material || materials.vary()))
    refusals.check([this] { check_adhesive_walls(); });
  if (balanced)
    evaluate_balanced(new_material);
  else
    refusals.collect([this] { evaluate_radical(); });
  end_call();
  tell_room();
}

void PairDeformableRing::evaluate_radical()
{
  blocks.for_each(
      kernels->ring, [](BlockParticle &) {}, ring_group,
      [this](BlockParticle &p, const Contacts &contacts) {
        Energy energy = shape_ring(p.name, contacts, stiffness_of(p.name));
        if (!std::isfinite(energy.derivative)) energy = shape_without_room(p.name, contacts);
        p.pressure = energy.derivative;
        return energy;
      },
      [this](const BlockParticle &p) {
        giving_way += p.stiffness.gives_way(p.pressure);
        if (neighbor->ago != 0 || p.energy == 0.0) return;
        blocks.load_shape(p);
        const Contacts contacts = load_contacts(blocks.block, p);
        if (is_within_reach(p.name, contacts)) return;
        const Place &place = blocks.block.places[p.first + deepest(contacts)];
        refuse_bulge(p.name, contacts, blocks.partner_of(place));
      });
}

Energy PairDeformableRing::shape_ring(int i, const Contacts &contacts, const Stiffness &stiffness)
{
  is_active.assign(contacts.size, 0);
  Energy energy;
  soft_ring_shape(ring_radius_of(i), stiffness, contacts, is_active.data(), lcp, shape, energy);
  return energy;
}

/* ----------------------------------------------------------------------
   The outline bulges out of the undeformed circle and expands as a whole. The
   lines of all particles and walls within the cutoff are known; any other
   line is at least `depth` outside of the circle. The nearest unknown
   lines belong to the smallest particles.
------------------------------------------------------------------------- */

double PairDeformableRing::depth_of_reach(int i) const
{
  const double r = radii[i], cutoff = (1.0 + reach) * (r + smallest);
  return std::min(reach * r, -contact_line(cutoff, 1.0 / cutoff, r, smallest).indentation);
}

bool PairDeformableRing::is_within_reach(int i, const Contacts &contacts)
{
  const double depth = depth_of_reach(i), expansion = shape.perimeter_excess / (2.0 * PI);
  if (expansion + ring_bulge_at_most(contacts, shape) <= bulge_over_reach * depth) return true;
  const double ratio = (expansion + ring_bulge(ring_radius_of(i), contacts, shape)) / depth;
  if (ratio > 1.0) return false;
  if (ratio > bulge_over_reach) bulge_over_reach = ratio;
  return true;
}

int PairDeformableRing::deepest(const Contacts &contacts)
{
  int deepest = 0;
  for (int c = 1; c < contacts.size; ++c)
    if (contacts[c].indentation > contacts[deepest].indentation) deepest = c;
  return deepest;
}

// partner: of the deepest contact
void PairDeformableRing::refuse_bulge(int i, const Contacts &contacts, int partner)
{
  const double depth = depth_of_reach(i), expansion = shape.perimeter_excess / (2.0 * PI);
  const double ratio = (expansion + ring_bulge(ring_radius_of(i), contacts, shape)) / depth;
  const std::string cause =
      partner >= 0
          ? "separate particles that overlap first"
          : fmt::format(
                "a wall of fix {} cuts it {:.4g} from its center, whose radius is {:.4g}: move "
                "one of them",
                wall(partner).id, radii[i] - contacts[deepest(contacts)].indentation, radii[i]);
  const double needed = 1.2 * ratio * reach;
  const std::string larger =
      needed <= LARGEST_REACH ? fmt::format(" or use a reach of {:.2g} or more", needed) : "";
  const char *const slower = update->whichflag == 1 ? ", slower particles or stiffer ones" : "";
  refuse("The outline of atom {} bulges by {:.6g}, but 'reach {}' covers {:.6g}: {}, take "
         "smaller steps or a smaller timestep{}{}{}",
         atom->tag[i], ratio * depth, reach, depth, cause, slower, larger.empty() ? "" : ",",
         larger);
}

void PairDeformableRing::check_state() const
{
  if (balanced) balanced->check_balance("deformable/ring");
}

double PairDeformableRing::memory_usage()
{
  return PairDeformable::memory_usage() + blocks.bytes() +
         (balanced ? balanced->memory_usage() : 0.0);
}

double PairDeformableRing::energy_alone(int i, int /*partner*/, double force) const
{
  const double r = ring_radius_of(i);
  const Stiffness k = stiffness_of(i);
  const RingLoad load = {0.5 * GREEN_AT_ZERO * force * force, force};
  LoadedRing ring;
  return find_pressure(r, k, load, ring) ? ring.energy(r, k, load.work) : 0.0;
}

/* ----------------------------------------------------------------------
   Forces and results of balanced contacts.
------------------------------------------------------------------------- */

void PairDeformableRing::evaluate_balanced(bool new_material)
{
  ForceCall call = force_call();
  call.new_material = new_material;
  call.adhesions = &adhesions;
  call.films = films;
  const auto push = [this](int begin, int end, double part, bool is_final) {
    return push_pairs(begin, end, part, is_final);
  };
  bool goes_on = balanced->solve(call, push);
  if (balanced->lacks_room() && materials.yield == 0.0 && may_give_way()) {
    begin_to_give_way();
    balanced->forget();
    call.new_list = false;
    call.new_material = true;
    goes_on = balanced->solve(call, push);
  }
  if (balanced->lacks_room()) {
    const int crushed = balanced->without_room();
    const int contacts_of_it = crushed < 0 ? 0 : balanced->ring(crushed).contacts;
    balanced->forget();
    refusals.collect([&] {
      if (crushed >= 0) no_shape(crushed, contacts_of_it);
    });
    refusals.stop();
  }
  if (!goes_on) {
    refusals.collect([this] { refuse_pair(balanced->refused_pair()); });
    refusals.stop();
  }
  if (films && update->whichflag == 1 && !update->setupflag)
    films->lose(balanced->summary.lost_energy);
  if (rubbing) load_contacts_of_pairs();
  pvector[4] = balanced->limited_lines();
  giving_way = materials.yield > 0.0 ? balanced->giving_way() : 0;
  // a Monte Carlo move to such a place has no chance
  if (eflag_global)
    eng_vdwl +=
        balanced->is_meaningless() ? HUGE_VAL : balanced->pushed_energy + balanced->energy();
  refusals.collect([this] {
    if (balanced->is_meaningless()) return;    // check_state tells
    if (eflag_atom || needs_shapes() || neighbor->ago == 0)
      for (int ii = 0; ii < list->inum; ++ii) finish_balanced(list->ilist[ii]);
    else
      for (const int i : balanced->crowded_rings()) finish_balanced(i);
  });
  if (comm->me != 0) return;    // compute pair sums over ranks
  pvector[5] = films ? films->compute_scalar() : 0.0;
  pvector[2] = balanced->summary.evaluations;
  pvector[3] = balanced->summary.imbalance;
  pvector[7] = static_cast<int>(balanced->summary.termination);
}

// The line lies behind the smaller one.
void PairDeformableRing::refuse_pair(int k)
{
  if (k < 0) return;
  int i = balanced->pairs().i[k], j = balanced->pairs().j[k];
  if (radii[i] > radii[j]) std::swap(i, j);
  const double *const *const x = atom->x;
  refuse_behind_center(i, j, x[j][0] - x[i][0], x[j][1] - x[i][1]);
}

/* ----------------------------------------------------------------------
   The force on the first particle of a pair: this share of the one along the
   line of centers, and the one across it from these slopes.
------------------------------------------------------------------------- */

Vector2 PairDeformableRing::push_of(int k, double force, const NearPairs::Centers &centers,
                                    double share, double slope) const
{
  const double along = -share * force * centers.cosine,
               across = -force * slope * balanced->pairs().per_distance[k];
  return {along * centers.nx - across * centers.ny, along * centers.ny + across * centers.nx};
}

/* ----------------------------------------------------------------------
   The force f cos(tilt) along the line of centers, and dU/dtheta over the lever
   across it, of both rings. That is f along the normal of a line whose torques
   balance, and the derivative of the energy for any tilt. Of a pair that two
   ranks share each adds the part of its own ring. With f r the sum of energies
   is the dual energy, whose error is O(r^2).
------------------------------------------------------------------------- */

double PairDeformableRing::push_pairs(int begin, int end, double part, bool is_final)
{
  const NearPairs &p = balanced->pairs();
  const bool is_wall = begin >= p.wall, is_remote = !is_wall && begin >= p.remote;
  const bool sums_energy = is_final && eflag_either, tallies = eflag_atom || vflag_either;
  const double share = is_remote ? 0.5 : 1.0;
  double *const pushes = balanced->pushes.data();
  double rest_of_all = 0.0;
  for (int k = begin; k < end; ++k) {
    double slope = balanced->outline_slope(k, 0);
    if (!is_wall && !is_remote) slope += balanced->outline_slope(k, 1);
    const NearPairs::Centers centers = p.centers(k);
    const auto [px, py] = push_of(k, part * p.force[k], centers, share, slope);
    const double rest = sums_energy ? balanced->energy_left(k) : 0.0;
    rest_of_all += share * rest;
    if (tallies) tally(k, px, py, centers, rest);
    if (!is_wall) {
      pushes[2 * k] = px;
      pushes[2 * k + 1] = py;
    } else if (p.force[k] != 0.0) {
      // The wall exerts the torque dU/dtheta about the center: its force acts beside the nearest point.
      const double height = radii[p.i[k]] - p.overlap[k];
      const double shift = -(1.0 - height * p.per_distance[k]) * slope;
      push_wall(p.i[k], p.j[k], px, py, {p.angle[k], centers.nx, centers.ny, p.overlap[k]}, shift);
    }
  }
  return rest_of_all;
}

void PairDeformableRing::tally(int k, double px, double py, const NearPairs::Centers &centers,
                               double rest)
{
  const NearPairs &p = balanced->pairs();
  const int i = p.i[k], j = p.j[k];
  const bool is_wall = k >= p.wall;
  if (eflag_atom) {
    eatom[i] += is_wall ? rest : 0.5 * rest;
    if (k < p.remote) eatom[p.second(k)] += 0.5 * rest;
  }
  if (is_wall || !vflag_either) return;
  const double d = 1.0 / p.per_distance[k];
  ev_tally_xyz(i, j, atom->nlocal, 1, 0.0, 0.0, px, py, 0.0, -centers.nx * d, -centers.ny * d, 0.0);
}

/* ----------------------------------------------------------------------
   The film of a line that is at rest lies beside the foot of the center by the
   slope of its outline. A line that stays perpendicular to the line of centers
   is loaded there.
------------------------------------------------------------------------- */

void PairDeformableRing::load_contacts_of_pairs()
{
  const NearPairs &p = balanced->pairs();
  if (measuring) balanced->measure_lines();
  for (int k = 0; k < p.size; ++k) {
    if (!(p.force[k] > 0.0) && !(p.adhesive && p.attached[k])) continue;
    const int i = p.i[k];
    const double height = radii[i] - balanced->indentation(k, 0);
    double shift = 0.0;
    if (k >= p.wall)
      shift = -(1.0 - height * p.per_distance[k]) * balanced->outline_slope(k, 0);
    else if (p.curved)
      shift = -balanced->outline_slope(k, 0);
    loaded.push_back({i, p.j[k], k < p.wall ? p.second(k) : -1, p.normal(k),
                      middle_of(p.nx[k], p.ny[k], height, shift), p.force[k],
                      measuring ? balanced->size_of_film(k) : 0.0, false});
  }
}

void PairDeformableRing::finish_balanced(int i)
{
  const RingSolver::Ring ring = balanced->ring(i);
  const double r = ring_radius_of(i), pressure = ring.energy.derivative;
  if (eflag_atom) eatom[i] += ring.energy.value;
  const bool is_circle = ring.energy.value == 0.0, is_beyond = ring.arc_radius < 0.0;
  beyond_model += is_beyond;
  if (is_circle && results.requested) results.store_circle(i, r, pressure);
  if (is_circle) return;
  if (!needs_shapes() && !is_beyond && neighbor->ago != 0) return;

  const NearPairs &p = balanced->pairs();
  const Contacts row = {balanced->shape_of(i, contacts, pair_sides, shape), contacts.data()};
  // the particle or wall of a contact
  const auto partner = [&](int c) {
    const int k = pair_sides[c] >> 1;
    return pair_sides[c] & 1 ? p.i[k] : p.j[k];
  };
  if (neighbor->ago == 0 && !is_within_reach(i, row)) refuse_bulge(i, row, partner(deepest(row)));
  // E = q + sum L/2 pi
  double support_radius = ring.free_radius + materials.species_of(i).skin;
  for (int c = 0; c < row.size; ++c) support_radius += shape.contact[c].length / (2.0 * PI);
  for (int c = 0; c < row.size; ++c) {
    const int k = pair_sides[c] >> 1, other = partner(c);
    double &length = shape.contact[c].length;
    const double support_length = length;
    length = balanced->line_length(i, k, length);
    const double distance = other < 0 ? radii[i] - row[c].indentation : 1.0 / p.per_distance[k];
    // each of two particles has half of the force along the line of centers
    const int side = pair_sides[c] & 1;
    const double part = other < 0 ? 1.0 : 0.5;
    Vector2 push = push_of(k, p.force[k], p.centers(k), part, balanced->outline_slope(k, side));
    if (side) push = -push;
    RecordedLine line = {balanced->tilt(k), balanced->half_angle(k)};
    if (side) line.half_angle = -line.half_angle;
    if (p.adhesive && p.attached[k]) {
      line.contact_angle = 2.0 * std::atan(p.film_angle[side][k]);
      line.attached = other < 0 ? other : 1.0;
    }
    line.support_radius = support_radius;
    line.support_length = support_length;
    record(i, other, row[c], length, p.force[k], push, distance, line);
  }
  if (results.requested) results.store_shape(i, r, row.size, shape, pressure);
  if (is_beyond && PI * r * r <= shape.area_deficit)
    for (int c = 0; c < row.size; ++c)
      if (partner(c) >= 0 && shape.contact[c].length > 0.0) check_own_image(i, partner(c));
}

void PairDeformableRing::outline_of(int i, const std::vector<RecordedContact> &of_ring, int points,
                                    Outline &outline) const
{
  const int size = static_cast<int>(of_ring.size());
  if (size == 0) return circle_outline(radii[i], points, outline);
  const double support_radius = of_ring[0].line.support_radius;
  if (bends_lines()) {
    std::vector<CurvedContact> lines;
    for (int c = 0; c < size; ++c) {
      const RecordedLine &line = of_ring[c].line;
      if (line.support_length > 0.0 || line.contact_angle > 0.0)
        lines.push_back(
            {of_ring[c].angle, line.support_length, line.half_angle, line.contact_angle, c});
    }
    return curved_outline(support_radius, std::move(lines), points, outline);
  }
  std::vector<Contact> lines;
  std::vector<int> order(size);
  Shape lengths;
  lengths.reset(size, support_radius);
  for (int c = 0; c < size; ++c) {
    const RecordedContact &at = of_ring[c];
    lines.push_back({at.angle, std::cos(at.angle), std::sin(at.angle), at.indentation});
    lengths.contact[c].length = at.line.support_length;
    order[c] = c;
  }
  ring_outline(support_radius, {size, lines.data()}, lengths, order.data(), points, outline);
}

/* ----------------------------------------------------------------------
   Stiffness and line tension of single particles: the custom properties d_kA
   and d_tension of fix property/atom.
------------------------------------------------------------------------- */

int PairDeformableRing::property_of_atoms(const std::string &name) const
{
  int is_double = 0, columns = 0;
  const int index = atom->find_custom(name.c_str(), is_double, columns);
  if (index < 0 || !is_double || columns > 0)
    error->all(
        FLERR,
        "pair_style deformable/ring {0} atom needs a value of each particle: use 'fix ID all "
        "property/atom d_{0}', and give values by 'set' or a data file",
        name);
  return index;
}

// Fixes may have come and gone since the last run.
void PairDeformableRing::find_properties()
{
  if (kA_by_atom) kA_of_atoms = property_of_atoms("kA");
  if (tension_by_atom) tension_of_atoms = property_of_atoms("tension");
}

/* ----------------------------------------------------------------------
   The rules of species files, for each particle, as values may change at any
   time.
------------------------------------------------------------------------- */

void PairDeformableRing::check_properties()
{
  std::vector<double> adhesion(species.size(), 0.0);    // the largest one of a type
  for (std::size_t i = 1; i < species.size() && adhesions.any(); ++i)
    for (std::size_t j = 1; j < species.size(); ++j)
      adhesion[i] = std::max(adhesion[i], adhesions.between(i, j));
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    const Stiffness k = stiffness_of(i);
    const Species &s = materials.species_of(i);
    std::string problem = invalid_stiffness(k);
    if (problem.empty()) problem = unstable_radius(ring_radius_of(i), k);
    if (problem.empty()) problem = invalid_for_adhesion(adhesion[atom->type[i]], k, s.skin);
    if (problem.empty()) continue;
    refuse("Atom {} of species {}: {} ({} of fix property/atom)", atom->tag[i], s.name, problem,
           kA_by_atom ? tension_by_atom ? "d_kA and d_tension" : "d_kA" : "d_tension");
  }
}

/* ----------------------------------------------------------------------
   Particles of kA = inf whose contacts leave no room for their area: motion
   stops, a minimization separates them. From the first force call without room
   on, until its end, areas give way beyond a pressure (stiffness.h). At first
   it is hardly above the one at rest, because the outlines of firmer particles
   bulge too far between their neighbors. It grows in each iteration, so that
   particles of any pressure that are left at the end are incompressible.
------------------------------------------------------------------------- */

static double yield_after(bigint iterations)
{
  constexpr double FIRST = 1.5, GROWTH = 1.01, MOST = 100.0;    // where no pressure of a shape is
  return std::min(FIRST * std::pow(GROWTH, static_cast<double>(iterations)), MOST);
}

bool PairDeformableRing::may_give_way() const
{
  if (update->whichflag != 2) return false;
  if (kA_by_atom) return true;
  return std::any_of(species.begin(), species.end(), [](const Species &s) {
    return !s.name.empty() && std::isinf(s.stiffness.kA);
  });
}

// Returns whether materials are others than at the last call.
bool PairDeformableRing::choose_yield()
{
  const double before = materials.yield;
  const bool soft = soft_since != NEVER && may_give_way();
  materials.yield = soft ? yield_after(update->ntimestep - soft_since) : 0.0;
  giving_way = 0;
  return materials.yield != before;
}

void PairDeformableRing::begin_to_give_way()
{
  soft_since = update->ntimestep;
  materials.yield = yield_after(0);
}

// Others on all ranks follow at the next call.
Energy PairDeformableRing::shape_without_room(int i, const Contacts &contacts)
{
  Materials soft = materials;
  if (soft.yield == 0.0 && may_give_way()) soft.yield = yield_after(0);
  const Energy energy = shape_ring(i, contacts, soft.stiffness_of(i, ring_radius_of(i)));
  if (!std::isfinite(energy.derivative)) no_shape(i, contacts.size);
  ++giving_way;
  return energy;
}

// The largest adhesion of the contacts that a particle may have.
double PairDeformableRing::largest_adhesion(int i) const
{
  double largest = 0.0;
  for (int type = 1; type <= atom->ntypes; ++type)
    largest = std::max(largest, adhesions.between(atom->type[i], type));
  for (const FixDeformableWall *wall : walls)
    if (atom->mask[i] & wall->groupbit) largest = std::max(largest, wall->adhesion());
  return largest;
}

void PairDeformableRing::no_shape(int i, int contacts)
{
  const bool keeps_area = std::isinf(stiffness_of(i).kA);
  const double adhesion = largest_adhesion(i);
  const bool starts = update->whichflag == 1 && update->ntimestep == update->firststep;
  std::string advice;
  if (keeps_area && starts) advice += "begin with 'minimize', which makes room, ";
  if (update->whichflag == 2 && update->ntimestep > update->firststep &&
      !utils::strmatch(update->minimize_style, "^deformable/"))
    advice += "use 'min_style deformable/lbfgs', whose steps are short, ";
  if (adhesion > 0.0) advice += "take a smaller adhesion, ";
  advice += "compress less, ";
  advice[0] = static_cast<char>(std::toupper(advice[0]));
  refuse("Atom {} has no {}: its {} contacts{} leave no room. {}or give {} a {} kA", atom->tag[i],
         keeps_area ? "shape that keeps its area" : "stable shape", contacts,
         adhesion > 0.0 ? fmt::format(" of adhesion {:g}", adhesion) : "", advice,
         kA_by_atom ? "it" : "species '" + materials.species_of(i).name + "'",
         keeps_area ? "finite" : "larger");
}

int PairDeformableRing::all_giving_way() const
{
  return sum_of_ranks(world, giving_way);
}

void PairDeformableRing::tell_room()
{
  pvector[6] = giving_way;
  const bool soft = materials.yield > 0.0;
  if (soft && warned_no_room) return;
  if (!soft && (balanced || !may_give_way())) return;    // balanced contacts have told all ranks
  const int number = all_giving_way();
  if (number == 0) return;
  if (!soft) begin_to_give_way();
  if (!warned_no_room && comm->me == 0)
    error->warning(
        FLERR,
        "The contacts of {} of {} particles leave no room for the area that kA = inf "
        "conserves: in this minimization areas give way until there is room. 'compute ID "
        "all pair' counts them",
        number, atom->natoms);
  warned_no_room = true;
}

// LAMMPS calls this at the end of each run and minimization.
void PairDeformableRing::finish()
{
  if (soft_since == NEVER) return;
  soft_since = NEVER;
  const int number = all_giving_way();
  if (number > 0 && comm->me == 0)
    error->warning(FLERR,
                   "At the end of the minimization the contacts of {} particles of kA = inf still "
                   "leave no room for their area: minimize further, or compress less",
                   number);
}
