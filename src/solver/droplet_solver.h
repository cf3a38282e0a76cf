// Droplets in space: the law of DualSolver with W of droplet.h and, where droplets stick, of droplet_film.h.

#ifndef DEFORMABLE_DROPLET_SOLVER_H
#define DEFORMABLE_DROPLET_SOLVER_H

#include "solver/droplet_films.h"
#include "solver/dual_solver.h"

#include "kernels/batch_kernels.h"

namespace deformable {

class DropletSolver : public DualSolver {
 public:
  DropletSolver(LAMMPS *lmp, const BatchKernels &kernels, double tolerance, int max_evaluations);

  void use_films() override;

  // What a droplet bears, by its local index.
  double load(int i) const { return of_load[batches.place[i]]; }
  double work(int i) const { return batches.work[batches.place[i]]; }
  int contacts_of(int i) const { return batches.count[i]; }
  int place_of_contact(int i, int contact) const
  {
    return batches.contact(batches.place[i], contact);
  }
  // 2 x the pair, + 1 for its second droplet
  int pair_side(int place) const { return batches.pair_side[place]; }
  double indentation(int place) const { return batches.indentation[place]; }
  // Where there are films: the radius of that of a pair, or of its facet. And 1 - cos of the angle at which an outline meets it.
  double film_radius(int k) const { return droplet_films->film_radius(k); }
  double film_rise(int place) const { return droplet_films ? droplet_films->rise_of(place) : 0.0; }
  bool bears(int k) const { return list.pairs.force[k] != 0.0 || is_attached(k); }
  bool is_attached(int k) const { return films && list.pairs.adhesion[k] > 0.0; }
  // The derivative of all works by the normal of a contact of a pair.
  Vector3 torque(int k, int side) const
  {
    const int place = list.pairs.side[side][k];
    return {torques[0][place], torques[1][place], torques[2][place]};
  }
  // How the normal of a film turns against the line of centers, from the first droplet of a pair: -[(R t)_i - (R t)_j]/d.
  Vector3 tilt(int k) const;

  // The largest bulge of the last solution, over the radius; and its droplets beyond the model.
  double largest_bulge = 0.0;
  int beyond_model();

  double memory_usage() const;

 private:
  const BatchKernels &all_kernels;
  const DropletKernels *droplets;           // with films or without
  DropletFilms *droplet_films = nullptr;    // null: no adhesion
  // see DropletArrays: by droplet, by contact, by two contacts
  LargeVector<double> tension, of_load, of_facet, still_work;
  LargeVector<double> film_log, per_radii, still, normals[3], force, facets[3], damping, torques[3];
  LargeVector<double> green, green2, d_green;
  LargeVector<float> taken;

  DropletArrays arrays();
  bool has_own_compliances() const override { return true; }
  void set_material(const ForceCall &, bool arranged) override;
  bool shape(const RingBatches &) override;
  bool adapt(const RingBatches &, const float *, double) override;
  bool reshape(const RingBatches &batch, const float *, double) override
  {
    return adapt(batch, nullptr, 0.0);
  }
  bool has_facets() const override { return true; }
  void turn_facets(const RingBatches &) override;
  void exchange_facets() override;
  double bulge_of(std::size_t row, double radius) const;
  void find_slopes(const RingBatches &) override;
  void find_films(const ForceCall &);
  void find_bulges(const ForceCall &) override;
  double energy() const override;
  void warn(const ForceCall &, bool) override { warn_unbalanced("deformable/droplet"); }
};

}    // namespace deformable

#endif
