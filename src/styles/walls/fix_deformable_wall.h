// Walls for deformable particles: fix ID group deformable/wall region-ID [adhesion w] [shear dim v], or words for shapes in the
// place of the region; one side may bear a load: [load F m]; outlines may move: [move v_x v_y v_z] [rotate v_theta Px Py Pz Rx Ry
// Rz].
//
// The pair style asks this fix for the contacts of a particle with the walls, computes the shape with all
// contacts of the particle, and returns the forces of the walls. The fix adds them in post_force.

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/wall,FixDeformableWall);
// clang-format on
#else

#ifndef DEFORMABLE_FIX_DEFORMABLE_WALL_H
#define DEFORMABLE_FIX_DEFORMABLE_WALL_H

#include "fix.h"

#include "laws/contact.h"
#include "styles/walls/walls.h"

#include "atom.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class FixDeformableWall : public Fix {
 public:
  FixDeformableWall(class LAMMPS *, int, char **);
  ~FixDeformableWall() override;
  // LAMMPS takes every fix whose style contains "deform" for a fix deform: Domain::init() crashes if the name
  // begins so. The style of this object therefore has another name.
  static constexpr const char *STYLE = "wall/flat";

  const std::string words;    // that define it

  int setmask() override;
  void init() override;
  void setup(int) override;
  void min_setup(int vflag) override { post_force(vflag); }
  void initial_integrate(int) override;
  void setup_pre_force(int) override;
  void pre_force(int) override { place(true); }
  void min_pre_force(int) override { place(false); }
  void post_force(int) override;
  void min_post_force(int vflag) override { post_force(vflag); }
  void final_integrate() override { kick(); }
  void end_of_step() override;
  double compute_scalar() override;
  double compute_vector(int) override;
  double memory_usage() override;
  void write_restart(FILE *) override;
  void restart(char *) override;

  // Energy that a particle gains for each unit of length of its film with the wall.
  double adhesion() const { return stickiness; }

  // A pair style begins a force call. Only its first call of a step counts: fixes and computes such as fix
  // numdiff ask for more calls, which must not change the forces.
  void begin_call(const class Pair *caller)
  {
    first_call = std::find(callers.begin(), callers.end(), caller) == callers.end();
    if (first_call) callers.push_back(caller);
  }

  // Calls visitor(feature, nearest point) for each wall within (1 + reach) radii of atom i. In the plane the point has n.z = 0,
  // and turns by `turn` only. In space a wall has one feature.
  template <class Visitor> void visit(int i, double radius, double reach, Visitor &&visitor)
  {
    if (!(atom->mask[i] & groupbit)) return;
    constexpr double NARROWEST = 1.0 - 1e-9;    // a round container, but for rounding of its region
    // A wall refuses a center just before the pair style refuses its line, whose message names two atoms.
    constexpr double ABOUT = 1.0 + 1e-12;
    const deformable::RefusedCenter refused =
        walls.visit(center(i), NARROWEST * radius, ABOUT * deformable::NEAREST_LINE * radius,
                    (1.0 + reach) * radius, visitor);
    if (refused.wall >= 0) refuse_center(i, radius, refused);
  }

  // In space: a droplet presses with this force at a point of a wall; `torque`: the derivative of its work by the normal. Returns
  // the force of the wall on it.
  deformable::Vector3 add_contact(int i, int feature, double force,
                                  const deformable::Vector3 &torque,
                                  const deformable::SurfacePoint &, double cutoff);

  // In the plane: the force of a wall on atom i, at (dx, dy) from its point of application to the atom. (tx, ty) is the
  // direction along the wall.
  void add_contact(int i, int feature, double fx, double fy, double dx, double dy, double tx,
                   double ty, double cutoff)
  {
    if (!first_call) return;
    // The derivative of the energy by a strain that shifts and rotates the wall. At a round wall the force across
    // the direction acts at the nearest point; what acts beside it is the force along.
    const double beside = (fx * tx + fy * ty) * (dx * tx + dy * ty);
    add(i, {fx, fy, 0.0},
        {dx * fx - beside * tx * tx, dy * fy - beside * ty * ty, 0.0, dx * fy - beside * tx * ty,
         0.0, 0.0});
    if (!walls.moves) return;
    const double torque = dx * fy - dy * fx;    // about the center, of the force on the wall
    walls.add_force(feature, center(i), tx * fy - ty * fx, {torque * tx, torque * ty, 0.0}, cutoff);
  }

  // The force of friction on atom i, at b from its center. It moves no line: the virial is that of a force at a point.
  void add_friction(int i, const deformable::Vector3 &f, const deformable::Vector3 &b)
  {
    add(i, f,
        {-b.x * f.x, -b.y * f.y, -b.z * f.z, -0.5 * (b.x * f.y + b.y * f.x),
         -0.5 * (b.x * f.z + b.z * f.x), -0.5 * (b.y * f.z + b.z * f.y)});
  }
  deformable::Vector3 way(int feature, const deformable::Vector3 &x) const
  {
    return walls.way(feature, x);
  }
  int first_feature(int feature) const { return walls.first_feature(feature); }
  std::vector<deformable::Scene::Features> feature_names() const { return walls.feature_names(); }
  void do_work(double energy) { walls.do_work(energy); }

 private:
  const int dimension;
  std::string region_id;    // empty: shapes from words
  Region *region = nullptr;
  deformable::Walls walls;
  deformable::Vector3 center(int i) const
  {
    const double *const x = atom->x[i];
    return {x[0], x[1], dimension == 2 ? 0.0 : x[2]};
  }

  double stickiness = 0.0;
  struct {
    int axis = -1;    // none
    deformable::WallVariable speed;
  } shear;
  // A wall that moves by Newton's equation.
  struct {
    double mass = 0.0;    // none
    deformable::WallVariable force;
    double v = 0.0, pushed = 0.0;    // along the axis of the side; by the particles
  } load;

  // Of outlines, as of a region: they turn by an angle about an axis through a point, then they are displaced.
  struct {
    bool is_given = false;
    deformable::WallVariable step[3], angle;
    deformable::Vector3 point{}, axis = {0.0, 0.0, 1.0};
  } ride;

  struct WallForce {
    deformable::Vector3 force;
    std::array<double, 6> virial;    // xx, yy, zz, xy, xz, yz
  };
  // of the present step
  std::vector<WallForce> wall_forces;    // by local index
  void add(int i, const deformable::Vector3 &force, const std::array<double, 6> &virial)
  {
    WallForce &sum = wall_forces[i];
    sum.force = sum.force + force;
    for (int k = 0; k < 6; ++k) sum.virial[k] += virial[k];
  }
  std::vector<const class Pair *> callers;
  bool first_call = false;
  deformable::Vector3 on_wall{};

  void place(bool counts);
  void require(const std::string &problem);
  int read_keywords(int narg, char **arg);
  int read_keyword(int iarg, int narg, char **arg);
  void read_ride(int iarg, char **arg);
  void check_keywords(deformable::Walls &) const;
  deformable::Motion ride_now() const;
  std::vector<deformable::WallVariable *> variables();
  void check_places();
  void kick();
  std::vector<double *> moving_places();
  void read_region();
  void match_region();
  void take(deformable::Walls &&);
  void warn_of_box() const;
  [[noreturn]] void refuse_center(int i, double radius, const deformable::RefusedCenter &);
};

}    // namespace LAMMPS_NS

namespace deformable {

// As the partner of a particle a feature of wall fix w has the code -1 - (w + 256 feature), however many walls there are: IDs and
// local indices are not negative. An int has room for 2^23 features.
constexpr int MOST_WALLS = 256;
inline int wall_code(int wall, int feature)
{
  return -1 - (wall + MOST_WALLS * feature);
}
inline int wall_of(int code)
{
  return (-1 - code) % MOST_WALLS;
}
inline int wall_feature_of(int code)
{
  return (-1 - code) / MOST_WALLS;
}
inline FixDeformableWall &wall_of(int code, const std::vector<FixDeformableWall *> &walls)
{
  return *walls[wall_of(code)];
}

// Calls visitor(code, nearest point) for each wall within (1 + reach) radii of atom i, in the plane and in space.
template <class Visitor>
void visit_walls(const std::vector<FixDeformableWall *> &walls, int i, double radius, double reach,
                 Visitor &&visitor)
{
  for (std::size_t w = 0; w < walls.size(); ++w)
    walls[w]->visit(i, radius, reach, [&](int feature, const SurfacePoint &point) {
      visitor(wall_code(static_cast<int>(w), feature), point);
    });
}

}    // namespace deformable

#endif
#endif
