// No-slip walls for beads: fix ID group deformable/stick region-ID k [radius p]
//
// Two springs act on a bead that touches a face of the region: one normal to the face, and one along the face to
// the anchor, the position of the bead at the first touch. The anchor remains until the bead loses contact.

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/stick,FixDeformableStick);
// clang-format on
#else

#ifndef DEFORMABLE_FIX_DEFORMABLE_STICK_H
#define DEFORMABLE_FIX_DEFORMABLE_STICK_H

#include "styles/memory/fix_memory.h"

#include "region.h"

#include <array>
#include <string>
#include <vector>

namespace deformable {

struct Anchor {
  double face = -1.0;         // Region::Contact::iwall; -1: none
  double x = 0.0, y = 0.0;    // position of the bead at the first touch
};
using Anchors = std::array<Anchor, 2>;    // a corner has two faces

}    // namespace deformable

namespace LAMMPS_NS {

class FixDeformableStick : public deformable::FixMemory<deformable::Anchors> {
 public:
  FixDeformableStick(class LAMMPS *, int, char **);

  int setmask() override;
  void init() override;
  void setup(int vflag) override { post_force(vflag); }
  void min_setup(int vflag) override { post_force(vflag); }
  void post_force(int) override;
  void min_post_force(int vflag) override { post_force(vflag); }
  double compute_scalar() override;
  double compute_vector(int) override;

 private:
  std::string region_id;
  Region *region = nullptr;
  double stiffness;
  double given_radius = 0.0;    // 0: from the pair style
  std::vector<double> radii;    // by atom type
  double energy = 0.0;
  double on_wall[2] = {0.0, 0.0};

  deformable::Anchors find_anchors(int i);
  void add_springs(int i, double radius, const Region::Contact &face,
                   const deformable::Anchor &anchor);
  [[noreturn]] void refuse(int i, const std::string &problem);
};

}    // namespace LAMMPS_NS

#endif
#endif
