#include "solver/balanced_forces.h"

#include "laws/contact_film.h"

#include "atom.h"
#include "comm.h"
#include "error.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace deformable;

static constexpr double MOST_OUT = 0.10199;    // -G at its minimum

void BalancedForces::stick()
{
  films = std::make_unique<Films>(kernels);
  solver.stick(films.get());
}

// Outlines may bulge so far that the list of near pairs is not sufficient: then they are found again. Films that come or go
// change the forces of others, which may let others come or go.
bool BalancedForces::solve(const DeformableParticles &p, bool new_list,
                           const std::function<void()> &before_change)
{
  constexpr int MOST_LISTS = 10, MOST_CHANGES = 100;
  const bool begins_to_stick = p.films && !near.pairs.sticks;    // an adhesion has grown from 0
  if (new_list) {
    near.build(p, true);
    arrange(p, true);
  } else if (begins_to_stick) {
    near.build(p, false);
    arrange(p, false);
  } else if (p.radii_vary || p.new_material || p.materials->vary()) {
    set_material(p);
  }
  const auto locate = [&] {
    wrong = near.locate(p);
    return wrong >= 0 || p.refusals->any_here();
  };
  const auto on_any_rank = [&](bool refused) { return near.remote_sides.largest(refused) > 0.0; };
  bool refused = locate();
  if (new_list) {
    refused = on_any_rank(refused);
  } else if (!near.is_sufficient(p, refused) && !refused) {
    near.build(p, false);
    arrange(p, false);
    refused = on_any_rank(locate());
  }
  if (refused) return false;
  solver.begin_call();
  if (films) films->begin_call();
  double before = 0.0;
  int changes = 0;
  for (int lists = 0;; ++lists) {
    is_balanced = solver.solve();
    find_crushed();
    if (lacking) break;    // forces have no limit, nor have bulges
    find_bulges();
    if (lists < MOST_LISTS && !near.is_sufficient_after(p)) {
      solver.remember();
      near.build(p, false);
      arrange(p, false);
      near.locate(p);
      continue;
    }
    // forces that do not balance may be those of films that should have gone
    if (films && changes < MOST_CHANGES && films->would_change(is_balanced)) {
      if (changes++ == 0) {
        before = total_energy();
        before_change();
      }
      films->change(is_balanced);
      near.store_films(p);    // for lists that are made anew in this call, too
      solver.begin_again();
      continue;
    }
    if (!is_balanced) warn_unbalanced();
    break;
  }
  if (near.pairs.curved && new_list && !warned_limited) warn_limited();
  if (changes > 0 && !warned_films) warn_films();
  lost = changes > 0 ? before - total_energy() : 0.0;
  if (films && (new_list || begins_to_stick)) near.store_films(p);
  return true;
}

double BalancedForces::total_energy() const
{
  const NearPairs &p = near.pairs;
  double sum = energy();
  for (int k = 0; k < p.size; ++k)
    sum += (k >= p.remote && k < p.wall ? 0.5 : 1.0) * energy_left(k);
  return near.remote_sides.sum(sum);
}

/* ---------------------------------------------------------------------- */

void BalancedForces::arrange(const DeformableParticles &p, bool new_list)
{
  batches.arrange(near.order(*p.list), p.list->inum, atom->nlocal, near.pairs, atom->tag);
  solver.arrange(batches, near.pairs, near.remote_sides, new_list);
  set_material(p);
}

void BalancedForces::set_material(const DeformableParticles &p)
{
  bool soft = false, tense = false, skinned = false;
  for (const int i : batches.particle) {
    if (i < 0) continue;
    const Species &s = p.materials->species_of(i);
    const Stiffness k = p.materials->stiffness_of(i, p.radius[i] - s.skin);
    soft |= !k.conserves_perimeter();
    tense |= k.tension > 0.0;
    skinned |= near.pairs.curved && s.skin > 0.0;
  }
  batches.set_kind(soft, tense, skinned, soft && p.materials->yield > 0.0);
  for (std::size_t ring = 0; ring < batches.particle.size(); ++ring) {
    const int i = batches.particle[ring];
    if (i < 0) continue;
    const Species &s = p.materials->species_of(i);
    batches.radius[ring] = p.radius[i] - s.skin;
    const Stiffness k = p.materials->stiffness_of(i, batches.radius[ring]);
    batches.kA[ring] = k.kA;
    if (soft) batches.kP[ring] = k.kP;
    if (tense) batches.tension[ring] = k.tension;
    if (skinned) batches.skin[ring] = s.skin;
    if (!batches.yield.empty()) batches.yield[ring] = k.yield;
  }
}

void BalancedForces::find_bulges()
{
  near.forget_growth();
  crowded.clear();
  for (std::size_t ring = 0; ring < batches.particle.size(); ++ring) {
    const int i = batches.particle[ring];
    if (i < 0) continue;
    double lengths = batches.total[ring] * batches.per_pressure[ring];
    const double out = films ? bulge_with_films(ring, lengths)
                             : MOST_OUT * lengths + batches.loaded(ring).expansion;
    near.set_bulge(i, std::max(out, 0.0));
    if (arc_radius_at_least(ring, lengths) < 0.0) crowded.push_back(i);
  }
}

// Contacts under tension pull the outline out. Also finds the sum of all lengths, without signs.
double BalancedForces::bulge_with_films(std::size_t ring, double &lengths) const
{
  const int i = batches.particle[ring];
  const double per_p = batches.per_pressure[ring];
  double out = batches.free_radius(ring) - batches.radius[ring];    // E - r
  lengths = 0.0;
  for (int m = 0; m < batches.count[i]; ++m) {
    const int pair = batches.seat[batches.contact(static_cast<int>(ring), m)] >> 1;
    const double L = near.pairs.force[pair] * per_p;
    out += L * (0.5 / PI) + (L > 0.0 ? MOST_OUT * L : -GREEN_AT_ZERO * L);
    lengths += std::fabs(L);
  }
  return out;
}

void BalancedForces::forget()
{
  NearPairs &p = near.pairs;
  const auto fill = [](auto value, auto &...v) { (std::fill(v.begin(), v.end(), value), ...); };
  fill(UNKNOWN_FORCE, p.past);
  for (LargeVector<double> &past : p.past_tilt) fill(UNKNOWN_FORCE, past);
  fill(0.0F, p.earlier[0], p.earlier[1], p.earlier[2]);
}

/* ---------------------------------------------------------------------- */

double BalancedForces::energy() const
{
  double sum = 0.0;
  for (std::size_t ring = 0; ring < batches.particle.size(); ++ring)
    if (batches.particle[ring] >= 0) sum += energy_of(ring, batches.loaded(ring));
  if (films) sum += films->energy();
  return sum;
}

BalancedForces::Ring BalancedForces::ring(int i) const
{
  const int ring = batches.place[i], n = batches.count[i];
  const LoadedRing loaded = batches.loaded(ring);
  const double lengths = batches.total[ring] * batches.per_pressure[ring];
  double arc_radius = arc_radius_at_least(ring, lengths);
  if (arc_radius < 0.0 || films) {
    double mx = 0.0, my = 0.0;
    for (int m = 0; m < n; ++m) {
      const int seat = batches.seat[batches.contact(ring, m)];
      const double f = seat & 1 ? -near.pairs.force[seat >> 1] : near.pairs.force[seat >> 1];
      mx += f * near.pairs.nx[seat >> 1];
      my += f * near.pairs.ny[seat >> 1];
    }
    arc_radius = batches.free_radius(ring) - std::hypot(mx, my) * batches.per_pressure[ring] / PI;
  }
  if (films) arc_radius = std::min(arc_radius, batches.free_radius(ring) * films->free_arc(i));
  double energy = energy_of(ring, loaded);
  for (int m = 0; m < n && films; ++m) {
    const int seat = batches.seat[batches.contact(ring, m)];
    energy += films->energy(seat >> 1, seat & 1);
  }
  return {{energy, loaded.pressure}, loaded.expansion, arc_radius, n};
}

int BalancedForces::shape_of(int i, std::vector<Contact> &contacts, std::vector<int> &seats,
                             Shape &shape) const
{
  const int ring = batches.place[i], n = batches.count[i];
  const double per_p = batches.per_pressure[ring];
  const LoadedRing loaded = batches.loaded(ring);
  const Stiffness k = batches.stiffness(ring);
  contacts.resize(n);
  seats.resize(n);
  shape.reset(n, batches.radius[ring]);
  double mx = 0.0, my = 0.0;
  for (int m = 0; m < n; ++m) {
    const int c = batches.contact(ring, m), seat = seats[m] = batches.seat[c], pair = seat >> 1;
    const NearPairs &p = near.pairs;
    const double sign = seat & 1 ? -1.0 : 1.0, theta = p.angle[pair];
    const double angle = sign > 0.0 ? theta : theta > 0.0 ? theta - PI : theta + PI;
    contacts[m] = {angle, sign * p.nx[pair], sign * p.ny[pair], indentation(pair, seat & 1)};
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
double BalancedForces::indentation(int k, int side) const
{
  const NearPairs &p = near.pairs;
  const int c = p.side[side][k];
  const double own = batches.compliance[c], other = batches.compliance[p.side[1 - side][k]];
  // a particle that bears next to nothing is infinitely compliant
  const bool any = p.force[k] > 0.0 && std::isfinite(own + other);
  const double share = any ? own / (own + other) : 0.5;
  return batches.indentation[c] + share * residual(k);
}

double BalancedForces::line_length(int i, int k, double length) const
{
  if (!near.pairs.curved) return length;
  if (films) return films->length(k, near.pairs.i[k] == i ? 0 : 1);
  const double bend = near.pairs.i[k] == i ? near.pairs.bend[k] : -near.pairs.bend[k];
  return arc_length(length, batches.free_radius(batches.place[i]), bend);
}

// Ranks compare when the neighbor list is new.
void BalancedForces::warn_limited()
{
  int here = solver.limited_lines() > 0.0, any = here;
  if (comm->nprocs > 1) MPI_Allreduce(&here, &any, 1, MPI_INT, MPI_MAX, world);
  if (any == 0) return;
  warned_limited = true;
  if (comm->me == 0)
    error->warning(
        FLERR, "Contact lines would tilt by more than 0.3 rad or bend by more than 30 degrees, as "
               "between particles beyond the model: they are held there, or straight. "
               "'compute ID all pair' counts them");
}

// Of all ranks, which know alike that films have come or gone.
void BalancedForces::warn_films()
{
  const int i = films->pressed_without_film();
  const tagint here = i < 0 ? -1 : atom->tag[i];
  tagint id;
  MPI_Allreduce(&here, &id, 1, MPI_LMP_TAGINT, MPI_MAX, world);
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

/* ---------------------------------------------------------------------- */

void BalancedForces::warn_unbalanced()
{
  if (warned) return;
  warned = true;
  if (comm->me == 0)
    error->warning(
        FLERR,
        "Contacts are not balanced: after {} evaluations forces are off by up to {:.2g} of the "
        "largest. Allow more evaluations, or a larger tolerance than {:.2g} (pair_style "
        "deformable/ring balance)",
        solver.evaluations(), solver.imbalance, solver.tolerance);
}

double BalancedForces::memory_usage() const
{
  return near.memory_usage() + batches.bytes() + solver.memory_usage();
}
