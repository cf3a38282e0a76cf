// The rates of a box that fix deform changes.

#ifndef DEFORMABLE_BOX_RATE_H
#define DEFORMABLE_BOX_RATE_H

#include "styles/lammps_names.h"

namespace deformable {

// How fast the box changes, which velocities take across its boundaries with remap v.
//
// Some releases of LAMMPS give a side of fix deform/pressure, or a side at constant volume, its rate of strain in place of the
// rate of its length, dL/dt. Here rates are measured by how the box has changed. From its first change on they replace LAMMPS'.
class BoxRate : protected Pointers {
 public:
  explicit BoxRate(LAMMPS *lmp) : Pointers(lmp) {}

  void begin_run();
  void measure();     // before velocities are sent to ghosts
  void remember();    // after the box has flipped, before it changes
  void end_run();

 private:
  struct Box {
    double low[3], h[6];
    bool operator==(const Box &) const;
  };
  Box present() const;
  Box before{}, at_end{};
  bigint step = -1;    // of `before`
};

}    // namespace deformable

#endif
