// Flat walls for deformable particles: fix ID group deformable/wall region-ID
//
// The pair style asks for a particle's contacts with the region's surface, shapes the particle by all its
// contacts at once and hands the wall's share of the force back; the fix adds it where fixes do.

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
  // The style name of the object: LAMMPS takes every fix whose style contains "deform" for a fix deform. It
  // crashes in Domain::init() where a style begins so, and counts the others as second ones beside it.
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

  // A pair style is about to compute. Only its first call of a step acts on the particles: others that
  // fixes and computes ask for (fix numdiff) leave the forces of that one alone.
  void begin_call(const class Pair *caller)
  {
    listening = std::find(heard.begin(), heard.end(), caller) == heard.end();
    if (listening) heard.push_back(caller);
  }

  // Calls visit(nx, ny, height, per_lever) for each face within the cutoff of atom i: the direction to
  // it, its distance, and how much the direction turns per sideways step of the wall.
  template <class Visitor> void visit(int i, double cutoff, Visitor &&visitor)
  {
    if (!(atom->mask[i] & groupbit)) return;
    const double *x = atom->x[i];
    if (!region->match(x[0], x[1], x[2])) outside(i);
    int n = region->surface(x[0], x[1], x[2], cutoff);
    if (n > 0 && region->contact[0].radius != 0.0 && !axis_checked) {
      check_axis(x, cutoff, Region::Contact(region->contact[0]));
      n = region->surface(x[0], x[1], x[2], cutoff);
    }
    for (int m = 0; m < n; ++m) {
      const Region::Contact &face = region->contact[m];
      if (face.delx == 0.0 && face.dely == 0.0 && face.delz != 0.0) continue;    // above or below
      if (face.delz != 0.0 || !(face.r > 0.0)) unusable(i, face.r);
      visitor(-face.delx / face.r, -face.dely / face.r, face.r, per_lever(face));
    }
  }

  // The wall's force on atom i, through a face at (dx, dy) from which the atom's centre lies.
  void press(int i, double fx, double fy, double dx, double dy)
  {
    if (!listening) return;
    Push &push = pushes[i];
    push.fx += fx;
    push.fy += fy;
    push.vxx += dx * fx;
    push.vyy += dy * fy;
    push.vxy += dx * fy;
  }

 private:
  std::string region_id;
  Region *region = nullptr;
  double curvature_factor = 0.0;    // the radius of a curved face per Region::Contact::radius
  bool axis_checked = false;

  struct Push {
    double fx, fy, vxx, vyy, vxy;
  };
  std::vector<Push> pushes;                 // by local index, of the present step
  std::vector<const class Pair *> heard;    // in the present step
  bool listening = false;
  double on_wall[2] = {0.0, 0.0};

  double per_lever(const Region::Contact &face) const;
  void require_flat(const Region *part, bool outside) const;
  void check_axis(const double *x, double cutoff, const Region::Contact &);
  [[noreturn]] void outside(int i);
  [[noreturn]] void unusable(int i, double distance);
};

}    // namespace LAMMPS_NS

#endif
