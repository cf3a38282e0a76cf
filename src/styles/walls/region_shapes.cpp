// The geometry of LAMMPS' regions from the contacts that they report.

#include "styles/walls/wall_shapes.h"

#include "laws/trigonometry.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace {

constexpr double FAR = 1e12;    // beyond any region without INF
constexpr double FAR_PRISM =
    1e9;    // squares of distances must not exceed the 1e20 of region prism
constexpr double ANY_DISTANCE = 1e300;
constexpr double NO_FACE = 1e15;    // faces of a prism that are farther away are INF
const char *const LEANS =
    "is a prism with faces that are not perpendicular to the xy plane: give it xz = yz = 0";
const char *const OFF_PLANE = "does not cross the plane z = 0 of the particles";

const Region::Contact *outer_contact(Region *region, double x, double y, double cutoff)
{
  double point[3] = {x, y, 0.0};
  return region->surface_exterior(point, cutoff) > 0 ? region->contact : nullptr;
}

std::string read_plane(Region *region, double x, double y, WallShape &shape)
{
  for (const double shift : {0.0, 1.0}) {    // a point on the plane does not tell its normal
    double point[3] = {x + 0.37 * shift, y + 0.61 * shift, 0.0};
    const bool inside = region->inside(point[0], point[1], point[2]);
    const int n = inside ? region->surface_interior(point, ANY_DISTANCE)
                         : region->surface_exterior(point, ANY_DISTANCE);
    const Region::Contact &foot = region->contact[0];
    if (n == 0 || !(foot.r > 0.0)) continue;
    if (foot.delz != 0.0) return "is a plane whose normal leaves the xy plane: give it nz = 0";
    const double length = std::hypot(foot.delx, foot.dely), sign = inside ? -1.0 : 1.0;
    const double nx = sign * foot.delx / length, ny = sign * foot.dely / length;
    shape.planes.push_back({nx, ny, nx * (point[0] - foot.delx) + ny * (point[1] - foot.dely)});
    return "";
  }
  return "is a plane without a normal in the xy plane: give it nz = 0";
}

// Its lower and upper corners are the points nearest to far points on the diagonals. Their rounding errors vanish
// when they are asked for again from nearby.
std::string read_block(Region *region, WallShape &shape)
{
  for (const double sign : {-1.0, 1.0}) {
    double corner[2] = {0.0, 0.0}, distance = FAR;
    bool bounded[2] = {true, true};
    for (int round = 0; round < 4; ++round) {
      const double x = corner[0] + sign * distance, y = corner[1] + sign * distance;
      const Region::Contact *contact = outer_contact(region, x, y, ANY_DISTANCE);
      if (!contact) {
        bounded[0] = bounded[1] = false;    // INF in both directions
        break;
      }
      if (contact->delz != 0.0) return OFF_PLANE;
      if (round == 0) {
        bounded[0] = contact->delx != 0.0;
        bounded[1] = contact->dely != 0.0;
      }
      if (bounded[0]) corner[0] = x - contact->delx;
      if (bounded[1]) corner[1] = y - contact->dely;
      distance = round == 0
                     ? 1.0
                     : std::max(1e-3 * std::max(std::fabs(corner[0]), std::fabs(corner[1])), 1e-9);
    }
    if (bounded[0]) shape.planes.push_back({sign, 0.0, sign * corner[0]});
    if (bounded[1]) shape.planes.push_back({0.0, sign, sign * corner[1]});
  }
  return shape.planes.empty() ? "has no surface in the xy plane" : "";
}

// Returns false without planes if the point lies on a face, with planes if faces lean.
bool read_prism_faces(Region *region, double *inside, WallShape &shape)
{
  shape.planes.clear();
  bool leans = false, on_face = false;
  const int n = region->surface_interior(inside, NO_FACE);
  for (int m = 0; m < n; ++m) {
    const Region::Contact &face = region->contact[m];
    if (face.iwall < 2) continue;    // above or below
    const double length = std::hypot(face.delx, face.dely);
    leans = leans || face.delz != 0.0;
    on_face = on_face || length == 0.0;
    const double nx = -face.delx / length, ny = -face.dely / length;
    shape.planes.push_back({nx, ny, nx * inside[0] + ny * inside[1] + length});
  }
  if (on_face) shape.planes.clear();
  return !leans && !shape.planes.empty();
}

// A point inside, between the points nearest to two others, has contacts with all faces. The nearer it is to the
// origin, the less is lost to rounding.
std::string read_prism(Region *region, WallShape &shape)
{
  bool crosses = false;
  const double directions[][2] = {{0.8, 0.6}, {0.6, -0.8}, {1.0, 0.1}, {0.1, 1.0}};
  for (const double distance : {1e3, 1e6, FAR_PRISM})
    for (const double *u : directions) {
      double middle[3] = {0.0, 0.0, 0.0};
      for (const double sign : {-1.0, 1.0}) {
        const double x = sign * distance * u[0], y = sign * distance * u[1];
        const Region::Contact *contact = outer_contact(region, x, y, NO_FACE);
        if (!contact) continue;
        crosses = crosses || contact->delz == 0.0;
        middle[0] += 0.5 * (x - contact->delx);
        middle[1] += 0.5 * (y - contact->dely);
      }
      if (!region->inside(middle[0], middle[1], 0.0)) continue;
      if (read_prism_faces(region, middle, shape)) return "";
      if (!shape.planes.empty()) return LEANS;
    }
  return crosses ? "has no faces in x and y: use a block or planes" : OFF_PLANE;
}

// Region::Contact::radius, made for granular particles, is twice the radius of a cylinder and the radius of a
// sphere.
std::string read_disk(Region *region, bool sphere, WallShape &shape)
{
  const char *const wrong = sphere ? "is a sphere whose center is not at z = 0"
                                   : "is a cylinder that does not cross the plane z = 0 of the "
                                     "particles, or whose axis is not along z";
  double z = 0.0, distance = FAR_PRISM;
  for (int round = 0; round < 4; ++round) {
    const double x = shape.x + 0.8 * distance, y = shape.y + 0.6 * distance;
    const Region::Contact *contact = outer_contact(region, x, y, ANY_DISTANCE);
    if (!contact || !(contact->r > 0.0) || (!sphere && contact->delz != 0.0)) return wrong;
    shape.radius = sphere ? contact->radius : 0.5 * contact->radius;
    const double to_center = (contact->r + shape.radius) / contact->r;
    shape.x = x - contact->delx * to_center;
    shape.y = y - contact->dely * to_center;
    z = -contact->delz * to_center;
    distance = std::max(2.0 * shape.radius, round == 0 ? 1e-4 : 1e-9);
  }
  if (sphere) return std::fabs(z) <= 1e-9 * shape.radius ? "" : wrong;
  for (int k = 0; k < 16; ++k) {    // a cylinder along x or y has another section
    const double angle = 0.125 * deformable::PI * k;
    const double c = shape.radius * std::cos(angle), s = shape.radius * std::sin(angle);
    if (region->inside(shape.x + 0.999 * c, shape.y + 0.999 * s, 0.0) &&
        !region->inside(shape.x + 1.001 * c, shape.y + 1.001 * s, 0.0))
      continue;
    return wrong;
  }
  return "";
}

// Gives access to what LAMMPS protects.
struct RegionMotion : Region {
  static double axis_z(const Region *region) { return (region->*(&RegionMotion::runit))[2]; }
  static void forward(Region *region, double &x, double &y, double &z)
  {
    (region->*(&RegionMotion::forward_transform))(x, y, z);
  }
};

}    // namespace

void LAMMPS_NS::move_with(Region *region, double &x, double &y)
{
  double z = 0.0;
  RegionMotion::forward(region, x, y, z);
}

deformable::Vector3 LAMMPS_NS::moved_with(Region *region, deformable::Vector3 x)
{
  RegionMotion::forward(region, x.x, x.y, x.z);
  return x;
}

double LAMMPS_NS::angle_of_rotation(const Region *region)
{
  return region->rotateflag ? region->theta * RegionMotion::axis_z(region) : 0.0;
}

std::string LAMMPS_NS::read_shape(Region *region, double x, double y, WallShape &shape)
{
  shape.region = region;
  shape.planes.clear();
  shape.x = shape.y = shape.radius = 0.0;
  if (region->openflag)
    return "has open faces: use planes, or segments (fix ID group deformable/wall segment ...)";
  if (region->rotateflag && std::fabs(RegionMotion::axis_z(region)) != 1.0)
    return "rotates out of the xy plane: its axis must be along z";
  const std::string style = region->style;
  if (style == "plane") return read_plane(region, x, y, shape);
  if (style == "block") return read_block(region, shape);
  if (style == "prism") return read_prism(region, shape);
  if (style == "cylinder") return read_disk(region, false, shape);
  if (style == "sphere") return read_disk(region, true, shape);
  return "of style " + style +
         " has a curved surface: use planes, blocks, prisms, cylinders along z, spheres, and "
         "intersections and unions of them";
}

/* ---------------------------------------------------------------------- */

Motion LAMMPS_NS::motion_of(const WallShape &shape)
{
  Motion motion;
  if (shape.region) {
    motion.angle = angle_of_rotation(shape.region);
    move_with(shape.region, motion.x, motion.y);
  } else if (shape.side.sign != 0) {
    (shape.side.axis == 0 ? motion.x : motion.y) = shape.side.place.now;
  }
  return motion;
}

// The middle of the step counts: the mean over both of its ends is right to second order.
Motion::Way Motion::way_from(const Motion &before, double px, double py) const
{
  const double turn = angle - before.angle;
  return {x - before.x - turn * (py - 0.5 * (y + before.y)),
          y - before.y + turn * (px - 0.5 * (x + before.x))};
}
