// What a restart file was written with: laws, species, friction and walls. The pair styles make this fix, with the ID
// deformable_restart: fix ID all deformable/restart. Before the first run after read_restart it warns of what differs. And where a
// step ends it asks the pair styles whether its state can be.

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/restart,FixDeformableRestart);
// clang-format on
#else

#ifndef DEFORMABLE_FIX_DEFORMABLE_RESTART_H
#define DEFORMABLE_FIX_DEFORMABLE_RESTART_H

#include "fix.h"

#include <map>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixDeformableRestart : public Fix {
 public:
  FixDeformableRestart(class LAMMPS *, int, char **);
  static constexpr const char *STYLE = "store/words";    // see FixDeformableWall
  static constexpr const char *ID = "deformable_restart";

  int setmask() override { return FixConst::END_OF_STEP; }
  void init() override;
  void setup(int) override { end_of_step(); }
  void end_of_step() override;
  void write_restart(FILE *) override;
  void restart(char *) override;

 private:
  using Words = std::map<std::string, std::string>;
  std::vector<class PairDeformable *> pairs;
  Words then;    // of the file; empty after the first run
  Words now() const;
};

}    // namespace LAMMPS_NS

#endif
#endif
