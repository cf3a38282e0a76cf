// Droplets in space: the law of DualSolver with W of droplet.h.

#ifndef LMP_DROPLET_SOLVER_H
#define LMP_DROPLET_SOLVER_H

#include "solver/dual_solver.h"

#include "kernels/force_kernels.h"

namespace LAMMPS_NS {

class DropletSolver : public DualSolver {
 public:
  DropletSolver(class LAMMPS *lmp, const deformable::ForceKernels &kernels,
                const deformable::DropletKernels &droplets, double tolerance, int max_evaluations);

  // Of a droplet, by local index.
  double load(int i) const { return of_load[batches.place[i]]; }
  double work(int i) const { return batches.work[batches.place[i]]; }
  int contacts_of(int i) const { return batches.count[i]; }
  int place_of_contact(int i, int contact) const
  {
    return batches.contact(batches.place[i], contact);
  }
  int pair_side(int place) const
  {
    return batches.pair_side[place];
  }    // 2 x the pair, + 1 for its second
  double indentation(int place) const { return batches.indentation[place]; }
  // dW/dn of a contact of a pair, over R F.
  deformable::Vector3 turn(int k, int side) const
  {
    const int place = list.pairs.side[side][k];
    return {turns[0][place], turns[1][place], turns[2][place]};
  }

  // Of the last solution: droplets beyond the model, and the largest bulge, over the radius.
  int beyond_model = 0;
  double largest_bulge = 0.0;

  double memory_usage() const;

 private:
  const deformable::DropletKernels &droplets;
  bool warned = false;
  LargeVector<double> tension, of_load, of_facet;               // by droplet
  LargeVector<double> normals[3], force, response, turns[3];    // by contact, see DropletArrays
  LargeVector<float> d_green;

  deformable::DropletArrays arrays();
  deformable::PairForces forces() const;
  bool has_own_compliances() const override { return true; }
  void set_material(const Particles &, bool arranged) override;
  bool shape(const deformable::RingBatches &) override;
  bool adapt(const deformable::RingBatches &, const float *changes, double unit) override;
  bool reshape(const deformable::RingBatches &batch, const float *changes, double unit) override
  {
    return adapt(batch, changes, unit);
  }
  void find_bulges(const Particles &) override;
  double energy() const override;
  void warn(const Particles &, bool films_changed) override;
};

}    // namespace LAMMPS_NS

#endif
