// The walls of one fix at the present time: the nearest points of a particle, and the work that walls do.

#ifndef DEFORMABLE_WALL_SCENE_H
#define DEFORMABLE_WALL_SCENE_H

#include "geometry/obstacle.h"
#include "styles/walls/wall_shapes.h"

#include <cmath>
#include <vector>

namespace LAMMPS_NS {

// Periodic directions, for obstacles that repeat with the box.
struct Period {
  double x, y, tilt;    // 0: not periodic
};

class WallScene {
 public:
  // Takes the walls and computes them at the present time.
  std::string assign(WallSources &&);
  bool empty() const { return walls.empty(); }
  bool moves() const { return moving; }

  // Computes the walls anew where their regions are now. Returns what is wrong, or nothing.
  std::string update();
  Period period = {0.0, 0.0, 0.0};

  // The first wall of a container that lies outside of these bounds in x (axis 0) or y (1), or -1. Straight walls may cut a
  // round one.
  int first_outside(int axis, double low, double high) const;

  // Calls visitor(nearest point) for each wall within the cutoff of a center. The feature of the point counts
  // over all walls. Returns the first wall that has the center on its wrong side, or nearer than `nearest`, or that is round and
  // narrower than `narrowest`, if any.
  template <class Visitor>
  RefusedCenter visit(double x, double y, double narrowest, double nearest, double cutoff,
                      Visitor &&visitor) const
  {
    for (const Wall &wall : walls) {
      const deformable::HalfPlane &line = wall.line;
      deformable::NearestPoint point;
      if (wall.kind == WallSource::FACE) {
        point = {line.nx, line.ny, line.offset - line.nx * x - line.ny * y, 0.0, 0};
      } else {
        double dx = x - wall.x, dy = y - wall.y;
        if (wall.kind != WallSource::RIM) {
          wrap(wall, cutoff, dx, dy);
          const double far = wall.bound + cutoff;
          if (dx * dx + dy * dy >= far * far) continue;
        } else if (wall.radius < narrowest) {
          return {wall.source, 0.0, wall.radius};
        } else if (dx == 0.0 && dy == 0.0) {
          continue;    // the center of a round container has no nearest point
        }
        if (wall.kind != WallSource::POLYGON)
          point = deformable::nearest_on_disk(-dx, -dy, wall.radius, wall.kind == WallSource::RIM);
        else if (!deformable::nearest_point(&edges[wall.first_edge], wall.edges, wall.x + dx,
                                            wall.y + dy, point))
          return {wall.source, 0.0};
      }
      if (!(point.height > nearest)) return {wall.source, point.height};
      if (point.height >= cutoff) continue;
      point.feature += wall.first_feature;
      visitor(point);
    }
    return {-1, 0.0};
  }

  // The force on a feature of a particle at (x, y), which is at (dx, dy) from the point of application.
  void add_force(int feature, double fx, double fy, double x, double y, double dx, double dy,
                 double cutoff);
  // The energy that particles have given to moving walls since the scene was made: half of it with the forces
  // before a step, half of it with those after it, which is exact to the second order in the step.
  // A wall that was infinitely far away does no work.
  void clear_forces();
  void begin_step(bool counts);    // after update()
  void end_step();
  double energy_given() const { return given; }

  // How far the surface of a feature's wall has moved in this step at (x, y). What only changes its size stays.
  Motion::Way way(int feature, double x, double y) const;
  Motion::Way slide = {0.0, 0.0};    // of all walls, along themselves
  void do_work(double energy) { given += counting ? energy : 0.0; }
  void restore(double energy) { given = energy; }

  // The first feature of the wall that this one belongs to.
  int first_feature(int feature) const { return wall_of(feature).first_feature; }

  // What a feature is called, for a memory that outlives this scene. None before a region is read.
  std::vector<std::string> feature_names() const;

  const WallSource &source(int wall) const { return sources.walls[wall]; }
  WallSources sources;
  double memory_usage() const;

 private:
  struct Wall {
    WallSource::Kind kind;
    int source, first_feature, first_edge, edges;
    deformable::HalfPlane line;    // of a face
    double x, y, radius;           // of a disk; of a polygon a point in its middle
    double bound;                  // radius about (x, y) of an obstacle; infinite if it has no end
  };
  // A face, corner or disk: forces on it and where it is, which are needed for the work only.
  struct Feature {
    double x, y, nx, ny, radius;
  };
  struct Load {
    double fx, fy, moment, virial;    // about (x, y)
  };

  std::vector<Wall> walls;
  std::vector<deformable::Edge> edges;
  std::vector<deformable::HalfPlane> planes;    // of the wall that is computed
  bool moving = false, counting = false;
  std::vector<Feature> features, before;
  std::vector<Motion> motions, motions_before;    // of the shapes
  std::vector<Load> loads;
  double given = 0.0;

  deformable::HalfPlane present(const WallSource::Side &) const;
  void find_middle(Wall &) const;
  const Wall &wall_of(int feature) const;
  void place_features();
  void give(double sign);

  // Periods from which on the loops below would take long, or have no end.
  static constexpr double FAR_AWAY = 100.0;

  // An obstacle that fits, with the cutoff on both sides, into a period has its images with the box.
  void wrap(const Wall &wall, double cutoff, double &dx, double &dy) const
  {
    const double half_x = 0.5 * period.x, half_y = 0.5 * period.y, size = wall.bound + cutoff;
    if (half_y >= size) {
      if (std::fabs(dy) > FAR_AWAY * period.y) {
        dx -= std::rint(dy / period.y) * period.tilt;
        dy = std::remainder(dy, period.y);
      }
      for (; dy > half_y; dy -= period.y) dx -= period.tilt;
      for (; dy < -half_y; dy += period.y) dx += period.tilt;
    }
    if (half_x >= size) {
      if (std::fabs(dx) > FAR_AWAY * period.x) dx = std::remainder(dx, period.x);
      while (dx > half_x) dx -= period.x;
      while (dx < -half_x) dx += period.x;
    }
  }
};

}    // namespace LAMMPS_NS

#endif
