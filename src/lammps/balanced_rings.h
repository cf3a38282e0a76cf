// Rings with balanced contacts: from contacts on their radical axes, and a function that shapes one ring, to balanced
// indentations, shapes and forces of all rings. The energy is stationary in the positions of the contact lines, so
// that forces do not depend on how the lines follow the particles.

#ifndef LMP_BALANCED_RINGS_H
#define LMP_BALANCED_RINGS_H

#include "contact_balance.h"

#include "neigh_list.h"

#include <algorithm>
#include <vector>

namespace LAMMPS_NS {

class BalancedRings : protected Pointers {
 public:
  BalancedRings(class LAMMPS *, double tolerance, int max_evaluations);

  // Shapes all rings of the list. Before, the table holds contacts on their radical axes; afterwards, balanced
  // ones. shape_ring(i, contacts) fills `shape` and returns the energy. ring_of(i) returns radius and stiffness.
  struct Ring {
    double radius;
    deformable::Stiffness stiffness;
  };
  template <class ShapeRing, class RingOf>
  void solve(const NeighList *list, bool new_list, ContactTable &table,
             const deformable::Shape &shape, ShapeRing &&shape_ring, RingOf &&ring_of);

  // Ring i as balanced: fills its shape and returns its energy.
  deformable::Energy result(int i, const ContactTable &, deformable::Shape &) const;

  int evaluations() const { return balance.evaluations; }    // of all shapes, in the last call
  double imbalance() const { return balance.imbalance; }     // of forces, over the largest force

  double memory_usage() const;

 private:
  ContactBalance balance;
  bool warned = false;

  struct ShapedRing {
    double area_deficit, perimeter_excess, arc_radius, largest_force;
    deformable::Energy energy;
  };
  std::vector<ShapedRing> shaped;                 // by particle
  std::vector<deformable::Response> responses;    // by place in the table
  std::vector<double> radical;                    // indentations, by place in the table

  void begin(const ContactTable &);
  void warn_unbalanced();
  void store(int i, int contacts, std::size_t first, const deformable::Shape &shape,
             deformable::Energy energy)
  {
    const int sides = balance.sides_of(i);
    double largest_force = 0.0;
    std::copy_n(shape.contact.data(), contacts, responses.data() + first);
    for (int c = 0; c < contacts; ++c) {
      const double force = energy.derivative * shape.contact[c].length;
      largest_force = std::max(largest_force, force);
      if (c < sides) balance.set_force(i, c, force);
    }
    shaped[i] = {shape.area_deficit, shape.perimeter_excess, shape.arc_radius, largest_force,
                 energy};
  }
};

template <class ShapeRing, class RingOf>
void BalancedRings::solve(const NeighList *list, bool new_list, ContactTable &table,
                          const deformable::Shape &shape, ShapeRing &&shape_ring, RingOf &&ring_of)
{
  begin(table);
  const auto shape_rings = [&](const char *selected) {
    ContactBalance::Totals totals = {0.0, 0.0};
    for (int ii = 0; ii < list->inum; ++ii) {
      const int i = list->ilist[ii];
      if (selected[i]) {
        const deformable::Contacts contacts = table.of(i);
        const std::size_t first = contacts.size > 0 ? table.first(i) : 0;
        const int sides = balance.sides_of(i);
        for (int c = 0; c < sides; ++c)
          table.contact[first + c].indentation = radical[first + c] + balance.shift(i, c);
        store(i, contacts.size, first, shape, shape_ring(i, contacts));
      }
      totals.energy += shaped[i].energy.value;
      totals.largest_force = std::max(totals.largest_force, shaped[i].largest_force);
    }
    return totals;
  };
  const auto state_of = [&](int i) {
    const Ring ring = ring_of(i);
    return deformable::RingState{
        ring.radius,    shaped[i].perimeter_excess / (2.0 * deformable::PI),
        ring.stiffness, shaped[i].energy.derivative,
        table.of(i),    &responses[table.first(i)]};
  };
  if (!balance.solve(table, new_list, shape_rings, state_of)) warn_unbalanced();
}

}    // namespace LAMMPS_NS

#endif
