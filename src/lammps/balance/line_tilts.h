// Contact lines that tilt until the torques of both rings balance.
//
// The line of a pair at distance d is at rest where d sin(tilt) = t_i + t_j, with the slopes t of both outlines (tilt.h).
// This is where its energy is smallest or, if it bears no force, where the outlines would touch first. The slopes depend
// on the tilts in turn: Newton's method for each pair alone, with all forces as they are, needs few steps. The imbalance
// of a line is the torque on it over d, a force.
//
// No line tilts by more than 0.3 rad. At the limit the energy is smallest over the tilts that are allowed, so it has no
// jump there. Beyond the model the tilts may have several solutions: which one is found then depends on the past.

#ifndef LMP_LINE_TILTS_H
#define LMP_LINE_TILTS_H

#include "force_batches.h"
#include "near_pairs.h"
#include "remote_sides.h"

#include <vector>

namespace LAMMPS_NS {

class LineTilts {
 public:
  explicit LineTilts(const deformable::ForceKernels &kernels) : kernels(kernels) {}

  // Lines of the last solution that bear a force at the limit. A line that two ranks share counts half on each.
  double limited = 0.0;

  void arrange(ForceBatches &, NearPairs &, RemoteSides &);    // contacts are new

  // Extrapolates the tilts of the last calls, which the pairs have.
  void predict(const deformable::Extrapolation &);

  // Of pairs that do not tilt yet: their lines take the first of the past tilts.
  void begin();

  // The largest imbalance of a tilt for the present forces, on all ranks. Also finds the next tilts.
  double imbalance();

  // Steps become shorter where imbalances do not fall, and longer again where they do.
  void adapt(double imbalance);

  // All lines take the tilts found last, or keep them for the next call.
  void turn();
  void remember();

  double bytes() const { return bytes_of(next, rate); }

 private:
  const deformable::ForceKernels &kernels;
  NearPairs *pairs = nullptr;
  ForceBatches *batches = nullptr;
  RemoteSides *remote = nullptr;
  std::vector<double> next, rate;    // see LineArrays; rates of slopes, by contact
  double part = 1.0, last_imbalance = 0.0;
  deformable::LineArrays arrays();
};

}    // namespace LAMMPS_NS

#endif
