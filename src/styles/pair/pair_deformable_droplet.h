// Droplets in three dimensions: pair_style deformable/droplet [reach f] [balance tol maxiter] [radius type|atom]

#ifdef PAIR_CLASS
// clang-format off
PairStyle(deformable/droplet,PairDeformableDroplet);
// clang-format on
#else

#ifndef DEFORMABLE_PAIR_DEFORMABLE_DROPLET_H
#define DEFORMABLE_PAIR_DEFORMABLE_DROPLET_H

#include "styles/pair/pair_deformable.h"

#include "solver/droplet_solver.h"
#include "styles/species.h"

#include <memory>

namespace LAMMPS_NS {

class PairDeformableDroplet : public PairDeformable {
 public:
  PairDeformableDroplet(class LAMMPS *lmp) : PairDeformable(lmp, 6, 3) {}
  void settings(int, char **) override;
  std::string law() const override { return "deformable/droplet"; }
  void coeff(int, char **) override;
  void init_style() override;
  void *extract(const char *, int &) override;
  void compute(int, int) override;
  void list_contacts(int groupbit, std::vector<double> &rows) const override;
  double memory_usage() override;
  double energy_alone(int i, int partner, double force) const override;
  bool knows_energy_alone() const override { return true; }
  void accept_imbalance(double force) override { solver->accepted = force; }
  void check_state() const override;

 protected:
  void check_species(const deformable::Species &) const override;
  bool bends_lines() const override { return true; }
  void use_films() override { solver->use_films(); }
  void check_films(const std::vector<deformable::Species> &,
                   const deformable::Adhesions &) const override;
  std::string invalid_at_wall(double adhesion, int i) const override;
  const char *what_is_beyond() const override
  {
    if (films)
      return "their contact angles are above 0.7 rad, their films cover more than half of their "
             "surface or meet, or forces cover more than 0.4 of it. That is outside of the range "
             "of the theory; their";
    return "forces cover more than 0.4 of their surface with facets, or, where contacts are few "
           "and strong, more than 0.05 with the mean facet. Such loads are outside of the range of "
           "the theory; their";
  }

 private:
  std::unique_ptr<deformable::DropletSolver> solver;

  void check_room();
  double impossible = 0.0;    // energy of the last call, if it was below that of spheres
  void check_energy(double of_overlaps);
  void solve(bool new_material);
  double push(int begin, int end, double part, bool is_final);    // see DualSolver::Push
  double facet_of(int k, int i) const;
  void finish_droplets();
  void load_contacts();
  void store_droplet(int i, double energy);
  deformable::Vector3 torque(int k, int side) const;
  deformable::Vector3 force_of_contact(int k, int side) const;
  double film_curvature(int i, int j) const;
};

// The derivative of a droplet's work by the normal of this contact, across it.
inline deformable::Vector3 PairDeformableDroplet::torque(int k, int side) const
{
  return deformable::across(solver->torque(k, side), solver->pairs().normal(k));
}

}    // namespace LAMMPS_NS

#endif
#endif
