// From the contacts of a block of particles to their shapes and forces: particles of equal numbers of active
// contacts in batches, odd ones by the law for one particle.

#ifndef DEFORMABLE_BLOCK_WALK_H
#define DEFORMABLE_BLOCK_WALK_H

#include "kernels/batch_kernels.h"
#include "kernels/large_vector.h"
#include "laws/contact.h"
#include "laws/shape.h"
#include "laws/stiffness.h"
#include "laws/trigonometry.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace deformable {

struct ContactBlock {
  std::vector<BlockParticle> particles;
  std::vector<Place> places;    // memory that only grows
  int used = 0;                 // places of the particles

  void clear(int size)
  {
    particles.resize(size);
    used = 0;
  }

  // Makes p a circle with room for so many contacts; places may move.
  void place(BlockParticle &p, int name, double radius, double skin, const Stiffness &stiffness,
             int room)
  {
    const std::size_t end = static_cast<std::size_t>(used + room);
    if (end > places.size()) places.resize(2 * end);
    p.radius = radius;
    p.ring_radius = radius - skin;
    p.stiffness = stiffness;
    p.first = used;
    p.active = 0;
    p.others = p.last = used += room;
    p.name = name;
    p.moved = false;
    p.circle();
  }

  // scratch of the walk
  std::vector<BlockParticle *> waiting, sorted;
  std::vector<Place> arranged;

  std::vector<Contact> contacts;    // of one particle

  double bytes() const { return bytes_of(particles, places, waiting, sorted, arranged, contacts); }
};

// The kernel of a particle, an index of BatchKernels::ring and sector; 0 if there is none. A second look may find that
// no contact is active.
inline int ring_group(const BlockParticle &p)
{
  if (p.active == 0 || p.active > MOST_IN_BATCH) return 0;
  if (p.stiffness.tension > 0.0) return 2 * MOST_IN_BATCH + p.active;
  return p.stiffness.conserves_perimeter() ? p.active : MOST_IN_BATCH + p.active;
}

inline int sector_group(const BlockParticle &p)
{
  return std::isinf(p.stiffness.kP) && p.active >= 2 && p.active <= MOST_IN_BATCH ? p.active : 0;
}

// Calls visit(place) for the contacts of a particle: the active ones, then the others.
template <class Visitor>
void for_each_place(ContactBlock &block, const BlockParticle &p, Visitor &&visit)
{
  Place *const places = block.places.data();
  for (int c = p.first; c < p.first + p.active; ++c) visit(places[c]);
  for (int c = p.others; c < p.last; ++c) visit(places[c]);
}

// The same for the active contacts only: forces of the others are not set.
template <class Visitor>
void for_each_active(const ContactBlock &block, const BlockParticle &p, Visitor &&visit)
{
  const Place *const places = block.places.data();
  for (int c = p.first; c < p.first + p.active; ++c) visit(places[c]);
}

// Contact line of one place.
struct PlacedLine {
  Contact contact;
  double d_indentation, per_distance;
};

inline PlacedLine line_of(const BlockParticle &p, const Place &place)
{
  const double d = std::sqrt(place.dx * place.dx + place.dy * place.dy), per_d = 1.0 / d;
  const ContactLine<double> line = contact_line(d, per_d, p.radius, place.radius);
  return {{angle_of(place.dx, place.dy), place.dx * per_d, place.dy * per_d, line.indentation},
          line.d_indentation,
          per_d};
}

// The contacts of one particle as the laws take them, in the order of for_each_place.
inline Contacts load_contacts(ContactBlock &block, const BlockParticle &p)
{
  block.contacts.clear();
  for_each_place(block, p,
                 [&](const Place &place) { block.contacts.push_back(line_of(p, place).contact); });
  return {static_cast<int>(block.contacts.size()), block.contacts.data()};
}

// One particle: law(particle, contacts) fills `shape` and the pressure and returns the energy.
template <class Law>
void shape_one(ContactBlock &block, BlockParticle &p, const Shape &shape, Law &&law)
{
  const Contacts contacts = load_contacts(block, p);
  const Energy energy = law(p, contacts);
  p.energy = energy.value;
  p.area_deficit = shape.area_deficit;
  p.perimeter_excess = shape.perimeter_excess;
  p.arc_radius = shape.arc_radius;
  const Response *response = shape.contact.data();
  for_each_place(block, p, [&](Place &place) {
    const PlacedLine line = line_of(p, place);
    place.length = response->length;
    place.force = energy.derivative * response->d_indentation;
    const double along = place.force * line.d_indentation;
    const double across = energy.derivative * response->d_angle * line.per_distance;
    place.fx = along * line.contact.nx - across * line.contact.ny;
    place.fy = along * line.contact.ny + across * line.contact.nx;
    ++response;
  });
}

// Puts those contacts in front for which is_active(place) holds, in the order of their partners, negative ones last: sums
// do not depend on how contacts got there.
template <class IsActive>
void arrange(ContactBlock &block, BlockParticle &p, IsActive &&is_active)
{
  block.arranged.clear();
  for_each_place(block, p, [&](const Place &place) { block.arranged.push_back(place); });
  std::sort(block.arranged.begin(), block.arranged.end(), [](const Place &a, const Place &b) {
    return static_cast<unsigned>(a.partner) < static_cast<unsigned>(b.partner);
  });
  p.moved = true;
  p.active = 0;
  p.others = p.last;
  for (Place &place : block.arranged) {
    const bool active = is_active(place);
    place.length = 0.0;
    block.places[active ? p.first + p.active++ : --p.others] = place;
  }
}

// Shapes the particles that have active contacts. group_of(particle) is an index of `kernels`, or 0 for a particle
// that law(particle, contacts) must shape. `shapes`: whether lengths and perimeters are asked for.
template <class GroupOf, class Law>
void shape_block(ContactBlock &block, const BatchKernel *kernels, bool shapes, const Shape &shape,
                 GroupOf &&group_of, Law &&law)
{
  std::vector<BlockParticle *> &waiting = block.waiting, &sorted = block.sorted;
  waiting.resize(block.particles.size());
  std::size_t count = 0;
  for (BlockParticle &p : block.particles) {
    waiting[count] = &p;
    count += p.active > 0;
  }
  waiting.resize(count);

  constexpr int GROUPS = 3 * MOST_IN_BATCH + 1;
  for (int attempt = 0; attempt < 6 && !waiting.empty(); ++attempt) {
    int end[GROUPS + 1] = {};    // of each group, after its begin
    for (const BlockParticle *p : waiting) ++end[group_of(*p) + 1];
    for (int g = 1; g <= GROUPS; ++g) end[g] += end[g - 1];
    sorted.resize(waiting.size());
    for (BlockParticle *p : waiting) {
      const int group = group_of(*p);
      p->outcome = group == 0 ? Outcome::ODD : Outcome::DONE;
      sorted[end[group]++] = p;
    }
    for (int g = 1; g < GROUPS; ++g)
      if (end[g] > end[g - 1])
        kernels[g](&sorted[end[g - 1]], end[g] - end[g - 1], block.places.data(), shapes);
    waiting.clear();
    for (BlockParticle *p : sorted) {
      if (p->outcome != Outcome::RETRY) continue;
      arrange(block, *p, [](const Place &place) { return place.length > 0.0; });
      p->outcome = Outcome::ODD;    // unless another attempt changes it
      waiting.push_back(p);
    }
  }
  for (BlockParticle &p : block.particles)
    if (p.outcome == Outcome::ODD) {
      arrange(block, p, [](const Place &) { return true; });
      shape_one(block, p, shape, law);
    }
}

}    // namespace deformable

#endif
