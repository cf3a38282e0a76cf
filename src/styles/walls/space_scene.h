// The walls of one fix in space at the present time: the nearest points of a droplet, and the work that walls do.

#ifndef DEFORMABLE_SPACE_SCENE_H
#define DEFORMABLE_SPACE_SCENE_H

#include "geometry/surface.h"
#include "styles/walls/wall_shapes.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

class SpaceScene {
 public:
  // Takes the walls and computes them at the present time.
  std::string assign(WallSources &&);
  bool moves() const { return moving; }

  // Computes the walls anew where their regions are now. Returns what is wrong, or nothing.
  std::string update();
  // Edges of the box as rows, for obstacles that repeat with it; 0 along an axis that is not periodic.
  using Period = std::array<deformable::Vector3, 3>;
  Period period{};

  // The first wall of a container that lies outside of these bounds in x, y or z, or -1. Straight walls may cut a round one.
  int first_outside(int axis, double low, double high) const;

  // Calls visitor(wall, nearest point) for each wall within the cutoff of a center. Returns the first wall that has the center on
  // its wrong side, or nearer than `nearest`, or that is round and narrower than
  // `narrowest`, if any.
  template <class Visitor>
  RefusedCenter visit(const deformable::Vector3 &x, double narrowest, double nearest, double cutoff,
                      Visitor &&visitor) const
  {
    const int count = static_cast<int>(walls.size());
    for (int w = 0; w < count; ++w) {
      const Wall &wall = walls[w];
      deformable::SurfacePoint point;
      if (wall.kind == WallSource::RIM && wall.room(x) < narrowest)
        return {wall.source, 0.0, wall.room(x)};
      if (wall.kind == WallSource::FACE)
        point = nearest_on_plane(wall.face, x);
      else if (!locate(wall, x, cutoff, point))
        continue;
      if (!(point.height > nearest)) return {wall.source, point.height};
      if (point.height < cutoff) visitor(w, point);
    }
    return {-1, 0.0};
  }

  // A droplet at x bears this force at a wall; `torque`: the derivative of its work by the normal.
  void add_force(int wall, const deformable::Vector3 &x, double force,
                 const deformable::Vector3 &torque, double cutoff)
  {
    loads.push_back({wall, x, force, torque, cutoff});
  }
  // The energy that droplets have given to moving walls since the scene was made. A wall that moves while droplets stay changes
  // their energy by -F dh - torque.dn: half of it counts with the forces before a step, half of it with those after it, which is
  // exact to the second order in the step. A wall that was infinitely far away does no work.
  void begin_step(bool counts);    // after update()
  void end_step();
  double energy_given() const { return given; }

  void restore(double energy) { given = energy; }

  const WallSource &source(int wall) const { return sources.walls[wall]; }
  WallSources sources;
  double memory_usage() const;

 private:
  struct Wall {
    WallSource::Kind kind;
    int source;
    bool is_ball;
    deformable::HalfSpace face;
    deformable::Vector3 center;    // of a ball
    double radius;
    deformable::Revolution body;
    std::vector<deformable::HalfSpace> spaces;    // of a polyhedron
    // of an obstacle: from low to high along x, y and z
    double low[3], high[3];

    // Of a round container: the radius of the ball that fits in at this height, around the axis.
    double room(const deformable::Vector3 &x) const
    {
      if (is_ball) return radius;
      return body.side.offset - body.side.ny * dot(x - body.center, body.axis);
    }
  };
  struct Load {
    int wall;
    deformable::Vector3 x;
    double force;
    deformable::Vector3 torque;
    double cutoff;
  };

  std::vector<Wall> walls, before;
  bool moving = false, counting = false;
  std::vector<Load> loads;
  double given = 0.0, potential_then = 0.0;

  deformable::HalfSpace present(const WallSource::Side &) const;
  void place_body(const WallShape &, Wall &) const;
  void find_ends(Wall &) const;
  static bool nearest_point(const Wall &, const deformable::Vector3 &, deformable::SurfacePoint &);
  // Of an obstacle or a round container. Returns false if it is out of reach.
  bool locate(const Wall &, deformable::Vector3 x, double cutoff, deformable::SurfacePoint &) const;
  double potential() const;
};

}    // namespace LAMMPS_NS

#endif
