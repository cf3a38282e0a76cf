// Rings in the plane: the law of DualSolver whose contacts slip, with lines that are straight or curved, and films.

#ifndef DEFORMABLE_RING_SOLVER_H
#define DEFORMABLE_RING_SOLVER_H

#include "solver/dual_solver.h"

#include "laws/shape.h"
#include "laws/trigonometry.h"

#include <cmath>
#include <vector>

namespace deformable {

class RingSolver : public DualSolver {
 public:
  // curved: contact lines may also tilt and bend
  RingSolver(LAMMPS *lmp, const ForceKernels &kernels, bool curved, double tolerance,
             int max_evaluations);

  // Some contacts may have films: with curved lines only.
  void use_films() override;

  // A particle of infinite kA that cannot keep its area between its contacts, if the forces have grown without a limit
  // or do not exist for that reason; or -1.
  int without_room() const { return crushed; }
  bool lacks_room() const { return lacking; }    // on any rank
  // Nor must they find a particle without room where a wrong pair has stopped them before a solution.
  void forget()
  {
    DualSolver::forget();
    lacking = false;
  }
  int giving_way() const;    // rings of this rank

  // L G' summed over the other contacts of that side's ring, the slope of its outline at the contact.
  double outline_slope(int k, int side) const { return batches.slope[list.pairs.side[side][k]]; }
  // The indentation of this side, with its share of what is left of the overlap: both sides share it by their compliances.
  double indentation(int k, int side) const;

  // The line of a pair: its tilt, the same from both sides, and its half angle, positive where it is convex for the first
  // one [rad]. And the number of lines that would tilt or bend further.
  double tilt(int k) const { return lines ? std::asin(list.pairs.tilt[k]) : 0.0; }
  double half_angle(int k) const { return lines ? 2.0 * std::atan(list.pairs.bend[k]) : 0.0; }
  double limited_lines() const { return lines ? lines->limited : 0.0; }

  double energy() const override;    // of rings and films

  // The rings whose smallest radius of curvature may be negative.
  const std::vector<int> &crowded_rings() const { return crowded; }

  // The state of ring i. The radius of curvature is the smallest one if that is negative, otherwise a lower bound; also
  // negative where films leave no free outline between them.
  struct Ring {
    Energy energy;
    double expansion, arc_radius;
    int contacts;
    double free_radius;    // q, without the skin
  };
  Ring ring(int i) const;

  // Contacts of ring i, their partners, and its shape, whose lengths are those of straight lines. Returns their number.
  int shape_of(int i, std::vector<Contact> &, std::vector<int> &pair_sides, Shape &) const;

  // The length of the line of pair k, of the length L from ring i.
  double line_length(int i, int k, double length) const;

  // The length of the line of pair k, the mean of those that both rings see; after measure_lines() on all ranks.
  double size_of_film(int k) const;
  void measure_lines();

 private:
  // see crowded_rings, without_room and lacks_room
  std::vector<int> crowded;
  int crushed = -1;
  bool lacking = false;
  RingFilms *ring_films = nullptr;    // null: no adhesion
  bool warned_limited = false, warned_films = false;
  std::vector<double> softness;            // by type; of particles and ghosts, if these vary
  std::vector<double> length_per_force;    // of particles and ghosts

  void set_material(const ForceCall &, bool arranged) override;
  void set_units(const ForceCall &);
  bool shape(const RingBatches &) override;
  bool adapt(const RingBatches &, const float *changes, double unit) override;
  void find_slopes(const RingBatches &) override;
  void find_bulges(const ForceCall &) override;
  double bulge_with_films(std::size_t ring, double &lengths) const;
  void warn(const ForceCall &, bool films_changed) override;
  void warn_limited();
  void warn_films();

  struct Crowded {
    int particle = -1;         // none
    double overlaps = -1.0;    // of its contacts, in its radii
    bool keeps_area = false;
  };
  bool has_room() override;
  Crowded find_crushed_here() const;
  bool fits(int i) const;
  bool has_collapsed() const;
  Crowded most_crowded(bool of_bubbles) const;

  // q - (1/pi) sum L: no direction has a smaller radius of curvature
  double arc_radius_at_least(std::size_t ring, double lengths) const
  {
    return batches.free_radius(ring) - lengths * (1.0 / PI);
  }
  double energy_of(std::size_t ring, const LoadedRing &loaded) const
  {
    return loaded.energy(batches.radius[ring], batches.stiffness_of(ring), batches.work[ring]);
  }
};

}    // namespace deformable

#endif
