// What both contact laws share: parameters, contacts from the neighbour list and the walls, forces from
// the derivatives of the shape, per-atom results. A law adds how contacts become a shape.

#ifndef LMP_PAIR_DEFORMABLE_H
#define LMP_PAIR_DEFORMABLE_H

#include "pair.h"

#include "contact.h"
#include "fix_deformable_wall.h"
#include "shape.h"
#include "species.h"
#include "stiffness.h"
#include "trigonometry.h"

#include "atom.h"
#include "neigh_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace LAMMPS_NS {

class PairDeformable : public Pair {
 public:
  PairDeformable(class LAMMPS *);
  ~PairDeformable() override;

  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void *extract_peratom(const char *, int &) override;
  double memory_usage() override;

 protected:
  // Stops with an error that says what the style supports, unless this is part of it.
  virtual void check_species(const Species &) const = 0;

  double reach = 0.0;              // contacts are sought up to (1 + reach) (R_i + R_j)
  std::vector<Species> species;    // by atom type; nameless where the type belongs to another style
  std::vector<double> radius;      // by atom type
  std::vector<FixDeformableWall *> walls;

  // What a contact's force acts on.
  struct Partner {
    int atom;                // local index, or -1 - w for wall w
    double d_indentation;    // da/dd, d the distance of the partner
    double
        per_lever;    // turn of the direction per sideways step of the partner: 1/d but for walls
  };

  // The contacts found so far. Two particles of one rank share what belongs to their contact, so each is
  // computed once, when the first of the two has its turn. Contacts live from then until the second one's
  // turn: few particles have some at a time, and the places they leave are taken again at once, so that
  // the table stays in the cache however large the system.
  struct ContactTable {
    int stride = 8;          // places of a particle; doubled when one needs more
    std::vector<int> row;    // of each particle; -1: it has no contact yet
    std::vector<int> free_rows;
    std::vector<int> count;    // by row
    std::vector<deformable::Contact> contact;
    std::vector<Partner> partner;

    void clear(int nlocal);
    void make_room(int i);
    void add(int i, const deformable::Contact &, const Partner &);
    void release(int i);
    deformable::Contacts of(int i) const
    {
      if (row[i] < 0) return {0, nullptr};
      return {count[row[i]], &contact[first(i)]};
    }
    std::size_t first(int i) const { return static_cast<std::size_t>(row[i]) * stride; }
  } table;
  // What a law recalls of each particle's contacts from one call to the next, as a first guess: they come
  // in the same order as long as none forms or breaks. start(first, last) fills it in where it is lost.
  template <class T> struct Recall {
    int stride = 8;
    std::vector<T> value;
    std::vector<int> count;

    template <class Start> T *of(int i, int n, Start &&start)
    {
      if (n > stride) {
        while (n > stride) stride *= 2;
        count.clear();
      }
      if (static_cast<std::size_t>(i) >= count.size()) {
        count.resize(i + 1, 0);
        value.resize(count.size() * stride);
      }
      T *const first = &value[static_cast<std::size_t>(i) * stride];
      if (count[i] != n) start(first, first + n);
      count[i] = n;
      return first;
    }
  };
  deformable::Shape shape;    // of the particle at hand

  // One force call: begin, for_each_particle the law and apply or store_circle, finish.
  void begin(int eflag, int vflag);
  template <bool WALLS, class Law> void for_each_particle(Law &&law);
  template <bool WALLS>
  void apply(int i, const deformable::Contacts &, const deformable::Energy &energy);
  void finish();

  // Per-atom results of a deformed particle, and of one that is still a circle.
  void store_shape(int i, const deformable::Contacts &, double pressure);
  void store_circle(int i);

  int beyond;                 // particles of this rank with a negative radius of curvature
  double bulge_over_reach;    // the largest of this rank, at the last new neighbour list

 private:
  // Neighbours in touch, each pair once, as a structure of arrays: what meets, and how.
  struct Pairs {
    int size = 0;
    std::vector<int> i, j;
    std::vector<double> dx, dy, radius_i, radius_j;
    std::vector<double> per_distance, nx, ny, angle;
    std::vector<double> indentation_i, indentation_j, d_indentation_i, d_indentation_j;
    void resize(std::size_t most);
  } pairs;
  void find_pairs(int begin, int end);
  static void meet(Pairs &);
  void enter_pairs();
  void enter_walls(int i);

  enum { AREA, PERIMETER, CONTACTS, PRESSURE, ARC_RADIUS, CONTACT_LENGTH, NRESULTS };
  std::array<double *, NRESULTS> results{};    // per atom; null until somebody asks for them
  int maxresults = 0;
  bool wanted = false;
  bool warned = false;

  void allocate();
  [[noreturn]] void behind_centre(int i, int j);
};

inline void PairDeformable::ContactTable::release(int i)
{
  if (row[i] < 0) return;
  free_rows.push_back(row[i]);
  row[i] = -1;
}

// Calls law(i, contacts) for all particles, a block of them at a time, so that their pairs can be worked on
// side by side. Particles come in the order of their index and the list has a pair at its lower one, so
// that earlier blocks have left here what they share with these.
template <bool WALLS, class Law> void PairDeformable::for_each_particle(Law &&law)
{
  constexpr int BLOCK = 64;
  for (int begin = 0; begin < list->inum; begin += BLOCK) {
    const int end = std::min(begin + BLOCK, list->inum);
    find_pairs(begin, end);
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

// Energy and forces of one particle's shape: each contact pushes the particle and its partner apart by
// dU/da da/dd along their line, and turns them by dU/dtheta.
template <bool WALLS>
void PairDeformable::apply(int i, const deformable::Contacts &contacts,
                           const deformable::Energy &energy)
{
  double *const *const f = atom->f;
  const Partner *const partners = &table.partner[table.first(i)];
  double fx = 0.0, fy = 0.0;
  for (int c = 0; c < contacts.size; ++c) {
    if (shape.contact[c].d_indentation == 0.0 && shape.contact[c].d_angle == 0.0) continue;
    const Partner &partner = partners[c];
    const double nx = contacts[c].nx, ny = contacts[c].ny;
    const double along = energy.derivative * shape.contact[c].d_indentation * partner.d_indentation;
    const double across = energy.derivative * shape.contact[c].d_angle * partner.per_lever;
    const double px = along * nx - across * ny, py = along * ny + across * nx;    // on particle i
    if (WALLS && partner.atom < 0) {
      const double height = radius[atom->type[i]] - contacts[c].indentation;
      walls[-1 - partner.atom]->press(i, px, py, -height * nx, -height * ny);
      continue;
    }
    fx += px;
    fy += py;
    f[partner.atom][0] -= px;
    f[partner.atom][1] -= py;
    if (vflag_either)
      ev_tally_xyz(i, partner.atom, atom->nlocal, 1, 0.0, 0.0, px, py, 0.0, -nx / partner.per_lever,
                   -ny / partner.per_lever, 0.0);
  }
  f[i][0] += fx;
  f[i][1] += fy;
  if (eflag_global) eng_vdwl += energy.value;
  if (eflag_atom) eatom[i] += energy.value;
  if (shape.arc_radius < 0.0) ++beyond;
}

}    // namespace LAMMPS_NS

#endif
