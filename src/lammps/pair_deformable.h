// What both contact laws share: parameters, contacts from the neighbour list and the walls, forces from
// the derivatives of the shape, per-atom results. A law adds how contacts become a shape.

#ifndef LMP_PAIR_DEFORMABLE_H
#define LMP_PAIR_DEFORMABLE_H

#include "pair.h"

#include "contact.h"
#include "fix_deformable_wall.h"
#include "shape.h"
#include "species.h"

#include "atom.h"
#include "neigh_list.h"

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

  // The contacts of the particle at hand: what the law sees, and what its forces act on.
  struct Partner {
    int atom;                // local index, or -1 - w for wall w
    double distance;         // to the partner's centre, or to the wall
    double d_indentation;    // da/d(distance)
    double per_lever;        // turn of the direction per sideways step of the partner: 1/distance
  };
  deformable::Contacts contacts;
  std::vector<Partner> partners;
  deformable::Shape shape;

  // One force call: begin, for each particle gather - the law - apply or circle, finish.
  void begin(int eflag, int vflag);
  template <bool WALLS> void gather(int i);
  template <bool WALLS> void apply(int i, const deformable::Energy &energy);
  void finish();

  // Per-atom results of a deformed particle, and of one that is still a circle.
  void store_shape(int i, double pressure);
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

// Neighbours within the cutoff, then walls, in the order of the list.
template <bool WALLS> void PairDeformable::gather(int i)
{
  const double *const *const x = atom->x;
  const int *const type = atom->type;
  const double xi = x[i][0], yi = x[i][1], ri = radius[type[i]];
  const double *const cutsq_i = cutsq[type[i]];
  const int *const neighbors = list->firstneigh[i];
  const int count = list->numneigh[i];

  int capacity = count;
  if constexpr (WALLS)
    for (const FixDeformableWall *wall : walls) capacity += wall->max_contacts();
  contacts.clear(capacity);
  if (partners.size() < contacts.angle.size()) partners.resize(contacts.angle.size());

  for (int jj = 0; jj < count; ++jj) {
    const int j = neighbors[jj] & NEIGHMASK;
    const double dx = x[j][0] - xi, dy = x[j][1] - yi, rsq = dx * dx + dy * dy;
    if (rsq > cutsq_i[type[j]]) continue;
    const double d = std::sqrt(rsq), per_d = 1.0 / d;
    const deformable::ContactLine line = deformable::contact_line(d, ri, radius[type[j]]);
    if (!(line.height > 0.0)) behind_centre(i, j, d);
    partners[contacts.size] = {j, d, line.d_indentation, per_d};
    contacts.add(std::atan2(dy, dx), dx * per_d, dy * per_d, line.indentation);
  }

  if constexpr (WALLS) {
    const double cutoff = (1.0 + reach) * ri;
    for (std::size_t w = 0; w < walls.size(); ++w)
      walls[w]->visit(i, cutoff, [&](double nx, double ny, double height, double per_lever) {
        partners[contacts.size] = {-1 - static_cast<int>(w), height, -1.0, per_lever};
        contacts.add(std::atan2(ny, nx), nx, ny, ri - height);
      });
  }
}

// Energy and forces of one particle's shape: each contact pushes the particle and its partner apart by
// dU/da da/dd along their line, and turns them by dU/dtheta.
template <bool WALLS> void PairDeformable::apply(int i, const deformable::Energy &energy)
{
  double *const *const f = atom->f;
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
