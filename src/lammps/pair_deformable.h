// What both contact laws share: parameters, contacts from the neighbour list and the walls, forces from
// the derivatives of the shape, per-atom results. A law adds how contacts become a shape.

#ifndef LMP_PAIR_DEFORMABLE_H
#define LMP_PAIR_DEFORMABLE_H

#include "pair.h"

#include "contact_pairs.h"
#include "contact_table.h"
#include "fix_deformable_wall.h"
#include "shape.h"
#include "species.h"
#include "stiffness.h"

#include "atom.h"
#include "neigh_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace LAMMPS_NS {

// A contact as the particle on one side of it sees it.
struct SeenContact {
  int atom;
  tagint partner;    // or 0, a wall
  double indentation, length, force;
  double x, y;        // where the line is nearest to the particle
  double angle;       // of the direction to it
  double distance;    // of the partner's centre, or of the wall
};

class PairDeformable : public Pair {
 public:
  // Contacts of this rank's particles at the last call, while a compute deformable/contact is defined.
  std::vector<SeenContact> seen;

  PairDeformable(class LAMMPS *, int outputs = 2);
  ~PairDeformable() override;

  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void *extract_peratom(const char *, int &) override;
  double memory_usage() override;

 protected:
  // Stops with an error that says what the style supports, unless this is part of it.
  virtual void check_species(const Species &) const {}

  double reach = 0.0;              // contacts are sought up to (1 + reach) (R_i + R_j)
  std::vector<Species> species;    // by atom type; nameless where the type belongs to another style
  std::vector<FixDeformableWall *> walls;

  // Undeformed radii: of the species, or, with `radius atom`, of each atom by itself.
  void set_radius(int iarg, char **arg);    // to what this word of pair_style says
  bool radius_by_atom = false;
  double radius_of(int i) const { return atom_radius ? atom_radius[i] : radius[atom->type[i]]; }
  double ring_radius_of(int i) const { return radius_of(i) - species[atom->type[i]].skin; }
  double smallest_radius() const;    // of all particles of all ranks

  ContactTable table;
  deformable::Shape shape;    // of the particle at hand

  // One force call: begin_call, for_each_particle the law and apply or store_circle, end_call.
  void begin_call(int eflag, int vflag);
  template <bool WALLS, class Law> void for_each_particle(Law &&law);
  // Instead of it, all contacts of all particles at once: of all pairs of the neighbour list, in the order
  // of that list, then of the walls. They stay until the next call.
  template <bool WALLS> void gather();
  template <bool WALLS>
  void apply(int i, const deformable::Contacts &, const deformable::Energy &energy);
  void end_call();

  // Keeps a contact for compute deformable/contact, if there is one.
  void see(int i, int partner, const deformable::Contact &, double length, double force,
           double distance);

  // Per-atom results of a deformed particle, and of one that is still a circle.
  void store_shape(int i, const deformable::Contacts &, double pressure);
  void store_circle(int i);

  int beyond;                 // particles of this rank with a negative radius of curvature
  double bulge_over_reach;    // the largest of this rank, at the last new neighbour list

 private:
  std::vector<double> radius;             // by atom type; the largest, where radii are by atom
  const double *atom_radius = nullptr;    // of this call, ghosts included; null: radii by type
  void check_radii();

  static constexpr int BLOCK = 64;
  ContactPairs pairs;    // those of the block of particles at hand
  template <bool WITHIN_CUTOFF> void find_pairs(int begin, int end);
  void enter_pairs();
  void enter_walls(int i);

  enum { AREA, PERIMETER, CONTACTS, PRESSURE, ARC_RADIUS, CONTACT_LENGTH, NRESULTS };
  std::array<double *, NRESULTS> results{};    // per atom; null until somebody asks for them
  int maxresults = 0;
  bool wanted = false;
  bool watched = false;    // by compute deformable/contact
  bool warned = false;

  void allocate();
  [[noreturn]] void behind_centre(int i, int j);
};

// Calls law(i, contacts) for all particles, a block of them at a time, so that their pairs can be worked on
// side by side. Particles come in the order of their index and the list has a pair at its lower one, so
// that earlier blocks have left here what they share with these.
template <bool WALLS, class Law> void PairDeformable::for_each_particle(Law &&law)
{
  for (int begin = 0; begin < list->inum; begin += BLOCK) {
    const int end = std::min(begin + BLOCK, list->inum);
    find_pairs<true>(begin, end);
    meet(pairs);
    enter_pairs();
    for (int ii = begin; ii < end; ++ii) {
      const int i = list->ilist[ii];
      if constexpr (WALLS) enter_walls(i);
      law(i, table.of(i));
      table.release(i);
    }
  }
}

template <bool WALLS> void PairDeformable::gather()
{
  for (int begin = 0; begin < list->inum; begin += BLOCK) {
    find_pairs<false>(begin, std::min(begin + BLOCK, list->inum));
    meet(pairs);
    enter_pairs();
  }
  if constexpr (WALLS)
    for (int ii = 0; ii < list->inum; ++ii) enter_walls(list->ilist[ii]);
}

// Energy and forces of one particle's shape: each contact pushes the particle and its partner apart by
// dU/da da/dd along their line, and turns them by dU/dtheta.
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
      const double height = radius_of(i) - contacts[c].indentation;
      walls[-1 - partner.atom]->press(i, px, py, -height * nx, -height * ny);
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
  if (watched)
    for (int c = 0; c < contacts.size; ++c) {
      const double height = radius_of(i) - contacts[c].indentation;
      see(i, partners[c].atom, contacts[c], responses[c].length, slope * responses[c].d_indentation,
          partners[c].atom < 0 ? height : 1.0 / partners[c].per_lever);
    }
  if (eflag_global) eng_vdwl += energy.value;
  if (eflag_atom) eatom[i] += energy.value;
  if (shape.arc_radius < 0.0) ++beyond;
}

}    // namespace LAMMPS_NS

#endif
