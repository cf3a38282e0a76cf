// Flat walls for deformable particles: fix ID group deformable/wall region-ID
//
// The pair style asks this fix for the contacts of a particle with the surface of the region, computes the shape
// with all contacts of the particle, and returns the forces of the walls. The fix adds them in post_force.

#ifndef LMP_FIX_DEFORMABLE_WALL_H
#define LMP_FIX_DEFORMABLE_WALL_H

#include "fix.h"

#include "atom.h"
#include "region.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixDeformableWall : public Fix {
 public:
  FixDeformableWall(class LAMMPS *, int, char **);
  // LAMMPS takes every fix whose style contains "deform" for a fix deform: Domain::init() crashes if the name
  // begins so. The style of this object therefore has another name.
  static constexpr const char *STYLE = "wall/flat";

  int setmask() override;
  void init() override;
  void setup(int) override;
  void min_setup(int) override;
  void setup_pre_force(int) override;
  void pre_force(int) override;
  void min_pre_force(int) override;
  void post_force(int) override;
  void min_post_force(int) override;
  double compute_vector(int) override;
  double memory_usage() override;

  // A pair style begins a force call. Only its first call of a step counts: fixes and computes such as fix
  // numdiff ask for more calls, which must not change the forces.
  void begin_call(const class Pair *caller)
  {
    first_call = std::find(callers.begin(), callers.end(), caller) == callers.end();
    if (first_call) callers.push_back(caller);
  }

  // Calls visitor(nx, ny, height, per_lever) for each face within the cutoff of atom i: its direction, its
  // distance, and the rotation of the direction per sideways step of the wall.
  template <class Visitor> void visit(int i, double cutoff, Visitor &&visitor)
  {
    if (!(atom->mask[i] & groupbit)) return;
    const double *x = atom->x[i];
    if (!region->match(x[0], x[1], x[2])) refuse_outside(i);
    int n = region->surface(x[0], x[1], x[2], cutoff);
    if (n > 0 && region->contact[0].radius != 0.0 && !axis_checked) {
      check_axis(x, cutoff, Region::Contact(region->contact[0]));
      n = region->surface(x[0], x[1], x[2], cutoff);
    }
    for (int m = 0; m < n; ++m) {
      const Region::Contact &face = region->contact[m];
      if (face.delx == 0.0 && face.dely == 0.0 && face.delz != 0.0) continue;    // above or below
      if (face.delz != 0.0 || !(face.r > 0.0)) refuse_face(i, face.r);
      visitor(-face.delx / face.r, -face.dely / face.r, face.r, per_lever(face));
    }
  }

  // The force of a wall on atom i. (dx, dy) is the position of the atom relative to the contact point.
  void add_force(int i, double fx, double fy, double dx, double dy)
  {
    if (!first_call) return;
    WallForce &force = wall_forces[i];
    force.fx += fx;
    force.fy += fy;
    force.vxx += dx * fx;
    force.vyy += dy * fy;
    force.vxy += dx * fy;
  }

 private:
  std::string region_id;
  Region *region = nullptr;
  double curvature_factor = 0.0;    // radius of a curved face over Region::Contact::radius
  bool axis_checked = false;

  struct WallForce {
    double fx, fy, vxx, vyy, vxy;
  };
  // of the present step
  std::vector<WallForce> wall_forces;    // by local index
  std::vector<const class Pair *> callers;
  bool first_call = false;
  double on_wall[2] = {0.0, 0.0};

  double per_lever(const Region::Contact &face) const;
  void require_flat(const Region *part, bool outside) const;
  void check_axis(const double *x, double cutoff, const Region::Contact &);
  [[noreturn]] void refuse_outside(int i);
  [[noreturn]] void refuse_face(int i, double distance);
};

}    // namespace LAMMPS_NS

#endif
