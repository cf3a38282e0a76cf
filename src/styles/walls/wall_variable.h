// A number of a wall, or an equal-style variable: its place, its speed, its load.
//
// Walls are placed before the forces of a step are computed. A variable of the time is evaluated there. What computes, fixes
// and thermo keywords tell is complete at the end of a step only: a variable that uses them is evaluated there, and holds in
// the next step. Before the first run it has no value.

#ifndef DEFORMABLE_WALL_VARIABLE_H
#define DEFORMABLE_WALL_VARIABLE_H

#include <cmath>
#include <limits>
#include <string>

namespace LAMMPS_NS {

class WallVariable {
 public:
  // A number or v_name, for `what` in messages. Each of these functions returns what is wrong, or nothing.
  std::string read(const std::string &what, const std::string &word, class LAMMPS *);
  std::string init(class LAMMPS *);
  // `goes_on`: a step of a run, not its setup or a minimization, which keep what was known at the end of the step before.
  std::string begin_step(class LAMMPS *, bool goes_on);
  std::string end_step(class LAMMPS *);    // between clearstep_compute and addstep_compute

  bool varies() const { return !name.empty(); }
  bool waits() const { return of_state; }    // for the end of a step
  bool is_known() const { return std::isfinite(now); }

  double now = std::numeric_limits<double>::quiet_NaN();

 private:
  std::string what, name;
  bool of_state = false;
  double next = std::numeric_limits<double>::quiet_NaN();

  std::string evaluate(class LAMMPS *, double &value) const;
};

}    // namespace LAMMPS_NS

#endif
