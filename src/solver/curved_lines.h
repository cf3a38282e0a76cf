// Contact lines that tilt until the torques of both rings balance, and bend until their pressures do.
//
// The line of a pair at distance d is at rest where d sin(tilt) = t_i + t_j, with the slopes t of both outlines, and where
// its curvature is (p_i - p_j)/(T_i + T_j), with the tensions T of the outlines (contact_curve.h). This is where its energy
// is smallest or, if it bears no force, where the outlines would touch first. Slopes and pressures depend on tilts and
// bends in turn: Newton's method for each line alone, with all forces as they are, needs few steps. The imbalance of a
// line is a force: the torque on it over d, or what the change of its curvature would do to the force of the pair.
//
// No line tilts by more than 0.3 rad, or bends by more than 30 degrees. At the limit the energy is smallest over the lines
// that are allowed, so it has no jump there. Beyond the model the tilts may have several solutions: which one is found then
// depends on the past. Lines of walls stay where they are.

#ifndef LMP_CURVED_LINES_H
#define LMP_CURVED_LINES_H

#include "solver/contact_batches.h"
#include "solver/films.h"
#include "solver/near_pairs.h"
#include "solver/remote_sides.h"

#include <vector>

namespace LAMMPS_NS {

class CurvedLines {
 public:
  explicit CurvedLines(const deformable::ForceKernels &kernels) : kernels(kernels) {}

  Films *films = nullptr;    // of adhesive contacts

  // Lines of the last solution that bear a force at a limit. A line that two ranks share counts half on each.
  double limited = 0.0;

  void arrange(ContactBatches &, NearPairs &, RemoteSides &);    // contacts are new

  // Extrapolates tilts and bends of the last two calls, which the pairs have: by this part of their difference.
  void predict(double slope);

  // Of pairs that are straight yet: their lines take the first of the past tilts and bends.
  void begin();

  // All lines are straight, and perpendicular to lines of centers; held: they stay so in this solution.
  void straighten(bool held);

  // The largest imbalance of a line for the present forces, on all ranks. Also finds the next tilts and bends.
  double imbalance();

  // Steps become shorter where imbalances do not fall, and longer again where they do.
  void adapt(double imbalance);

  // All lines take the tilts and bends found last, or keep them for the next call.
  void take();
  void remember();

  // The energy that pairs add to those of their rings, whose error is then of second order: for what is left of the
  // balance, the bend of a pair makes the chords of both sides differ.
  double energy_left(int k) const;

  double bytes() const
  {
    return bytes_of(next_sine, next_bend, slope_rate, per_pressure, free_radius);
  }

 private:
  const deformable::ForceKernels &kernels;
  NearPairs *pairs = nullptr;
  ContactBatches *batches = nullptr;
  RemoteSides *remote = nullptr;
  std::vector<double> next_sine, next_bend;                     // see LineArrays
  std::vector<double> slope_rate, per_pressure, free_radius;    // see OutlineArrays
  double part = 1.0, last_imbalance = 0.0;
  bool held = false;
  bool is_held(int k) const;
  deformable::OutlineArrays outline();
  deformable::LineArrays arrays();
};

}    // namespace LAMMPS_NS

#endif
