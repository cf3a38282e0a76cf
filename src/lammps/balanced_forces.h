// Balanced contacts of all rings: from positions to forces of pairs and shapes of rings.

#ifndef LMP_BALANCED_FORCES_H
#define LMP_BALANCED_FORCES_H

#include "pointers.h"

#include "force_batches.h"
#include "force_solver.h"
#include "near_list.h"

#include "shape.h"

#include <vector>

namespace LAMMPS_NS {

class BalancedForces : protected Pointers {
 public:
  BalancedForces(class LAMMPS *lmp, const deformable::ForceKernels &kernels, double tolerance,
                 int max_evaluations)
      : Pointers(lmp),
        kernels(kernels),
        near(lmp, kernels),
        solver(lmp, kernels, tolerance, max_evaluations)
  {
  }

  // Returns -1, or a pair whose contact line cannot lie between the centers.
  int solve(const DeformableParticles &, bool new_list);

  const NearPairs &pairs() const { return near.pairs; }
  int evaluations() const { return solver.evaluations; }
  double imbalance() const { return solver.imbalance; }

  // A particle of infinite kA that cannot keep its area between its contacts, if the forces have grown without a limit
  // for that reason; or -1.
  int without_room() const;

  // What is left of the overlap of a pair: both sides share it by their compliances.
  double residual(int k) const { return solver.residuals()[k]; }
  // After solve: L G' summed over the other contacts of that side's ring, the slope of its outline at the contact.
  double outline_slope(int k, int side) const { return batches.product[near.pairs.side[side][k]]; }

  // Of ring i. The radius of curvature is the smallest one if that is negative, otherwise a lower bound.
  struct Ring {
    deformable::Energy energy;
    double expansion, arc_radius;
    int contacts;
  };
  Ring ring(int i) const;

  // Contacts of ring i, their partners, and its shape. Returns their number.
  int shape_of(int i, std::vector<deformable::Contact> &, std::vector<int> &seats,
               deformable::Shape &) const;

  double memory_usage() const;

 private:
  const deformable::ForceKernels &kernels;
  NearList near;
  ForceBatches batches;
  ForceSolver solver;
  bool is_balanced = false, warned = false;

  void arrange(const DeformableParticles &);
  void set_material(const DeformableParticles &);
  void find_bulges();
  int collapsed() const;
  void warn_unbalanced();
};

}    // namespace LAMMPS_NS

#endif
