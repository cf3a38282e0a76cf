#include "styles/walls/walls.h"

#include "laws/trigonometry.h"

#include <algorithm>
#include <cmath>

namespace deformable {

namespace {

// Gives access to what LAMMPS protects.
struct RegionMotion : Region {
  static Vector3 axis(const Region *region)
  {
    const double *const axis = region->*(&RegionMotion::runit);
    return {axis[0], axis[1], axis[2]};
  }
  static Vector3 moved(Region *region, Vector3 x)
  {
    (region->*(&RegionMotion::forward_transform))(x.x, x.y, x.z);
    return x;
  }
};

/* ----------------------------------------------------------------------
   Regions in the plane: their sections at z = 0.
------------------------------------------------------------------------- */

namespace in_the_plane {

constexpr double FAR = 1e12;         // beyond any region without INF
constexpr double FAR_PRISM = 1e9;    // its square must not exceed the 1e20 of region prism
constexpr double ANY_DISTANCE = 1e300;
constexpr double NO_FACE = 1e15;    // faces of a prism that are farther away are INF
const char *const LEANS =
    "is a prism with faces that are not perpendicular to the xy plane: give it xz = yz = 0";
const char *const OFF_PLANE = "does not cross the plane z = 0 of the particles";

void add_face(WallShape &shape, double nx, double ny, double offset)
{
  shape.planes.push_back({{nx, ny, 0.0}, offset});
}

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
    add_face(shape, nx, ny, nx * (point[0] - foot.delx) + ny * (point[1] - foot.dely));
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
    if (bounded[0]) add_face(shape, sign, 0.0, sign * corner[0]);
    if (bounded[1]) add_face(shape, 0.0, sign, sign * corner[1]);
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
    add_face(shape, nx, ny, nx * inside[0] + ny * inside[1] + length);
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
  const char *const problem = sphere ? "is a sphere whose center is not at z = 0"
                                     : "is a cylinder that does not cross the plane z = 0 of the "
                                       "particles, or whose axis is not along z";
  double z = 0.0, distance = FAR_PRISM;
  for (int round = 0; round < 4; ++round) {
    const double x = shape.center.x + 0.8 * distance, y = shape.center.y + 0.6 * distance;
    const Region::Contact *contact = outer_contact(region, x, y, ANY_DISTANCE);
    if (!contact || !(contact->r > 0.0) || (!sphere && contact->delz != 0.0)) return problem;
    shape.radius = sphere ? contact->radius : 0.5 * contact->radius;
    const double to_center = (contact->r + shape.radius) / contact->r;
    shape.center.x = x - contact->delx * to_center;
    shape.center.y = y - contact->dely * to_center;
    z = -contact->delz * to_center;
    distance = std::max(2.0 * shape.radius, round == 0 ? 1e-4 : 1e-9);
  }
  if (sphere) return std::fabs(z) <= 1e-9 * shape.radius ? "" : problem;
  for (int k = 0; k < 16; ++k) {    // a cylinder along x or y has another section
    const double angle = 0.125 * PI * k;
    const double c = shape.radius * std::cos(angle), s = shape.radius * std::sin(angle);
    if (region->inside(shape.center.x + 0.999 * c, shape.center.y + 0.999 * s, 0.0) &&
        !region->inside(shape.center.x + 1.001 * c, shape.center.y + 1.001 * s, 0.0))
      continue;
    return problem;
  }
  return "";
}

std::string read(Region *region, double x, double y, WallShape &shape)
{
  if (region->openflag)
    return "has open faces: use planes, or segments (fix ID group deformable/wall segment ...)";
  if (region->rotateflag && std::fabs(RegionMotion::axis(region).z) != 1.0)
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

}    // namespace in_the_plane

/* ----------------------------------------------------------------------
   Regions in space: how far they reach along the axes tells a block or sphere;
   other shapes are looked at from more points.
------------------------------------------------------------------------- */

namespace in_space {

constexpr double UNENDING = 1e15;    // faces that are farther away are INF

// The point of the region nearest to x, which is outside. Returns false if there is none, as in the direction of INF.
bool nearest_to(Region *region, Vector3 x, Vector3 &found)
{
  double point[3] = {x.x, x.y, x.z};
  if (region->surface_exterior(point, UNENDING) == 0) return false;
  const Region::Contact &contact = *region->contact;
  found = x - Vector3{contact.delx, contact.dely, contact.delz};
  return std::isfinite(dot(found, found));
}

// How far a region reaches along the axes; infinite for INF.
struct Extent {
  double low[3], high[3];
  double middle(int axis) const { return at(axis, 0.0); }
  double half(int axis) const
  {
    const double size = 0.5 * (high[axis] - low[axis]);
    return std::isfinite(size) ? size : 1.0;
  }
  // -1 to 1: from low to high
  double at(int axis, double part) const
  {
    const bool ends = std::isfinite(high[axis]), begins = std::isfinite(low[axis]);
    if (begins && ends) return 0.5 * ((1.0 - part) * low[axis] + (1.0 + part) * high[axis]);
    return begins ? low[axis] + 1.0 + part : ends ? high[axis] - 1.0 + part : part;
  }
  Vector3 point(double px, double py, double pz) const { return {at(0, px), at(1, py), at(2, pz)}; }
};

// A convex body is nearest to a point far away on an axis at about its end. Later points are nearer, in front of the middle,
// where nothing is lost to rounding, after a second round that does not know yet how small the body is; of a cone only its rim
// tells where it ends.
Extent extent_of(Region *region, bool is_cone)
{
  constexpr double FAR = 1e9;
  constexpr double ASIDE = 1e-6;    // on its axis, and with a tip, a cone knows no nearest point
  Extent extent = {{-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}};
  for (int round = 0; round < (is_cone ? 3 : 4); ++round) {
    Extent next = extent;
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0}) {
        const int beside = (axis + 1) % 3;
        Vector3 from = extent.point(0.0, 0.0, 0.0), found;
        if (is_cone) component(from, beside) += ASIDE * extent.half(beside);
        const double before =
            std::max(extent.half(axis) * (is_cone ? 1e6 : 2.0), round == 1 ? 1.0 : 0.0);
        component(from, axis) = round == 0 ? sign * FAR : extent.at(axis, sign) + sign * before;
        (sign < 0.0 ? next.low : next.high)[axis] =
            nearest_to(region, from, found) ? component(found, axis) : sign * INFINITY;
      }
    extent = next;
  }
  return extent;
}

// Its face, seen from a point that is not on it.
std::string read_plane(Region *region, WallShape &shape)
{
  for (const double shift : {0.0, 1.0, 1e3}) {
    double point[3] = {0.37 * shift, 0.61 * shift, 0.23 * shift};
    const bool inside = region->inside(point[0], point[1], point[2]);
    const int n = inside ? region->surface_interior(point, UNENDING)
                         : region->surface_exterior(point, UNENDING);
    const Region::Contact &foot = region->contact[0];
    if (n == 0 || !(foot.r > 0.0)) continue;
    const Vector3 to = {foot.delx, foot.dely, foot.delz};
    const Vector3 normal = ((inside ? -1.0 : 1.0) / length(to)) * to;
    shape.planes.push_back({normal, dot(normal, Vector3{point[0], point[1], point[2]} - to)});
    return "";
  }
  return "is a plane that is too far away";
}

void add_ends(const Extent &extent, int axis, WallShape &shape)
{
  Vector3 normal = {};
  for (const double sign : {-1.0, 1.0}) {
    component(normal, axis) = sign;
    const double end = sign < 0.0 ? extent.low[axis] : extent.high[axis];
    if (std::isfinite(end)) shape.planes.push_back({normal, sign * end});
  }
}

// Its faces, seen from its middle.
std::string read_prism(Region *region, const Extent &extent, WallShape &shape)
{
  const Vector3 x = extent.point(0.1, 0.2, 0.3);
  double point[3] = {x.x, x.y, x.z};
  const int n = region->surface_interior(point, UNENDING);
  for (int k = 0; k < n; ++k) {
    const Region::Contact &face = region->contact[k];
    const Vector3 to = {face.delx, face.dely, face.delz}, normal = (-1.0 / length(to)) * to;
    shape.planes.push_back({normal, dot(normal, x - to)});
  }
  return n > 0 ? "" : "is too thin to be seen: use a block or planes";
}

// Corners of the square around a round section are outside; those of a section through the axis are not.
int axis_of(Region *region, const Extent &extent)
{
  constexpr double CORNER = 0.8;
  for (int axis = 0; axis < 3; ++axis) {
    bool round = true;
    for (const double place : {-CORNER, 0.0, CORNER})
      for (const double sign : {-1.0, 1.0}) {
        double part[3] = {CORNER, CORNER, CORNER};
        part[axis] = place;
        part[(axis + 1) % 3] *= sign;
        const Vector3 x = extent.point(part[0], part[1], part[2]);
        round = round && !region->inside(x.x, x.y, x.z);
      }
    if (round) return axis;
  }
  return -1;
}

Vector3 unit(int axis)
{
  Vector3 v = {};
  component(v, axis) = 1.0;
  return v;
}

// The rim of an end, seen from two sides: where its middle is along this direction, and its radius.
struct Rim {
  double middle, radius;
};
Rim rim_of(Region *region, const Vector3 &end, const Vector3 &outward, int beside, double radius,
           double above, double next_to)
{
  double place[2];
  for (const int side : {0, 1}) {
    const Vector3 out = (side == 0 ? -1.0 : 1.0) * unit(beside);
    Vector3 found;
    if (!nearest_to(region, end + above * outward + (radius + next_to) * out, found))
      return {NAN, NAN};
    place[side] = component(found, beside);
  }
  return {0.5 * (place[0] + place[1]), 0.5 * (place[1] - place[0])};
}

std::string read_body(Region *region, Extent extent, WallShape &shape)
{
  const int axis = axis_of(region, extent);
  if (axis < 0) return "has no axis that can be seen: use a cylinder, or planes";
  const int beside[] = {(axis + 1) % 3, (axis + 2) % 3};
  Revolution body{};
  body.axis = unit(axis);
  const bool ends = std::isfinite(extent.high[axis] - extent.low[axis]);
  if (!ends && std::string(region->style) == "cone")
    return "is a cone without an end, or with a tip: give it both ends, and radii above 0";

  const double size = extent.half(beside[0]);
  double radius[] = {size, size};
  body.center = extent.point(0.0, 0.0, 0.0);
  for (int round = 0; round < 2 && ends; ++round) {
    for (const int side : {0, 1}) {
      const Vector3 outward = (side == 0 ? -1.0 : 1.0) * body.axis;
      double &end = (side == 0 ? extent.low : extent.high)[axis];
      Vector3 at = body.center, found;
      component(at, axis) = end;
      if (!nearest_to(region, at + 1e-6 * size * unit(beside[0]) + size * outward, found))
        return "has an end or a tip that cannot be seen: give it radii above 0, or use planes";
      component(at, axis) = end = component(found, axis);
      radius[side] = rim_of(region, at, outward, beside[0], round == 0 ? size : radius[side],
                            round == 0 ? 1e6 * size : size, (round == 0 ? 1.0 : 1e-4) * size)
                         .radius;
    }
    // the wider end: its rim is nearest to all that is beyond and beside of it
    const int wide = radius[1] > radius[0];
    Vector3 at = body.center;
    component(at, axis) = wide ? extent.high[axis] : extent.low[axis];
    for (const int b : beside)
      component(body.center, b) =
          rim_of(region, at, (wide ? 1.0 : -1.0) * body.axis, b, radius[wide], size, size).middle;
    component(body.center, axis) = extent.middle(axis);
  }
  add_ends(extent, axis, shape);
  const double half = ends ? extent.half(axis) : 1.0, fall = radius[0] - radius[1],
               slant = std::hypot(2.0 * half, fall);
  const double nx = 2.0 * half / slant, ny = fall / slant;
  body.side = {nx, ny, 0.5 * nx * (radius[0] + radius[1])};
  shape.set_body(body);
  return std::isfinite(body.side.offset) ? "" : "has a rim that cannot be seen: use planes";
}

std::string read(Region *region, WallShape &shape)
{
  if (region->openflag)
    return "has open faces: use planes, or a part that is INF along its open side";
  const std::string style = region->style;
  if (style == "plane") return read_plane(region, shape);
  const bool is_body = style == "cylinder" || style == "cone";
  if (style != "block" && style != "prism" && style != "sphere" && !is_body)
    return "of style " + style +
           " is not known: use planes, blocks, prisms, cylinders, cones, spheres, and "
           "intersections and unions of them";
  const Extent extent = extent_of(region, style == "cone");
  if (is_body) return read_body(region, extent, shape);
  if (style == "prism") return read_prism(region, extent, shape);
  if (style == "sphere") {
    shape.center = extent.point(0.0, 0.0, 0.0);
    shape.radius = extent.half(0);
    return "";
  }
  for (int axis = 0; axis < 3; ++axis) add_ends(extent, axis, shape);
  return shape.planes.empty() ? "has no surface: all of its sides are INF" : "";
}

}    // namespace in_space
}    // namespace

std::string read_shape(Region *region, int dimension, double x, double y, WallShape &shape)
{
  shape = {};
  return dimension == 2 ? in_the_plane::read(region, x, y, shape) : in_space::read(region, shape);
}

static Vector3 rotated_with(const Region *region, const Vector3 &v)
{
  if (!region->rotateflag) return v;
  const Vector3 axis = RegionMotion::axis(region);
  const double c = std::cos(region->theta), s = std::sin(region->theta);
  return c * v + s * cross(axis, v) + ((1.0 - c) * dot(axis, v)) * axis;
}

WallShape moved_with(Region *region, const WallShape &at_rest)
{
  WallShape shape = at_rest;
  if (!region->dynamic) return shape;
  for (HalfSpace &plane : shape.planes) {
    const Vector3 x = RegionMotion::moved(region, plane.offset * plane.n);
    plane.n = rotated_with(region, plane.n);
    plane.offset = dot(plane.n, x);
  }
  shape.center = RegionMotion::moved(region, shape.center);
  shape.body.center = RegionMotion::moved(region, shape.body.center);
  shape.body.axis = rotated_with(region, shape.body.axis);
  return shape;
}

Motion motion_of(Region *region)
{
  const Vector3 origin = RegionMotion::moved(region, {});
  if (!region->rotateflag) return {origin};
  return {origin, region->theta, RegionMotion::axis(region)};
}

}    // namespace deformable
