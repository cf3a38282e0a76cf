// Rings without room: those that cannot keep their area between their contacts, and bubbles that collapse.

#include "solver/balanced_forces.h"

#include "laws/soft_ring.h"

#include "atom.h"

#include <algorithm>
#include <cmath>
#include <utility>

using namespace LAMMPS_NS;
using namespace deformable;

// All ranks know whether there is one. The solver then fails for rings of other ranks, too: the most crowded one of all ranks
// counts.
void BalancedForces::find_crushed()
{
  crushed = -1;
  lacking = false;
  if (is_balanced) return;
  const Crowded here = find_crushed_here();
  const bool keeps_area = near.remote_sides.largest(here.keeps_area) > 0.0;
  const bool may_be_it = here.keeps_area == keeps_area;
  const double most = near.remote_sides.largest(may_be_it ? here.overlaps : -1.0);
  lacking = most >= 0.0;
  if (may_be_it && here.overlaps == most) crushed = here.particle;
}

// Where no split of the overlaps leaves room for its area, the free arcs of a ring vanish as its forces grow, or the solver
// finds no forces that it bears, or it stops at a split without room.
BalancedForces::Crowded BalancedForces::find_crushed_here() const
{
  constexpr double NONE = 0.01;
  for (std::size_t ring = 0; ring < batches.particle.size(); ++ring) {
    const int i = batches.particle[ring];
    if (i < 0) continue;
    const Stiffness k = batches.stiffness(static_cast<int>(ring));
    const bool keeps_area = std::isinf(k.kA), gives_way = std::isfinite(k.yield);
    if (!keeps_area && k.tension == 0.0) continue;
    const double free = batches.free_radius(ring);
    if ((keeps_area && !solver.exists) || std::isnan(free) ||
        (!gives_way && (free < NONE * batches.radius[ring] || (keeps_area && !fits(i)))))
      return most_crowded(false);
  }
  return has_collapsed() ? most_crowded(true) : Crowded{};
}

// Whether ring i has room for its area between its lines, which share what is left of the overlaps.
bool BalancedForces::fits(int i) const
{
  std::vector<Contact> contacts;
  std::vector<int> seats;
  Shape shape;
  const int n = shape_of(i, contacts, seats, shape), ring = batches.place[i];
  std::vector<char> is_active(n, 0);
  RingLCP lcp;
  Energy energy;
  return soft_ring_shape(batches.radius[ring], batches.stiffness(ring), {n, contacts.data()},
                         is_active.data(), lcp, shape, energy);
}

// Rings of this rank that have given way.
int BalancedForces::giving_way() const
{
  int number = 0;
  for (std::size_t ring = 0; ring < batches.yield.size(); ++ring)
    number += batches.pressure[ring] > batches.yield[ring];
  return number;
}

// Forces without limit spread to rings that have room. So the ring is named whose contacts overlap most, in its radii: of those
// that keep their area, else of bubbles.
BalancedForces::Crowded BalancedForces::most_crowded(bool of_bubbles) const
{
  const NearPairs &p = near.pairs;
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
    const Stiffness k = batches.stiffness(static_cast<int>(ring));
    if (std::isinf(k.kA) ? of_bubbles : k.tension == 0.0) continue;
    const double overlaps = crowd[i] / batches.radius[ring];
    const bool keeps_area = std::isinf(k.kA) && overlaps > 0.0;
    if (std::pair(keeps_area, overlaps) > std::pair(most.keeps_area, most.overlaps))
      most = {i, overlaps, keeps_area};
  }
  return most;
}

// Whether there is a bubble of gas that cannot bear the forces of its contacts: they do not grow, and most of an overlap is left.
bool BalancedForces::has_collapsed() const
{
  constexpr double MUCH = 0.02;    // of a radius
  constexpr int MANY = 20;         // evaluations that usually balance anything
  if (!batches.tense || solver.evaluations() < MANY) return false;
  const auto is_bubble = [this](int i) {
    return i >= 0 && batches.tension[batches.place[i]] > 0.0 &&
           std::isfinite(batches.kA[batches.place[i]]);
  };
  for (int k = 0; k < near.pairs.size; ++k) {
    if (residual(k) < MUCH * batches.radius[batches.place[near.pairs.i[k]]]) continue;
    if (is_bubble(near.pairs.i[k]) || is_bubble(near.pairs.second(k))) return true;
  }
  return false;
}
