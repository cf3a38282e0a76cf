// How fast the box changes, which velocities take across its boundaries with remap v.
//
// Some releases of LAMMPS give the sides of fix deform/pressure, and those at constant volume, their rate of strain in the
// place of that of their length, dL/dt. Here the rates are those by which the box has changed: they take the place of LAMMPS'
// from the first change of the box on.

#ifndef LMP_BOX_RATE_H
#define LMP_BOX_RATE_H

#include "pointers.h"

namespace LAMMPS_NS {

class BoxRate : protected Pointers {
 public:
  explicit BoxRate(class LAMMPS *lmp) : Pointers(lmp) {}

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

}    // namespace LAMMPS_NS

#endif
