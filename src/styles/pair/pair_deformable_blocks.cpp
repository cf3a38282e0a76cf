// Contacts of blocks of particles from the neighbor list and the walls, and forces from their shapes.

#include "styles/pair/pair_deformable.h"

#include "styles/refusals.h"

using namespace LAMMPS_NS;
using namespace deformable;

/* ----------------------------------------------------------------------
   The neighbor list is new: no contact is known to be active.
------------------------------------------------------------------------- */

void PairDeformable::take_neighbors()
{
  rows.resize(atom->nlocal);
  int size = 0;
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    rows[i] = {size, list->numneigh[i], 0};
    size += list->numneigh[i];
  }
  partners.assign(size, 0);
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii], *const neighbors = list->firstneigh[i];
    for (int c = 0; c < rows[i].size; ++c) partners[rows[i].first + c] = neighbors[c] & NEIGHMASK;
  }
}

/* ----------------------------------------------------------------------
   The contacts of particles begin to end of the list. In front are those that
   were active at the last call. Where they are not known, and if the outline
   cannot reach others, these are the lines inside of the circle. Nothing is
   skipped by a branch: it would be mispredicted.
------------------------------------------------------------------------- */

template <bool WALLS> void PairDeformable::gather_block(int begin, int end)
{
  const double *const x = atom->nmax > 0 ? atom->x[0] : nullptr;
  const double *const radius = radii.data();
  block.clear(end - begin);
  wall_contacts.clear();
  for (int ii = begin; ii < end; ++ii) {
    const int i = list->ilist[ii];
    const double xi = x[3 * i], yi = x[3 * i + 1], ri = radius[i];
    const Row row = rows[i];
    const int *const neighbors = partners.data() + row.first;
    const auto first_wall = wall_contacts.size();
    if constexpr (WALLS)
      visit_walls(walls, i, ri, reach, [this](int code, const SurfacePoint &point) {
        wall_contacts.push_back({code, point.n.x, point.n.y, point.height, point.turn});
      });
    const int room = row.size + static_cast<int>(wall_contacts.size() - first_wall);
    BlockParticle &p = block.particles[ii - begin];
    block.place(p, i, ri, materials.species_of(i).skin, stiffness_of(i), room);

    Place *const places = block.places.data() + p.first;
    int inside = 0;
    bool as_before = true;
    for (int c = 0; c < row.size; ++c) {
      const int j = neighbors[c];
      const double dx = x[3 * j] - xi, dy = x[3 * j + 1] - yi;
      const double rj = radius[j], sum = ri + rj;
      // not a number counts as inside, where it is noticed
      const bool touches = !(dx * dx + dy * dy > sum * sum);
      Place &place = places[c];
      place.dx = dx;
      place.dy = dy;
      place.radius = rj;
      place.length = 0.0;
      place.partner = j;
      inside += touches;
      as_before &= touches == (c < row.active);
    }
    p.active = row.active;
    Place *place = places + row.size;
    // in the order of arrange
    for (auto w = wall_contacts.size(); WALLS && w-- > first_wall; ++place) {
      const WallContact &wall = wall_contacts[w];
      const double d = 2.0 * wall.height;    // the mirror image
      *place = {d * wall.nx, d * wall.ny, ri, 0.0, 0.0, 0.0, 0.0, -1 - static_cast<int>(w)};
      if (wall.height > ri) continue;
      std::swap(*place, places[p.active++]);
      ++inside;
    }
    if (inside == 0) p.active = 0;
    p.others = p.first + p.active;
    if (bulges() ? inside > 0 && p.active == 0 : !as_before)
      arrange(block, p, [&](const Place &place) {
        const double sum = ri + place.radius;
        return !(place.dx * place.dx + place.dy * place.dy > sum * sum);
      });
    if (bulges()) continue;
    if (p.moved) remember_active(p);
    p.others = p.last;
  }
}

template void PairDeformable::gather_block<false>(int, int);
template void PairDeformable::gather_block<true>(int, int);

void PairDeformable::remember_active(const BlockParticle &p)
{
  Row &row = rows[p.name];
  const Place *const end_of_active = block.places.data() + p.first + p.active;
  int *const begin = partners.data() + row.first, *front = begin, *back = begin + row.size;
  for_each_place(block, p, [&](const Place &place) {
    if (place.partner < 0) return;    // a wall
    const bool active = &place < end_of_active && (p.outcome != Outcome::ODD || place.length > 0.0);
    *(active ? front++ : --back) = place.partner;
  });
  row.active = static_cast<int>(front - begin);
}

/* ----------------------------------------------------------------------
   The forces of a block on its particles and their partners, in the order of
   the particles: the sums do not depend on how batches were made.
------------------------------------------------------------------------- */

void PairDeformable::push_block()
{
  double *const f = atom->nmax > 0 ? atom->f[0] : nullptr;
  for (const BlockParticle &p : block.particles) {
    const Place *const end = block.places.data() + p.first + p.active;
    double fx = 0.0, fy = 0.0;
    for (const Place *place = end - p.active; place != end; ++place) {
      if (place->partner < 0) {
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

/* ----------------------------------------------------------------------
   d(mirror image)/d(wall) = 2. If dU/dtheta is not the torque of the force at
   the nearest point, the point of action lies beside it, by `shift` along the
   wall.
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
  push_wall(p.name, wall.wall, push.x, push.y, {0.0, wall.nx, wall.ny, p.radius - wall.height},
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
  if (rubbing)
    for_each_active(block, p, [&](const Place &place) {
      if (place.fx != 0.0 || place.fy != 0.0) loaded.push_back(loaded_contact(p, place));
    });
  if (recording)
    for_each_active(block, p, [&](const Place &place) {
      const PlacedLine line = line_of(p, place);
      RecordedLine recorded_line;
      recorded_line.support_radius = p.radius + p.perimeter_excess / (2.0 * PI);
      recorded_line.support_length = place.length;
      if (place.partner >= 0)
        return record(p.name, place.partner, line.contact, place.length, place.force,
                      {place.fx, place.fy}, 1.0 / line.per_distance, recorded_line);
      const WallContact &wall = wall_contacts[-1 - place.partner];
      record(p.name, wall.wall, line.contact, place.length, place.force, push_of(wall, place).push,
             0.5 / line.per_distance, recorded_line);
    });
}

/* ----------------------------------------------------------------------
   Each side has a force of its own, along the line of centers; a wall has one.
------------------------------------------------------------------------- */

LoadedContact PairDeformable::loaded_contact(const BlockParticle &p, const Place &place) const
{
  if (place.partner < 0) {
    const WallContact &wall = wall_contacts[-1 - place.partner];
    const auto [push, shift] = push_of(wall, place);
    const double force = -push.x * wall.nx - push.y * wall.ny;
    return {p.name,
            wall.wall,
            -1,
            {wall.nx, wall.ny, 0.0},
            middle_of(wall.nx, wall.ny, wall.height, shift),
            force,
            place.length,
            false};
  }
  const Contact contact = line_of(p, place).contact;
  const double force = -place.fx * contact.nx - place.fy * contact.ny;
  return {p.name,
          place.partner,
          -1,
          {contact.nx, contact.ny, 0.0},
          middle_of(contact.nx, contact.ny, p.radius - contact.indentation, 0.0),
          force,
          place.length,
          true};
}

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

void PairDeformable::check_lines(const BlockParticle &p)
{
  for_each_place(block, p, [&](const Place &place) {
    if (!(line_of(p, place).contact.indentation < (1.0 - NEAREST_LINE) * p.radius))
      refuse_behind_center(p.name, place.partner, place.dx, place.dy);
  });
}

void PairDeformable::refuse_behind_center(int i, int j, double dx, double dy)
{
  if (!std::isfinite(dx + dy))
    refuse("The positions of atoms {} and {} are no numbers any more: the motion before was too "
           "fast for its timestep, or beyond the model. Use a smaller timestep",
           atom->tag[i], atom->tag[j]);
  refuse("The contact line of atoms {} and {} does not lie well in front of the center of atom {}: "
         "their distance is {:.6g}, their radii are {:.6g} and {:.6g}. Separate particles that "
         "overlap first, start from a less compressed state, or take smaller steps or a smaller "
         "timestep",
         atom->tag[i], atom->tag[j], atom->tag[i], std::hypot(dx, dy), radii[i], radii[j]);
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
