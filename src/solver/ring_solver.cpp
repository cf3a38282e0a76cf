#include "solver/ring_solver.h"

#include "laws/contact_curve.h"
#include "laws/soft_ring.h"
#include "laws/support.h"
#include "styles/all_ranks.h"

#include "atom.h"
#include "comm.h"
#include "error.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace deformable {

// Contacts have a length of about 8 times the indentation, which is half of the overlap.
static constexpr double BULGE_PER_OVERLAP = 0.4;

RingSolver::RingSolver(LAMMPS *lmp, const ForceKernels &kernels, bool curved, double tolerance,
                       int max_evaluations)
    : DualSolver(lmp, kernels, false, curved, BULGE_PER_OVERLAP, INFINITY, tolerance,
                 max_evaluations)
{
}

void RingSolver::use_films()
{
  auto made = std::make_unique<RingFilms>(kernels);
  lines->films = ring_films = made.get();
  films = std::move(made);
}

bool RingSolver::shape(const RingBatches &rings)
{
  return kernels.shape(rings, list.pairs.directions());
}

bool RingSolver::adapt(const RingBatches &rings, const float *changes, double unit)
{
  return kernels.adapt(rings, list.pairs.force.data(), changes, unit);
}

void RingSolver::find_slopes(const RingBatches &rings)
{
  kernels.slopes(rings, list.pairs.directions());
}

void RingSolver::set_material(const ForceCall &call, bool arranged)
{
  bool soft = false, skinned = false;
  ContactBatches::Members given = {};
  for (const int i : batches.particle) {
    if (i < 0) continue;
    const Species &s = call.materials->species_of(i);
    const Stiffness k = call.materials->stiffness_of(i, call.radius[i] - s.skin);
    soft |= !k.conserves_perimeter();
    skinned |= lines && s.skin > 0.0;
    for (int m = 0; m < MEMBERS; ++m)
      given[m] |= k.*PARAMETERS[m].of_ring != Stiffness().*PARAMETERS[m].of_ring;
  }
  batches.set_kind(soft, skinned, given);
  for (std::size_t ring = 0; ring < batches.particle.size(); ++ring) {
    const int i = batches.particle[ring];
    if (i < 0) continue;
    const Species &s = call.materials->species_of(i);
    batches.radius[ring] = call.radius[i] - s.skin;
    batches.set_stiffness(ring, call.materials->stiffness_of(i, batches.radius[ring]));
    if (skinned) batches.skin[ring] = s.skin;
  }
  if (arranged || call.new_material) set_units(call);
}

// A pair alone bears o^3/2 G(0)^2 (k_i^(-1/3) + k_j^(-1/3))^3 with the stiffnesses k of small loads. With a tension,
// the force is linear: k is that of a ring which bears as much at an indentation of TYPICAL radii. This is k^(-1/3).
static double softness_of(double r, const Stiffness &k)
{
  constexpr double TYPICAL = 0.05;
  const double a = TYPICAL * r;
  if (k.tension > 0.0)    // f = p a/G(0)
    return a / std::cbrt(2.0 * GREEN_AT_ZERO * k.rest_pressure(r) * a);
  return 1.0 / std::cbrt(area_stiffness(r, k));
}

// Units of pairs, the force of a pair alone, and its adhesion.
void RingSolver::set_units(const ForceCall &call)
{
  NearPairs &pairs = list.pairs;
  const Materials &m = *call.materials;
  softness.clear();
  if (m.vary()) {
    for (int i = 0; i < atom->nlocal; ++i) {
      const Species &s = m.species_of(i);
      const double r = call.radius[i] - s.skin;
      softness.push_back(s.radius == 0.0 ? 0.0 : softness_of(r, m.stiffness_of(i, r)));
    }
    list.remote_sides.to_ghosts(softness);
  } else {
    for (int type = 0; type <= atom->ntypes; ++type) {
      const Species &s = m.species[type];
      softness.push_back(s.radius == 0.0 ? 0.0 : softness_of(s.radius - s.skin, s.stiffness));
    }
  }
  const int *const type = m.vary() ? nullptr : atom->type;
  const auto stiffening = [&](int k) {
    const int i = pairs.i[k], j = pairs.j[k];
    double soft = softness[type ? type[i] : i];
    if (k < pairs.wall) soft += softness[type ? type[j] : j];
    return 1.0 / (2.0 * GREEN_AT_ZERO * GREEN_AT_ZERO * soft * soft * soft);
  };
  double most = 0.0;
  for (int k = 0; k < pairs.size; ++k) most = std::max(most, stiffening(k));
  // the same on all ranks, which sum up what is scaled
  const double of_all = list.remote_sides.largest(most) * call.smallest * call.smallest;
  pairs.set_units(of_all > 0.0 ? std::ldexp(1.0, -std::ilogb(of_all)) : 1.0,
                  std::ldexp(1.0, std::ilogb(call.smallest)));
  const double unit = pairs.scale * pairs.length * pairs.length;
  for (int k = 0; k < pairs.size; ++k)
    pairs.stiffening[k] = static_cast<float>(stiffening(k) * unit);
  if (pairs.adhesive) find_adhesions(call);
}

void RingSolver::find_bulges(const ForceCall &)
{
  list.reset_growth();
  crowded.clear();
  for (std::size_t ring = 0; ring < batches.particle.size(); ++ring) {
    const int i = batches.particle[ring];
    if (i < 0) continue;
    double lengths = batches.total[ring] * batches.per_pressure[ring];
    const double out = films ? bulge_with_films(ring, lengths)
                             : -LEAST_GREEN * lengths + batches.loaded(ring).expansion;
    list.set_bulge(i, std::max(out, 0.0));
    if (arc_radius_at_least(ring, lengths) < 0.0) crowded.push_back(i);
  }
}

// Contacts under tension pull the outline out. Also finds the sum of all lengths, without signs.
double RingSolver::bulge_with_films(std::size_t ring, double &lengths) const
{
  const int i = batches.particle[ring];
  const double per_p = batches.per_pressure[ring];
  double out = batches.free_radius(ring) - batches.radius[ring];    // E - r
  lengths = 0.0;
  for (int m = 0; m < batches.count[i]; ++m) {
    const int pair = batches.pair_side[batches.contact(static_cast<int>(ring), m)] >> 1;
    const double L = list.pairs.force[pair] * per_p;
    out += L * (0.5 / PI) - (L > 0.0 ? LEAST_GREEN : GREEN_AT_ZERO) * L;
    lengths += std::fabs(L);
  }
  return out;
}

double RingSolver::energy() const
{
  double sum = 0.0;
  for (std::size_t ring = 0; ring < batches.particle.size(); ++ring)
    if (batches.particle[ring] >= 0) sum += energy_of(ring, batches.loaded(ring));
  if (films) sum += ring_films->energy();
  return sum;
}

RingSolver::Ring RingSolver::ring(int i) const
{
  const int ring = batches.place[i], n = batches.count[i];
  const LoadedRing loaded = batches.loaded(ring);
  const double lengths = batches.total[ring] * batches.per_pressure[ring];
  double arc_radius = arc_radius_at_least(ring, lengths);
  if (arc_radius < 0.0 || films) {
    double mx = 0.0, my = 0.0;
    for (int m = 0; m < n; ++m) {
      const int pair_side = batches.pair_side[batches.contact(ring, m)];
      const double f =
          pair_side & 1 ? -list.pairs.force[pair_side >> 1] : list.pairs.force[pair_side >> 1];
      mx += f * list.pairs.nx[pair_side >> 1];
      my += f * list.pairs.ny[pair_side >> 1];
    }
    arc_radius = batches.free_radius(ring) - std::hypot(mx, my) * batches.per_pressure[ring] / PI;
  }
  if (films) arc_radius = std::min(arc_radius, batches.free_radius(ring) * ring_films->free_arc(i));
  double energy = energy_of(ring, loaded);
  for (int m = 0; m < n && films; ++m) {
    const int pair_side = batches.pair_side[batches.contact(ring, m)];
    energy += ring_films->energy(pair_side >> 1, pair_side & 1);
  }
  return {{energy, loaded.pressure}, loaded.expansion, arc_radius, n, batches.free_radius(ring)};
}

int RingSolver::shape_of(int i, std::vector<Contact> &contacts, std::vector<int> &pair_sides,
                         Shape &shape) const
{
  const int ring = batches.place[i], n = batches.count[i];
  const double per_p = batches.per_pressure[ring];
  const LoadedRing loaded = batches.loaded(ring);
  const Stiffness k = batches.stiffness_of(ring);
  contacts.resize(n);
  pair_sides.resize(n);
  shape.reset(n, batches.radius[ring]);
  double mx = 0.0, my = 0.0;
  for (int m = 0; m < n; ++m) {
    const int c = batches.contact(ring, m), pair_side = pair_sides[m] = batches.pair_side[c],
              pair = pair_side >> 1;
    const NearPairs &p = list.pairs;
    const double sign = pair_side & 1 ? -1.0 : 1.0, theta = p.angle[pair];
    const double angle = sign > 0.0 ? theta : theta > 0.0 ? theta - PI : theta + PI;
    contacts[m] = {angle, sign * p.nx[pair], sign * p.ny[pair], indentation(pair, pair_side & 1)};
    const double length = p.force[pair] * per_p;
    shape.contact[m] = {length, length, -length * batches.slope[c]};
    mx += length * contacts[m].nx;
    my += length * contacts[m].ny;
  }
  const double lengths = batches.total[ring] * per_p;
  shape.area_deficit = loaded.area_deficit(batches.radius[ring], k, batches.work[ring]);
  shape.perimeter_excess = 2.0 * PI * loaded.expansion;
  shape.arc_radius =
      batches.radius[ring] + loaded.expansion - lengths * (0.5 / PI) - std::hypot(mx, my) / PI;
  return n;
}

// Contacts without force may be in one row with rings that have none, whose compliance is not finite.
double RingSolver::indentation(int k, int side) const
{
  const NearPairs &p = list.pairs;
  const int c = p.side[side][k];
  const double own = batches.compliance[c], other = batches.compliance[p.side[1 - side][k]];
  // a particle that bears next to nothing is infinitely compliant
  const bool any = p.force[k] > 0.0 && std::isfinite(own + other);
  const double share = any ? own / (own + other) : 0.5;
  return batches.indentation[c] + share * residual_overlap(k);
}

double RingSolver::line_length(int i, int k, double length) const
{
  if (!list.pairs.curved) return length;
  if (films) return ring_films->length(k, list.pairs.i[k] == i ? 0 : 1);
  const double bend = list.pairs.i[k] == i ? list.pairs.bend[k] : -list.pairs.bend[k];
  return arc_length(length, batches.free_radius(batches.place[i]), bend);
}

void RingSolver::measure_lines()
{
  if (list.pairs.curved) return;
  length_per_force.resize(atom->nlocal);
  for (int i = 0; i < atom->nlocal; ++i)
    length_per_force[i] = batches.place[i] < 0 ? 0.0 : batches.per_pressure[batches.place[i]];
  list.remote_sides.to_ghosts(length_per_force);
}

// A curved line that balances pressures has one length from both sides: all ranks take that of the smaller ID.
double RingSolver::size_of_film(int k) const
{
  const NearPairs &p = list.pairs;
  const int i = p.i[k], j = p.j[k];
  if (!p.curved)
    return p.force[k] *
           (k < p.wall ? 0.5 * (length_per_force[i] + length_per_force[j]) : length_per_force[i]);
  const int from = k < p.remote && atom->tag[j] < atom->tag[i] ? p.second(k) : i;
  return line_length(from, k, p.force[k] * batches.per_pressure[batches.place[from]]);
}

// Ranks compare when the neighbor list is new.
void RingSolver::warn_limited()
{
  warned_limited = list.remote_sides.largest(limited_lines()) > 0.0;
  if (!warned_limited) return;
  if (comm->me == 0)
    error->warning(
        FLERR, "Contact lines would tilt by more than 0.3 rad or bend by more than 30 degrees, as "
               "between particles beyond the model: they are held there, or straight. "
               "'compute ID all pair' counts them");
}

// All ranks call this at once: all know that films have come or gone.
void RingSolver::warn_films()
{
  const int i = films->pressed_without_film();
  const tagint id = largest_of_ranks<tagint>(world, i < 0 ? -1 : atom->tag[i]);
  warned_films = id >= 0;
  if (warned_films && comm->me == 0)
    error->warning(
        FLERR,
        "Atom {} presses against what it sticks to, but without a film: at large contact "
        "angles, or beside others, the law has films only where they are pressed further. "
        "Alone, two equal droplets attach at touch up to an adhesion of {:.2f} times their "
        "tension, and a droplet and a wall up to {:.2f}",
        id, 2.0 * LARGEST_AT_TOUCH, LARGEST_AT_TOUCH);
}

void RingSolver::warn(const ForceCall &call, bool films_changed)
{
  warn_unbalanced("deformable/ring");
  if (lines && call.new_list && !warned_limited) warn_limited();
  if (films_changed && !warned_films) warn_films();
}

/* ----------------------------------------------------------------------
   Rings without room: those that cannot keep their area between their
   contacts, and bubbles that collapse. All ranks know whether there is one.
   The solver then fails for rings of other ranks, too: the most crowded one of
   all ranks counts.
------------------------------------------------------------------------- */

bool RingSolver::has_room()
{
  crushed = -1;
  lacking = false;
  if (are_balanced) return true;
  const Crowded here = find_crushed_here();
  const bool keeps_area = list.remote_sides.largest(here.keeps_area) > 0.0;
  const bool may_be_it = here.keeps_area == keeps_area;
  const double most = list.remote_sides.largest(may_be_it ? here.overlaps : -1.0);
  lacking = most >= 0.0;
  if (may_be_it && here.overlaps == most) crushed = here.particle;
  return !lacking;
}

// Where no split of the overlaps leaves room for its area, the free arcs of a ring vanish as its forces grow, or the solver
// finds no forces that it bears, or it stops at a split without room.
RingSolver::Crowded RingSolver::find_crushed_here() const
{
  constexpr double NONE = 0.01;
  for (std::size_t ring = 0; ring < batches.particle.size(); ++ring) {
    const int i = batches.particle[ring];
    if (i < 0) continue;
    const Stiffness k = batches.stiffness_of(static_cast<int>(ring));
    const bool keeps_area = std::isinf(k.kA), gives_way = std::isfinite(k.yield);
    if (!keeps_area && k.tension == 0.0) continue;
    const double free = batches.free_radius(ring);
    if ((keeps_area && !shapes_exist) || std::isnan(free) ||
        (!gives_way && (free < NONE * batches.radius[ring] || (keeps_area && !fits(i)))))
      return most_crowded(false);
  }
  return has_collapsed() ? most_crowded(true) : Crowded{};
}

// Whether ring i has room for its area between its lines, which share what is left of the overlaps.
bool RingSolver::fits(int i) const
{
  std::vector<Contact> contacts;
  std::vector<int> pair_sides;
  Shape shape;
  const int n = shape_of(i, contacts, pair_sides, shape), ring = batches.place[i];
  std::vector<char> is_active(n, 0);
  RingLCP lcp;
  Energy energy;
  return soft_ring_shape(batches.radius[ring], batches.stiffness_of(ring), {n, contacts.data()},
                         is_active.data(), lcp, shape, energy);
}

// Rings of this rank that have given way.
int RingSolver::giving_way() const
{
  int number = 0;
  for (std::size_t ring = 0; ring < batches.particle.size(); ++ring)
    number += batches.stiffness_of(static_cast<int>(ring)).gives_way(batches.pressure[ring]);
  return number;
}

// Forces without limit spread to rings that have room. So the ring is named whose contacts overlap most, in its radii: of those
// that keep their area, else of bubbles.
RingSolver::Crowded RingSolver::most_crowded(bool of_bubbles) const
{
  const NearPairs &p = list.pairs;
  std::vector<double> crowd(atom->nlocal, 0.0);
  for (int k = 0; k < p.size; ++k) {
    const double overlap = std::max(p.overlap[k], 0.0);
    crowd[p.i[k]] += overlap;
    if (k < p.remote) crowd[p.second(k)] += overlap;
  }
  Crowded most;
  for (std::size_t ring = 0; ring < batches.particle.size(); ++ring) {
    const int i = batches.particle[ring];
    if (i < 0) continue;
    const Stiffness k = batches.stiffness_of(static_cast<int>(ring));
    if (std::isinf(k.kA) ? of_bubbles : k.tension == 0.0) continue;
    const double overlaps = crowd[i] / batches.radius[ring];
    const bool keeps_area = std::isinf(k.kA) && overlaps > 0.0;
    if (std::pair(keeps_area, overlaps) > std::pair(most.keeps_area, most.overlaps))
      most = {i, overlaps, keeps_area};
  }
  return most;
}

// Whether there is a bubble of gas that cannot bear the forces of its contacts: they do not grow, and most of an overlap is left.
bool RingSolver::has_collapsed() const
{
  constexpr double MUCH = 0.02;    // of a radius
  constexpr int MANY = 20;         // evaluations that usually balance anything
  if (summary.evaluations < MANY) return false;
  const auto is_bubble = [this](int i) {
    if (i < 0) return false;
    const Stiffness k = batches.stiffness_of(batches.place[i]);
    return k.tension > 0.0 && std::isfinite(k.kA);
  };
  for (int k = 0; k < list.pairs.size; ++k) {
    if (residual_overlap(k) < MUCH * batches.radius[batches.place[list.pairs.i[k]]]) continue;
    if (is_bubble(list.pairs.i[k]) || is_bubble(list.pairs.second(k))) return true;
  }
  return false;
}

}    // namespace deformable
