// The base of the pair styles: parameters, contacts from the neighbor list and the walls, forces from the
// derivatives of the shape, per-particle results. A contact law adds how contacts become a shape.

#ifndef LMP_PAIR_DEFORMABLE_H
#define LMP_PAIR_DEFORMABLE_H

#include "pair.h"

#include "contact_pairs.h"
#include "contact_table.h"
#include "fix_deformable_wall.h"
#include "particle_results.h"
#include "shape.h"
#include "species.h"
#include "stiffness.h"
#include "trigonometry.h"

#include "atom.h"
#include "neigh_list.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace LAMMPS_NS {

// A contact from one of its two sides.
struct RecordedContact {
  int atom;
  tagint partner;    // 0: a wall
  double indentation, length, force;
  double x, y;        // point of the line that is nearest to the center
  double angle;       // of the direction to the line
  double distance;    // of the partner's center, or of the wall
};

class PairDeformable : public Pair {
 public:
  // Contacts of this rank's particles at the last call, if a compute deformable/contact is defined.
  std::vector<RecordedContact> recorded;

  PairDeformable(class LAMMPS *, int outputs = 2);
  ~PairDeformable() override;

  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void *extract_peratom(const char *, int &) override;
  double memory_usage() override;

 protected:
  // Stops with an error if the style does not support this species.
  virtual void check_species(const Species &) const {}

  double reach = 0.0;    // largest distance of contacts over R_i + R_j, minus 1
  std::vector<Species>
      species;    // by atom type; without a name if the type belongs to another style
  std::vector<FixDeformableWall *> walls;

  // The force of a wall on particle i at this contact, at `shift` beside the point nearest to the center.
  void push_wall(int i, int partner, double fx, double fy, const deformable::Contact &contact,
                 double shift)
  {
    const int code = -1 - partner, count = static_cast<int>(walls.size());
    const double ri = radius_of(i), height = ri - contact.indentation;
    walls[code % count]->add_force(i, code / count, fx, fy,
                                   -height * contact.nx + shift * contact.ny,
                                   -height * contact.ny - shift * contact.nx, (1.0 + reach) * ri);
  }
  const char *wall_id(int partner) const { return walls[(-1 - partner) % walls.size()]->id; }

  // Undeformed radii: of the species or, with `radius atom`, of each atom.
  void set_radius(int iarg, char **arg);    // from this word of pair_style
  bool radius_by_atom = false;
  double radius_of(int i) const { return atom_radius ? atom_radius[i] : radius[atom->type[i]]; }
  double ring_radius_of(int i) const { return radius_of(i) - species[atom->type[i]].skin; }
  double smallest_radius() const;    // of all particles of all ranks

  ContactTable table;
  deformable::Shape shape;    // of the particle that is evaluated

  // A force call is begin_call, for_each_particle, end_call. For each particle the law computes the shape and
  // calls apply, or store_circle if there is no deformation.
  void begin_call(int eflag, int vflag);
  template <bool WALLS, class Law> void for_each_particle(Law &&law);
  // Alternatively all contacts at once, which stay in the table until the next call: the pairs of the neighbor
  // list in their order, then the walls.
  template <bool WALLS> void gather_contacts();
  template <bool WALLS>
  void apply(int i, const deformable::Contacts &, const deformable::Energy &energy);
  void end_call();

  // Whether anyone asks for shapes and contacts of single particles in this call.
  bool needs_shapes() const { return recording || results.requested; }

  // For compute deformable/contact, if there is one.
  void record(int i, int partner, const deformable::Contact &, double length, double force,
              double distance);

  // Results of a deformed particle, and of one that is still a circle.
  void store_shape(int i, const deformable::Contacts &contacts, double pressure)
  {
    if (results.requested)
      results.store_shape(i, ring_radius_of(i), contacts.size, shape, pressure);
  }
  void store_circle(int i)
  {
    if (results.requested) results.store_circle(i, ring_radius_of(i));
  }

  [[noreturn]] void refuse_behind_center(int i, int j);

  // A particle in a box smaller than itself: its own images leave it no area. touches(c): whether contact c is one of
  // an image.
  template <class Touches> void check_own_images(int i, int contacts, Touches &&touches)
  {
    const double r = ring_radius_of(i), area = deformable::PI * r * r - shape.area_deficit;
    if (area > 0.0) return;
    for (int c = 0; c < contacts; ++c)
      if (touches(c) && shape.contact[c].length > 0.0) refuse_own_images(i);
  }
  bool is_own_image(int i, int j) const
  {
    return j >= 0 && atom->tag[j] == atom->tag[i] && atom->tag[i] != 0;
  }
  [[noreturn]] void refuse_own_images(int i);

  int beyond_model;           // particles of this rank with a negative radius of curvature
  double bulge_over_reach;    // the largest of this rank, at the last new neighbor list

 private:
  std::vector<double> radius;             // by atom type; the largest one if radii are by atom
  const double *atom_radius = nullptr;    // in this call, ghosts included; null: radii by type
  void check_radii();

  static constexpr int BLOCK = 64;
  ContactPairs pairs;    // of the block of particles that is evaluated
  template <bool WITHIN_CUTOFF> void insert_pairs_of(int begin, int end);
  void insert_walls(int i);

  ParticleResults results;
  bool recording = false;    // for compute deformable/contact
  bool warned_beyond_model = false, warned_out_of_plane = false, warned_unused_radii = false;

  void allocate();
};

// Calls law(i, contacts) for all particles. Pairs are computed for a block of particles at a time, in vectors.
// Particles come in the order of their index and the list has a pair at its lower index: contacts with earlier
// particles are in the table already.
template <bool WALLS, class Law> void PairDeformable::for_each_particle(Law &&law)
{
  for (int begin = 0; begin < list->inum; begin += BLOCK) {
    const int end = std::min(begin + BLOCK, list->inum);
    insert_pairs_of<true>(begin, end);
    for (int ii = begin; ii < end; ++ii) {
      const int i = list->ilist[ii];
      if constexpr (WALLS) insert_walls(i);
      law(i, table.of(i));
      table.release(i);
    }
  }
}

template <bool WALLS> void PairDeformable::gather_contacts()
{
  for (int begin = 0; begin < list->inum; begin += BLOCK)
    insert_pairs_of<false>(begin, std::min(begin + BLOCK, list->inum));
  if constexpr (WALLS)
    for (int ii = 0; ii < list->inum; ++ii) insert_walls(list->ilist[ii]);
}

// Energy and forces of one particle's shape. Of each contact, the force along the line of centers is
// dU/da da/dd and the force across it is dU/dtheta over the lever.
template <bool WALLS>
void PairDeformable::apply(int i, const deformable::Contacts &contacts,
                           const deformable::Energy &energy)
{
  double *const *const f = atom->f;
  const Partner *const partners = &table.partner[table.first(i)];
  const deformable::Response *const responses = shape.contact.data();
  const double slope = energy.derivative;
  double fx = 0.0, fy = 0.0;
  for (int c = 0; c < contacts.size; ++c) {
    const deformable::Response response = responses[c];
    if (response.d_indentation == 0.0 && response.d_angle == 0.0) continue;
    const Partner partner = partners[c];
    const double nx = contacts[c].nx, ny = contacts[c].ny;
    const double along = slope * response.d_indentation * partner.d_indentation;
    const double across = slope * response.d_angle * partner.per_lever;
    const double px = along * nx - across * ny, py = along * ny + across * nx;    // on particle i
    if (WALLS && partner.atom < 0) {
      // The wall exerts the torque dU/dtheta about the center: beyond that of (along, across) at the nearest
      // point, its force acts beside this point.
      const double rest = 1.0 - (radius_of(i) - contacts[c].indentation) * partner.per_lever;
      const double shift =
          response.d_indentation > 0.0 ? rest * response.d_angle / response.d_indentation : 0.0;
      push_wall(i, partner.atom, px, py, contacts[c], shift);
      continue;
    }
    fx += px;
    fy += py;
    double *const fj = f[partner.atom];
    fj[0] -= px;
    fj[1] -= py;
    if (vflag_either)
      ev_tally_xyz(i, partner.atom, atom->nlocal, 1, 0.0, 0.0, px, py, 0.0, -nx / partner.per_lever,
                   -ny / partner.per_lever, 0.0);
  }
  f[i][0] += fx;
  f[i][1] += fy;
  if (recording)
    for (int c = 0; c < contacts.size; ++c) {
      const double height = radius_of(i) - contacts[c].indentation;
      record(i, partners[c].atom, contacts[c], responses[c].length,
             slope * responses[c].d_indentation,
             partners[c].atom < 0 ? height : 1.0 / partners[c].per_lever);
    }
  if (eflag_global) eng_vdwl += energy.value;
  if (eflag_atom) eatom[i] += energy.value;
  if (shape.arc_radius < 0.0) {
    ++beyond_model;
    check_own_images(i, contacts.size, [&](int c) { return is_own_image(i, partners[c].atom); });
  }
}

}    // namespace LAMMPS_NS

#endif
