// Balanced contacts of all rings: from positions to forces of pairs and shapes of rings.

#ifndef LMP_BALANCED_FORCES_H
#define LMP_BALANCED_FORCES_H

#include "pointers.h"

#include "solver/force_batches.h"
#include "solver/force_solver.h"
#include "solver/near_list.h"

#include "laws/shape.h"
#include "laws/trigonometry.h"

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

namespace LAMMPS_NS {

class BalancedForces : protected Pointers {
 public:
  // curved: contact lines may also tilt and bend
  BalancedForces(class LAMMPS *lmp, const deformable::ForceKernels &kernels, bool curved,
                 double tolerance, int max_evaluations)
      : Pointers(lmp),
        kernels(kernels),
        near(lmp, kernels, curved),
        solver(lmp, kernels, curved, tolerance, max_evaluations)
  {
  }

  // Some contacts may stick: with curved lines only.
  void stick();

  // Returns false on all ranks if one goes no further: a wall has refused a center, or this pair has a contact line that cannot
  // lie between the centers. Where pairs attach or let go, calls before_change() once, while forces are those before.
  bool solve(const DeformableParticles &, bool new_list,
             const std::function<void()> &before_change);

  // After solve: calls act(begin, end) for all pairs, which then also know the slopes of outlines.
  template <class Act> void finish(Act &&act) { solver.finish(act); }

  int refused_pair() const { return wrong; }    // or -1

  const NearPairs &pairs() const { return near.pairs; }
  int evaluations() const { return solver.evaluations(); }
  double imbalance() const { return solver.imbalance; }

  // A particle of infinite kA that cannot keep its area between its contacts, if the forces have grown without a limit
  // or do not exist for that reason; or -1.
  int without_room() const { return crushed; }
  bool lacks_room() const { return lacking; }    // on any rank

  int giving_way() const;

  // For calls after an error that the caller has caught: they must not start from forces without bound.
  void forget();

  // What is left of the overlap of a pair: both sides share it by their compliances.
  double residual(int k) const { return solver.left(k); }
  // What a pair adds to the energy of its rings: then errors of forces and lines matter in second order only.
  double energy_left(int k) const { return solver.energy_left(k); }
  // After finish: L G' summed over the other contacts of that side's ring, the slope of its outline at the contact.
  double outline_slope(int k, int side) const { return batches.slope[near.pairs.side[side][k]]; }

  // Of this side, with its share of what is left.
  double indentation(int k, int side) const;

  // The line of a pair: its tilt, the same from both sides, and its half angle, positive where it is convex for the first
  // one [rad]. And the number of lines that would tilt or bend further.
  double tilt(int k) const { return near.pairs.curved ? std::asin(near.pairs.tilt[k]) : 0.0; }
  double half_angle(int k) const
  {
    return near.pairs.curved ? 2.0 * std::atan(near.pairs.bend[k]) : 0.0;
  }
  double limited_lines() const { return solver.limited_lines(); }

  // Of all rings of this rank, and their films. What is left of the overlaps is not in it.
  double energy() const;

  // That attaching and letting go have cost in this call, on all ranks.
  double lost_energy() const { return lost; }

  // The rings whose smallest radius of curvature may be negative.
  const std::vector<int> &crowded_rings() const { return crowded; }

  // Of ring i. The radius of curvature is the smallest one if that is negative, otherwise a lower bound; also negative
  // where films leave no free outline between them.
  struct Ring {
    deformable::Energy energy;
    double expansion, arc_radius;
    int contacts;
  };
  Ring ring(int i) const;

  // Contacts of ring i, their partners, and its shape, whose lengths are those of straight lines. Returns their number.
  int shape_of(int i, std::vector<deformable::Contact> &, std::vector<int> &seats,
               deformable::Shape &) const;

  // The length of the line of pair k, of the length L from ring i.
  double line_length(int i, int k, double length) const;

  double memory_usage() const;

 private:
  const deformable::ForceKernels &kernels;
  NearList near;
  ForceBatches batches;
  ForceSolver solver;
  std::unique_ptr<Films> films;    // null: no contact sticks
  double lost = 0.0;
  std::vector<int> crowded;
  int crushed = -1, wrong = -1;
  bool lacking = false;
  struct Crowded {
    int particle = -1;         // none
    double overlaps = -1.0;    // of its contacts, in its radii
    bool keeps_area = false;
  };
  void find_crushed();
  Crowded find_crushed_here() const;
  bool fits(int i) const;
  bool is_balanced = false, warned = false, warned_limited = false, warned_films = false;

  void arrange(const DeformableParticles &, bool new_list);
  void set_material(const DeformableParticles &);
  // q - (1/pi) sum L: no direction has a smaller radius of curvature
  double arc_radius_at_least(std::size_t ring, double lengths) const
  {
    return batches.free_radius(ring) - lengths * (1.0 / deformable::PI);
  }
  double total_energy() const;
  double bulge_with_films(std::size_t ring, double &lengths) const;
  double energy_of(std::size_t ring, const deformable::LoadedRing &loaded) const
  {
    return loaded.energy(batches.radius[ring], batches.stiffness(ring), batches.work[ring]);
  }
  void find_bulges();
  bool has_collapsed() const;
  Crowded most_crowded(bool of_bubbles) const;
  void warn_unbalanced();
  void warn_limited();
  void warn_films();
};

}    // namespace LAMMPS_NS

#endif
