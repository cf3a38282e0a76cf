#include "styles/pair/block_forces.h"

#include "styles/refusals.h"

namespace deformable {

/* ----------------------------------------------------------------------
   The neighbor list is new: no contact is known to be active.
------------------------------------------------------------------------- */

void BlockForces::take_neighbors()
{
  rows.resize(pair.atom->nlocal);
  int size = 0;
  for (int ii = 0; ii < pair.list->inum; ++ii) {
    const int i = pair.list->ilist[ii];
    rows[i] = {size, pair.list->numneigh[i], 0};
    size += pair.list->numneigh[i];
  }
  partners.assign(size, 0);
  for (int ii = 0; ii < pair.list->inum; ++ii) {
    const int i = pair.list->ilist[ii], *const neighbors = pair.list->firstneigh[i];
    for (int c = 0; c < rows[i].size; ++c) partners[rows[i].first + c] = neighbors[c] & NEIGHMASK;
  }
}

/* ----------------------------------------------------------------------
   The contacts of particles begin to end of the list. In front are those that
   were active at the last call. Where they are not known, and if the outline
   cannot reach others, these are the lines inside of the circle. Nothing is
   skipped by a branch: it would be mispredicted.
------------------------------------------------------------------------- */

template <bool WALLS> void BlockForces::gather_block(int begin, int end)
{
  const double *const x = pair.atom->nmax > 0 ? pair.atom->x[0] : nullptr;
  const double *const radius = pair.radii.data();
  block.clear(end - begin);
  wall_contacts.clear();
  for (int ii = begin; ii < end; ++ii) {
    const int i = pair.list->ilist[ii];
    const double xi = x[3 * i], yi = x[3 * i + 1], ri = radius[i];
    const Row row = rows[i];
    const int *const neighbors = partners.data() + row.first;
    const auto first_wall = wall_contacts.size();
    if constexpr (WALLS)
      visit_walls(pair.walls, i, ri, pair.reach, [this](int code, const SurfacePoint &point) {
        wall_contacts.push_back({code, point.n.x, point.n.y, point.height, point.turn});
      });
    const int room = row.size + static_cast<int>(wall_contacts.size() - first_wall);
    BlockParticle &p = block.particles[ii - begin];
    block.place(p, i, ri, pair.materials.species_of(i).skin, pair.stiffness_of(i), room);

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
    if (pair.bulges() ? inside > 0 && p.active == 0 : !as_before)
      arrange(block, p, [&](const Place &place) {
        const double sum = ri + place.radius;
        return !(place.dx * place.dx + place.dy * place.dy > sum * sum);
      });
    if (pair.bulges()) continue;
    if (p.moved) remember_active(p);
    p.others = p.last;
  }
}

template void BlockForces::gather_block<false>(int, int);
template void BlockForces::gather_block<true>(int, int);

void BlockForces::remember_active(const BlockParticle &p)
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

void BlockForces::push_block()
{
  double *const f = pair.atom->nmax > 0 ? pair.atom->f[0] : nullptr;
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
    if (pair.eflag_global) pair.eng_vdwl += p.energy;
    if (p.arc_radius < 0.0) {
      ++pair.beyond_model;
      check_own_images(p);
    }
  }
}

/* ----------------------------------------------------------------------
   d(mirror image)/d(wall) = 2. If dU/dtheta is not the torque of the force at
   the nearest point, the point of action lies beside it, by `shift` along the
   wall.
------------------------------------------------------------------------- */

BlockForces::WallPush BlockForces::push_of(const WallContact &wall, const Place &place)
{
  const double nx = wall.nx, ny = wall.ny;
  const double along = 2.0 * (place.fx * nx + place.fy * ny);
  const double torque = 2.0 * wall.height * (place.fy * nx - place.fx * ny);
  const double across = torque * wall.per_lever;
  const double rest = 1.0 - wall.height * wall.per_lever;
  return {{along * nx - across * ny, along * ny + across * nx},
          along < 0.0 ? -rest * torque / along : 0.0};
}

void BlockForces::push_mirror(const BlockParticle &p, const Place &place)
{
  if (place.fx == 0.0 && place.fy == 0.0) return;
  const WallContact &wall = wall_contacts[-1 - place.partner];
  const auto [push, shift] = push_of(wall, place);
  pair.push_wall(p.name, wall.wall, push.x, push.y, {0.0, wall.nx, wall.ny, p.radius - wall.height},
                 shift);
}

/* ----------------------------------------------------------------------
   What is asked for beside forces.
------------------------------------------------------------------------- */

void BlockForces::observe(const BlockParticle &p)
{
  if (pair.eflag_atom) pair.eatom[p.name] += p.energy;
  if (pair.vflag_either)
    for_each_active(block, p, [&](const Place &place) {
      if (place.partner >= 0)
        pair.ev_tally_xyz(p.name, place.partner, pair.atom->nlocal, 1, 0.0, 0.0, place.fx, place.fy,
                          0.0, -place.dx, -place.dy, 0.0);
    });
  if (pair.results.requested) {
    if (p.energy == 0.0) {
      pair.results.store_circle(p.name, p.ring_radius, p.pressure);
    } else {
      load_shape(p);
      pair.results.store_shape(p.name, p.ring_radius, p.active, pair.shape, p.pressure);
    }
  }
  if (pair.rubbing)
    for_each_active(block, p, [&](const Place &place) {
      if (place.fx != 0.0 || place.fy != 0.0) pair.loaded.push_back(loaded_contact(p, place));
    });
  if (pair.recording)
    for_each_active(block, p, [&](const Place &place) {
      const PlacedLine line = line_of(p, place);
      RecordedLine recorded_line;
      recorded_line.support_radius = p.radius + p.perimeter_excess / (2.0 * PI);
      recorded_line.support_length = place.length;
      if (place.partner >= 0)
        return pair.record(p.name, place.partner, line.contact, place.length, place.force,
                           {place.fx, place.fy}, 1.0 / line.per_distance, recorded_line);
      const WallContact &wall = wall_contacts[-1 - place.partner];
      pair.record(p.name, wall.wall, line.contact, place.length, place.force,
                  push_of(wall, place).push, 0.5 / line.per_distance, recorded_line);
    });
}

/* ----------------------------------------------------------------------
   Each side has a force of its own, along the line of centers; a wall has one.
------------------------------------------------------------------------- */

LoadedContact BlockForces::loaded_contact(const BlockParticle &p, const Place &place) const
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

void BlockForces::load_shape(const BlockParticle &p)
{
  pair.shape.reset(p.active + p.last - p.others, p.ring_radius);
  pair.shape.area_deficit = p.area_deficit;
  pair.shape.perimeter_excess = p.perimeter_excess;
  pair.shape.arc_radius = p.arc_radius;
  auto response = pair.shape.contact.begin();
  for_each_place(block, p,
                 [&](const Place &place) { *response++ = {place.length, place.length, 0.0}; });
}

void BlockForces::check_lines(const BlockParticle &p)
{
  for_each_place(block, p, [&](const Place &place) {
    if (!(line_of(p, place).contact.indentation < (1.0 - NEAREST_LINE) * p.radius))
      pair.refuse_behind_center(p.name, place.partner, place.dx, place.dy);
  });
}

/* ----------------------------------------------------------------------
   A particle in a box smaller than itself: its own images leave it no area.
------------------------------------------------------------------------- */

void BlockForces::check_own_images(const BlockParticle &p)
{
  if (PI * p.ring_radius * p.ring_radius - p.area_deficit > 0.0) return;
  for_each_active(block, p, [&](const Place &place) {
    if (place.partner >= 0 && (place.fx != 0.0 || place.fy != 0.0))
      pair.check_own_image(p.name, place.partner);
  });
}

}    // namespace deformable
