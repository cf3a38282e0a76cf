// Contacts of blocks of particles from the neighbor list and the walls, and forces from their shapes.

#include "pair_deformable.h"

#include "error.h"

using namespace LAMMPS_NS;
using namespace deformable;

/* ----------------------------------------------------------------------
   The contacts of particles begin to end of the list: those that are expected
   to be active in front, the others at the end. Active contacts of the last
   call are expected again, and the lines inside of the circle where nothing is
   known. Nothing is skipped by a branch: it would be mispredicted.
------------------------------------------------------------------------- */

template <bool WALLS, bool BY_ATOM> void PairDeformable::gather_block(int begin, int end)
{
  const double *const x = atom->nmax > 0 ? atom->x[0] : nullptr;
  const int *const type = atom->type;
  const double *const radii = BY_ATOM ? atom_radius : radius.data();
  const double stretch = 1.0 + reach;
  block.clear(end - begin);
  wall_contacts.clear();
  for (int ii = begin; ii < end; ++ii) {
    const int i = list->ilist[ii];
    const double xi = x[3 * i], yi = x[3 * i + 1], ri = radii[BY_ATOM ? i : type[i]];
    const int *const neighbors = list->firstneigh[i];
    const int count = list->numneigh[i];
    const auto first_wall = wall_contacts.size();
    if constexpr (WALLS) visit_walls(i);
    const int room = count + static_cast<int>(wall_contacts.size() - first_wall);
    const Species &s = species[type[i]];
    BlockParticle &p = block.particles[ii - begin];
    block.place(p, i, ri, s.skin, s.stiffness, room);

    Place *const places = block.places.data();
    const unsigned known = active_slots.empty() || room > SLOTS ? 0u : active_slots[i];
    const auto expected = [known](int slot, bool touches) -> bool {
      return known ? known >> (slot & (SLOTS - 1)) & 1u : touches;
    };
    int front = p.first, back = p.last, inside = 0;
    for (int jj = 0; jj < count; ++jj) {
      const int j = neighbors[jj] & NEIGHMASK;
      const double dx = x[3 * j] - xi, dy = x[3 * j + 1] - yi;
      const double rj = radii[BY_ATOM ? j : type[j]];
      const double square = dx * dx + dy * dy, sum = ri + rj, cutoff = stretch * sum;
      // not a number counts as inside, where it is noticed
      const bool touches = !(square > sum * sum), near = !(square > cutoff * cutoff);
      const bool active = near & expected(jj, touches);
      Place &place = places[active ? front : back - 1];
      place.dx = dx;
      place.dy = dy;
      place.radius = rj;
      place.length = 0.0;
      place.slot = jj;
      place.partner = j;
      inside += touches;
      front += active;
      back -= near & !active;
    }
    if constexpr (WALLS)
      for (std::size_t w = first_wall; w < wall_contacts.size(); ++w) {
        const WallContact &wall = wall_contacts[w];
        const double d = 2.0 * wall.height;    // the mirror image
        const int slot = count + static_cast<int>(w - first_wall);
        const bool touches = wall.height <= ri;
        places[expected(slot, touches) ? front++ : --back] = {
            d * wall.nx, d * wall.ny, ri, 0.0, 0.0, 0.0, 0.0, slot, -1 - static_cast<int>(w)};
        inside += touches;
      }
    p.active = inside > 0 ? front - p.first : 0;
    p.others = back;
    p.moved = known == 0;
    if (inside > 0 && p.active == 0)    // others than expected
      arrange(block, p, [&](const Place &place) {
        const double sum = ri + place.radius;
        return !(place.dx * place.dx + place.dy * place.dy > sum * sum);
      });
  }
}

template void PairDeformable::gather_block<false, false>(int, int);
template void PairDeformable::gather_block<false, true>(int, int);
template void PairDeformable::gather_block<true, false>(int, int);
template void PairDeformable::gather_block<true, true>(int, int);

/* ---------------------------------------------------------------------- */

void PairDeformable::visit_walls(int i)
{
  const int count = static_cast<int>(walls.size());
  for (int w = 0; w < count; ++w)
    walls[w]->visit(i, radius_of(i), reach, [&](const NearestPoint &point) {
      wall_contacts.push_back(
          {-1 - (w + count * point.feature), point.nx, point.ny, point.height, point.per_lever});
    });
}

/* ---------------------------------------------------------------------- */

void PairDeformable::remember_active(const BlockParticle &p)
{
  unsigned slots = 0;
  const Place *const first = block.places.data() + p.first;
  for (const Place *place = first; place != first + p.active; ++place)
    if (place->slot < SLOTS && (p.outcome != Outcome::ODD || place->length > 0.0))
      slots |= 1u << place->slot;
  active_slots[p.name] = slots;
}

/* ----------------------------------------------------------------------
   The forces of a block on its particles and their partners, in the order of
   the particles: the sums do not depend on how batches were made.
------------------------------------------------------------------------- */

template <bool WALLS> void PairDeformable::push_block()
{
  double *const f = atom->nmax > 0 ? atom->f[0] : nullptr;
  for (const BlockParticle &p : block.particles) {
    const Place *const end = block.places.data() + p.first + p.active;
    double fx = 0.0, fy = 0.0;
    for (const Place *place = end - p.active; place != end; ++place) {
      if (WALLS && place->partner < 0) {
        push_mirror(p, *place);
        continue;
      }
      fx += place->fx;
      fy += place->fy;
      double *const fj = f + 3 * place->partner;
      fj[0] -= place->fx;
      fj[1] -= place->fy;
    }
    f[3 * p.name] += fx;
    f[3 * p.name + 1] += fy;
    if (eflag_global) eng_vdwl += p.energy;
    if (p.arc_radius < 0.0) {
      ++beyond_model;
      check_own_images(p);
    }
  }
}

template void PairDeformable::push_block<false>();
template void PairDeformable::push_block<true>();

/* ----------------------------------------------------------------------
   The mirror image comes nearer by twice the way of the wall. The wall exerts
   the torque dU/dtheta about the center: beyond that of (along, across) at the
   nearest point, its force acts beside this point.
------------------------------------------------------------------------- */

PairDeformable::WallPush PairDeformable::push_of(const WallContact &wall, const Place &place)
{
  const double nx = wall.nx, ny = wall.ny;
  const double along = 2.0 * (place.fx * nx + place.fy * ny);
  const double torque = 2.0 * wall.height * (place.fy * nx - place.fx * ny);
  const double across = torque * wall.per_lever;
  const double rest = 1.0 - wall.height * wall.per_lever;
  return {{along * nx - across * ny, along * ny + across * nx},
          along < 0.0 ? -rest * torque / along : 0.0};
}

void PairDeformable::push_mirror(const BlockParticle &p, const Place &place)
{
  if (place.fx == 0.0 && place.fy == 0.0) return;
  const WallContact &wall = wall_contacts[-1 - place.partner];
  const auto [push, shift] = push_of(wall, place);
  push_wall(p.name, wall.wall, push.fx, push.fy, {0.0, wall.nx, wall.ny, p.radius - wall.height},
            shift);
}

/* ----------------------------------------------------------------------
   What is asked for beside forces.
------------------------------------------------------------------------- */

void PairDeformable::observe(const BlockParticle &p)
{
  if (eflag_atom) eatom[p.name] += p.energy;
  if (vflag_either)
    for_each_active(block, p, [&](const Place &place) {
      if (place.partner >= 0)
        ev_tally_xyz(p.name, place.partner, atom->nlocal, 1, 0.0, 0.0, place.fx, place.fy, 0.0,
                     -place.dx, -place.dy, 0.0);
    });
  if (results.requested) {
    if (p.energy == 0.0) {
      results.store_circle(p.name, p.ring_radius, p.pressure);
    } else {
      load_shape(p);
      results.store_shape(p.name, p.ring_radius, p.active, shape, p.pressure);
    }
  }
  if (recording)
    for_each_active(block, p, [&](const Place &place) {
      const PlacedLine line = line_of(p, place);
      if (place.partner >= 0)
        return record(p.name, place.partner, line.contact, place.length, place.force,
                      {place.fx, place.fy}, 1.0 / line.per_distance);
      const WallContact &wall = wall_contacts[-1 - place.partner];
      record(p.name, wall.wall, line.contact, place.length, place.force, push_of(wall, place).push,
             0.5 / line.per_distance);
    });
}

/* ---------------------------------------------------------------------- */

void PairDeformable::load_shape(const BlockParticle &p)
{
  shape.reset(p.active + p.last - p.others, p.ring_radius);
  shape.area_deficit = p.area_deficit;
  shape.perimeter_excess = p.perimeter_excess;
  shape.arc_radius = p.arc_radius;
  auto response = shape.contact.begin();
  for_each_place(block, p,
                 [&](const Place &place) { *response++ = {place.length, place.length, 0.0}; });
}

/* ---------------------------------------------------------------------- */

void PairDeformable::check_lines(const BlockParticle &p)
{
  for_each_place(block, p, [&](const Place &place) {
    if (!(line_of(p, place).contact.indentation < (1.0 - NEAREST_LINE) * p.radius))
      refuse_behind_center(p.name, place.partner, place.dx, place.dy);
  });
}

void PairDeformable::refuse_behind_center(int i, int j, double dx, double dy)
{
  error->one(
      FLERR,
      "The contact line of atoms {} and {} does not lie well in front of the center of atom {}: "
      "their "
      "distance is {:.6g}, their radii are {:.6g} and {:.6g}. Separate particles that overlap "
      "first, start from a less compressed state, or take smaller steps or a smaller timestep",
      atom->tag[i], atom->tag[j], atom->tag[i], std::hypot(dx, dy), radius_of(i), radius_of(j));
}

/* ----------------------------------------------------------------------
   A particle in a box smaller than itself: its own images leave it no area.
------------------------------------------------------------------------- */

void PairDeformable::check_own_images(const BlockParticle &p)
{
  if (PI * p.ring_radius * p.ring_radius - p.area_deficit > 0.0) return;
  for_each_active(block, p, [&](const Place &place) {
    if (place.partner >= 0 && (place.fx != 0.0 || place.fy != 0.0))
      check_own_image(p.name, place.partner);
  });
}
