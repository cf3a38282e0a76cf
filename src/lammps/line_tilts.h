// Contact lines that tilt until the torques of both rings balance.
//
// The line of a pair at distance d is at rest where d sin(tilt) = t_i + t_j, with the slopes t of both outlines (tilt.h).
// This is where its energy is smallest or, if it bears no force, where the outlines would touch first. The slopes depend
// on the tilts in turn: Newton's method for each pair alone, with all forces as they are, needs few steps. The imbalance
// of a line is the torque on it over d, a force.
//
// A line that bears a force and would tilt by more than 0.3 rad, or leave the gap between the centers, stays
// perpendicular to the line of centers as long as it bears a force.

#ifndef LMP_LINE_TILTS_H
#define LMP_LINE_TILTS_H

#include "force_batches.h"
#include "near_pairs.h"

#include <vector>

namespace LAMMPS_NS {

class LineTilts {
 public:
  // Extrapolates the tilts of the last calls, which the pairs have.
  static void predict(NearPairs &, const deformable::ForceKernels &, const double *coefficients);

  // Of pairs that do not tilt yet: their lines take the first of the past tilts.
  void start(NearPairs &, ForceBatches &, const deformable::ForceKernels &);

  // The rates of the slopes, by contact.
  double *rates() { return rate.data(); }

  // Finds the next tilts from slopes and rates. Returns the largest imbalance.
  double find(NearPairs &, ForceBatches &, const deformable::ForceKernels &);

  // All lines take the tilts found last, or keep them for the next call.
  void turn(NearPairs &, ForceBatches &, const deformable::ForceKernels &);
  void remember(NearPairs &);

  // For the next solution: a line that must not tilt. Of the last one: the lines that bear a force without a tilt.
  static void keep_upright(NearPairs &, int k);
  bool is_upright(int k) const { return turns[k] == 0.0; }
  bool any_upright = false;    // on this rank

  double bytes() const { return bytes_of(next, turns, rate); }

 private:
  std::vector<double> next, turns, rate;    // see LineArrays
  deformable::LineArrays arrays(NearPairs &, ForceBatches &);
};

}    // namespace LAMMPS_NS

#endif
