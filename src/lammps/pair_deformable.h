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
    double distance;         // to the partner's centre, or to the wall
    double d_indentation;    // da/d(distance)
    double per_lever;        // turn of the direction per sideways step of the partner: 1/distance
  };

  // All contacts of this rank's particles, those of particle i from i * stride on. Two particles of one
  // rank share what belongs to their contact, so each is computed once.
  struct ContactTable {
    int stride = 0;    // the longest neighbour list, and walls: nothing can overflow
    std::vector<int> count;
    std::vector<double> angle, nx, ny, indentation;
    std::vector<Partner> partner;

    void clear(int nlocal, int most);
    void add(int i, const Partner &, double theta, double x, double y, double a);
    deformable::Contacts of(int i)
    {
      const std::size_t first = static_cast<std::size_t>(i) * stride;
      return {count[i], &angle[first], &nx[first], &ny[first], &indentation[first]};
    }
  } table;
  deformable::Shape shape;    // of the particle at hand

  // One force call: begin, gather, for each particle the law and apply or store_circle, finish.
  void begin(int eflag, int vflag);
  template <bool WALLS> void gather();
  template <bool WALLS>
  void apply(int i, const deformable::Contacts &, const deformable::Energy &energy);
  void finish();

  // Per-atom results of a deformed particle, and of one that is still a circle.
  void store_shape(int i, const deformable::Contacts &, double pressure);
  void store_circle(int i);

  int beyond;                 // particles of this rank with a negative radius of curvature
  double bulge_over_reach;    // the largest of this rank, at the last new neighbour list

 private:
  enum { AREA, PERIMETER, CONTACTS, PRESSURE, ARC_RADIUS, CONTACT_LENGTH, NRESULTS };
  std::array<double *, NRESULTS> results{};    // per atom; null until somebody asks for them
  int maxresults = 0;
  bool wanted = false;
  bool warned = false;

  void allocate();
  [[noreturn]] void behind_centre(int i, int j, double distance);
};

inline void PairDeformable::ContactTable::add(int i, const Partner &with, double theta, double x,
                                              double y, double a)
{
  const std::size_t c = static_cast<std::size_t>(i) * stride + count[i]++;
  partner[c] = with;
  angle[c] = theta;
  nx[c] = x;
  ny[c] = y;
  indentation[c] = a;
}

// The contacts of all particles: neighbours within the cutoff and walls.
template <bool WALLS> void PairDeformable::gather()
{
  using deformable::PI;
  const double *const *const x = atom->x;
  const int *const type = atom->type;
  const int nlocal = atom->nlocal;

  int most = 0;
  for (int ii = 0; ii < list->inum; ++ii) most = std::max(most, list->numneigh[list->ilist[ii]]);
  if constexpr (WALLS)
    for (const FixDeformableWall *wall : walls) most += wall->max_contacts();
  table.clear(nlocal, most);

  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    const double xi = x[i][0], yi = x[i][1], ri = radius[type[i]];
    const double *const cutsq_i = cutsq[type[i]];
    const int *const neighbors = list->firstneigh[i];
    const int count = list->numneigh[i];
    for (int jj = 0; jj < count; ++jj) {
      const int j = neighbors[jj] & NEIGHMASK;
      if (j < i) continue;    // done from the other side
      const double dx = x[j][0] - xi, dy = x[j][1] - yi, rsq = dx * dx + dy * dy;
      if (rsq > cutsq_i[type[j]]) continue;

      const double d = std::sqrt(rsq), per_d = 1.0 / d, rj = radius[type[j]];
      const double nx = dx * per_d, ny = dy * per_d;
      const double theta = deformable::angle_of(dx, dy);
      const deformable::ContactLine line = deformable::contact_line(d, per_d, ri, rj);
      if (!(line.height > 0.0)) behind_centre(i, j, d);
      table.add(i, {j, d, line.d_indentation, per_d}, theta, nx, ny, line.indentation);
      if (j >= nlocal) continue;

      const deformable::ContactLine other = deformable::contact_line(d, per_d, rj, ri);
      if (!(other.height > 0.0)) behind_centre(j, i, d);
      table.add(j, {i, d, other.d_indentation, per_d}, theta > 0.0 ? theta - PI : theta + PI, -nx, -ny,
                other.indentation);
    }
    if constexpr (WALLS)
      for (std::size_t w = 0; w < walls.size(); ++w)
        walls[w]->visit(
            i, (1.0 + reach) * ri, [&](double nx, double ny, double height, double per_lever) {
              table.add(i, {-1 - static_cast<int>(w), height, -1.0, per_lever}, deformable::angle_of(nx, ny), nx,
                        ny, ri - height);
            });
  }
}

// Energy and forces of one particle's shape: each contact pushes the particle and its partner apart by
// dU/da da/dd along their line, and turns them by dU/dtheta.
template <bool WALLS>
void PairDeformable::apply(int i, const deformable::Contacts &contacts,
                           const deformable::Energy &energy)
{
  double *const *const f = atom->f;
  const Partner *const partners = &table.partner[static_cast<std::size_t>(i) * table.stride];
  double fx = 0.0, fy = 0.0;
  for (int c = 0; c < contacts.size; ++c) {
    if (shape.d_indentation[c] == 0.0 && shape.d_angle[c] == 0.0) continue;
    const Partner &partner = partners[c];
    const double nx = contacts.nx[c], ny = contacts.ny[c];
    const double along = energy.derivative * shape.d_indentation[c] * partner.d_indentation;
    const double across = energy.derivative * shape.d_angle[c] * partner.per_lever;
    const double px = along * nx - across * ny, py = along * ny + across * nx;    // on particle i
    if (WALLS && partner.atom < 0) {
      walls[-1 - partner.atom]->press(i, px, py, -partner.distance * nx, -partner.distance * ny);
      continue;
    }
    fx += px;
    fy += py;
    f[partner.atom][0] -= px;
    f[partner.atom][1] -= py;
    if (vflag_either)
      ev_tally_xyz(i, partner.atom, atom->nlocal, 1, 0.0, 0.0, px, py, 0.0, -partner.distance * nx,
                   -partner.distance * ny, 0.0);
  }
  f[i][0] += fx;
  f[i][1] += fy;
  if (eflag_global) eng_vdwl += energy.value;
  if (eflag_atom) eatom[i] += energy.value;
  if (shape.arc_radius < 0.0) ++beyond;
}

}    // namespace LAMMPS_NS

#endif
