// No-slip walls for beads: fix ID group deformable/stick region-ID k [radius p]
//
// Two springs act on a bead that touches a face of the region: one normal to the face, and one along the face to
// the anchor, the position of the bead at the first touch. The anchor remains until the bead loses contact.

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/stick,FixDeformableStick);
// clang-format on
#else

#ifndef LMP_FIX_DEFORMABLE_STICK_H
#define LMP_FIX_DEFORMABLE_STICK_H

#include "fix.h"

#include "region.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixDeformableStick : public Fix {
 public:
  FixDeformableStick(class LAMMPS *, int, char **);
  ~FixDeformableStick() override;

  int setmask() override;
  void init() override;
  void setup(int) override;
  void min_setup(int) override;
  void post_force(int) override;
  void min_post_force(int) override;
  double compute_scalar() override;
  double compute_vector(int) override;

  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;
  double memory_usage() override;

 private:
  static constexpr int NO_FACE = -1;

  struct Anchor {
    int face = NO_FACE;         // Region::Contact::iwall
    double x = 0.0, y = 0.0;    // position of the bead at the first touch
  };
  using Anchors = std::array<Anchor, 2>;    // a corner has two faces

  std::string region_id;
  Region *region = nullptr;
  double stiffness;
  double given_radius = 0.0;       // 0: from the pair style
  std::vector<double> radii;       // by atom type
  std::vector<Anchors> anchors;    // by local index
  double energy = 0.0;
  double on_wall[2] = {0.0, 0.0};

  Anchors find_anchors(int i);
  void add_springs(int i, double radius, const Region::Contact &face, const Anchor &anchor);
  [[noreturn]] void refuse(int i, const std::string &problem);
};

}    // namespace LAMMPS_NS

#endif
#endif
