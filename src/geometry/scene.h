// A scene of walls, in the plane or in space: the nearest points of particles, and the work that walls do when they move.
//
// In the plane of the particles all vectors have z = 0, and a polygon has features of its own: each face and each end of it.
// Whoever moves walls changes `shapes` and calls update().

#ifndef DEFORMABLE_SCENE_H
#define DEFORMABLE_SCENE_H

#include "geometry/mesh.h"

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace deformable {

// A convex set of points, where it is now: half spaces that intersect; a disk or ball; or a body around an axis, whose ends are
// half spaces too. Or a mesh, which is not convex, before it moves.
struct WallShape {
  std::vector<HalfSpace> planes;
  Vector3 center{};
  double radius = 0.0;
  bool is_body = false;
  Revolution body{};
  std::shared_ptr<const Mesh> mesh;

  bool is_round() const { return is_body || (planes.empty() && !mesh); }
  void set_planes(const std::vector<HalfPlane> &);    // in the plane of the particles
  void set_body(const Revolution &);                  // with the planes as its ends
};

// One wall: a face of a container, the rim of a round container, an obstacle, round or with faces, or a mesh.
struct Wall {
  // a disk, ball or body; a polygon or polyhedron; a mesh around particles; a mesh between them
  enum Kind { FACE, RIM, DISK, POLYGON, ROOM, SURFACE } kind;
  std::string name;    // for messages
  int shape;           // of a rim, a disk and a mesh
  // of a face and of a polygon: half spaces of shapes; those that face the other way are the outside of a shape
  struct Side {
    int shape, plane;
    bool reversed;
  };
  std::vector<Side> sides;
};

// A rotation around an axis through the origin, then a step: how a shape has come to where it is.
struct Motion {
  Vector3 step{};
  double angle = 0.0;
  Vector3 axis = {0.0, 0.0, 1.0};

  Vector3 turned(const Vector3 &v, double sign = 1.0) const
  {
    if (angle == 0.0) return v;
    const double c = std::cos(angle), s = sign * std::sin(angle);
    return c * v + s * cross(axis, v) + ((1.0 - c) * dot(axis, v)) * axis;
  }
  Vector3 moved(const Vector3 &x) const { return turned(x) + step; }
  Vector3 moved_back(const Vector3 &x) const { return turned(x - step, -1.0); }
  SurfacePoint moved(SurfacePoint point) const
  {
    point.n = turned(point.n);
    point.t = turned(point.t);
    return point;
  }
};

// A center that a wall refuses: it is there at this height. Or the wall is a round container, and narrower than the particle: then
// it would have one contact where there is a ring of them, and none on the axis.
struct RefusedCenter {
  int wall;    // -1: none
  double height;
  double room = 0.0;    // if it is too narrow: its radius, where the particle is
};

class Scene {
 public:
  explicit Scene(int dimension = 2) : dimension(dimension) {}

  int dimension;
  bool moves = false;
  std::vector<WallShape> shapes;
  std::vector<Motion> motions;    // of the shapes
  std::vector<Wall> walls;
  // Edges of the box as rows, for obstacles that repeat with it; 0 along an axis that is not periodic.
  std::array<Vector3, 3> period{};

  // A wall with all sides of a shape.
  void add(Wall::Kind kind, const std::string &name, const WallShape &shape);

  // Whether the sides of an obstacle have any point in common.
  bool has_surface(const Wall &) const;

  // Computes the walls where their shapes are now. Returns what is wrong, or nothing.
  std::string update();

  // The first wall of a container that lies outside of these bounds in x, y or z, or -1. Straight walls may cut a round one.
  int first_outside(int axis, double low, double high) const;

  // Calls visitor(feature, nearest point) for each wall within the cutoff of a center. Features count over all walls. Returns the
  // first wall that has the center on its wrong side, or nearer than `nearest`, or that is round and narrower than `narrowest`, if
  // any. The middle of a round container has no nearest point.
  template <class Visitor>
  RefusedCenter visit(const Vector3 &x, double narrowest, double nearest, double cutoff,
                      Visitor &&visitor) const
  {
    for (const Present &wall : present) {
      if (wall.kind == Wall::FACE) {
        const SurfacePoint point = nearest_on_plane(wall.face, x);
        if (!(point.height > nearest)) return {index_of(wall), point.height};
        if (point.height < cutoff) visitor(wall.first_feature, point);
        continue;
      }
      if (wall.kind == Wall::RIM && wall.room(x) < narrowest)
        return {index_of(wall), 0.0, wall.room(x)};
      Vector3 from = x - wall.middle;
      if (!approach(wall, cutoff, from)) continue;
      if (wall.mesh) {
        const std::vector<Mesh::Contact> contacts = wall.contacts_at(wall.middle + from, cutoff);
        if (contacts.empty()) continue;
        const double height = contacts.front().point.height;
        if (!(height > nearest)) return {index_of(wall), height};
        for (const Mesh::Contact &contact : contacts)
          visitor(wall.first_feature + contact.feature, wall.place.moved(contact.point));
        continue;
      }
      int feature = wall.first_feature;
      const SurfacePoint point = nearest_point(wall, from, feature);
      if (!(point.height > nearest)) return {index_of(wall), point.height};
      if (point.height < cutoff && std::isfinite(point.turn)) visitor(feature, point);
    }
    return {-1, 0.0};
  }

  // The nearest point of a wall, at any distance: of the image of an obstacle whose middle is nearest.
  SurfacePoint nearest_point(int wall, const Vector3 &x) const;

  // A particle at x, within the cutoff, presses with this force; `torque`: the derivative of its work by the normal. Only while
  // walls move.
  void add_force(int feature, const Vector3 &x, double force, const Vector3 &torque, double cutoff);
  // The energy that particles have given to moving walls. A wall that moves while particles stay changes their energy by
  // -F dh - torque.dn: half of it counts with the forces before a step, half of it with those after it, which is exact to the
  // second order in the step. A wall that was infinitely far away does no work.
  void begin_step(bool counts);    // after update()
  void end_step();
  void do_work(double energy) { given += counting ? energy : 0.0; }    // along walls
  double energy_given() const { return given; }
  void restore(double energy) { given = energy; }

  // How far the surface of a feature's wall has moved in this step at x. What only changes its size stays.
  Vector3 way(int feature, const Vector3 &x) const;
  Vector3 slide{};    // of all walls, along themselves

  int wall_of(int feature) const;
  // The first feature of the wall that this one belongs to.
  int first_feature(int feature) const { return present[wall_of(feature)].first_feature; }

  // What features are called, for a memory that outlives this scene: all of walls with this name, numbers from `first` on.
  struct Features {
    std::string name;
    int first, count;
    bool operator==(const Features &other) const
    {
      return name == other.name && first == other.first && count == other.count;
    }
  };
  std::vector<Features> feature_names() const;

  double memory_usage() const;

 private:
  // A wall where it is now.
  struct Present {
    Wall::Kind kind;
    bool is_body;
    int first_feature, features;
    // of an obstacle, a disk or a ball: its middle, and how far it reaches from there along x, y and z, infinite where it has no
    // end
    Vector3 middle, half;
    double radius;
    HalfSpace face;
    std::vector<HalfSpace> planes;    // of a polyhedron
    std::vector<Edge> edges;          // of a polygon
    Revolution body;
    std::shared_ptr<const Mesh> mesh;
    Motion place;    // of the mesh

    bool is_obstacle() const
    {
      return kind == Wall::DISK || kind == Wall::POLYGON || kind == Wall::SURFACE;
    }
    std::vector<Mesh::Contact> contacts_at(const Vector3 &x, double cutoff) const
    {
      std::vector<Mesh::Contact> found;
      mesh->find_contacts(place.moved_back(x), cutoff, found);
      return found;
    }
    // Of a round container: the radius of the ball that fits in at this height, around the axis.
    double room(const Vector3 &x) const
    {
      if (!is_body) return radius;
      return body.side.offset - body.side.ny * dot(x - body.center, body.axis);
    }
  };
  struct Load {
    int wall;
    int part;     // of a mesh
    Vector3 x;    // as its nearest image sees it
    double force;
    Vector3 torque;
  };

  std::vector<Present> present, before;
  std::vector<Motion> motions_before;
  bool counting = false;
  std::vector<Load> loads;
  double given = 0.0, potential_then = 0.0;

  HalfSpace side_of(const Wall::Side &) const;
  std::vector<HalfSpace> sides_of(const Wall &) const;
  static void place_body(const WallShape &, Present &);
  static bool find_corners(Present &);
  static void find_ends(Present &);
  static void place_mesh(const WallShape &, const Motion &, Present &);
  int index_of(const Present &wall) const { return static_cast<int>(&wall - present.data()); }
  // `from`: from its middle. A polygon adds to its first feature.
  static SurfacePoint nearest_point(const Present &, const Vector3 &from, int &feature);
  double potential(const std::vector<Present> &) const;

  // `from`: from the middle of a wall to a center. An obstacle that fits, with the cutoff on both sides, into a period has its
  // images with the box: the center is then seen from the nearest one. Returns false if it is out of reach.
  bool approach(const Present &wall, double cutoff, Vector3 &from) const
  {
    if (!wall.is_obstacle()) return true;
    const auto reaches = [&](const double &along, double reach, double length,
                             const Vector3 &edge) {
      if (!(std::fabs(along) >= reach)) return true;
      if (std::fabs(along) > 0.5 * length && length > 0.0 && 0.5 * length >= reach)
        from = from - std::rint(along / length) * edge;
      return std::fabs(along) < reach;
    };
    return (dimension == 2 || reaches(from.z, wall.half.z + cutoff, period[2].z, period[2])) &&
           reaches(from.y, wall.half.y + cutoff, period[1].y, period[1]) &&
           reaches(from.x, wall.half.x + cutoff, period[0].x, period[0]);
  }
};

}    // namespace deformable

#endif
