// The geometry of LAMMPS' regions in space, from the contacts that they report: how far they reach along the axes, and more for
// those that this does not tell.

#include "styles/walls/wall_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>

using namespace LAMMPS_NS;
using namespace deformable;

namespace {

constexpr double UNENDING = 1e15;    // faces that are farther away are INF

double &along(Vector3 &v, int axis)
{
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

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
  constexpr double FAR = 1e9,
                   ASIDE = 1e-6;    // on its axis, and with a tip, a cone knows no nearest point
  Extent extent = {{-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}};
  for (int round = 0; round < (is_cone ? 3 : 4); ++round) {
    Extent next = extent;
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0}) {
        const int beside = (axis + 1) % 3;
        Vector3 from = extent.point(0.0, 0.0, 0.0), found;
        if (is_cone) along(from, beside) += ASIDE * extent.half(beside);
        const double before =
            std::max(extent.half(axis) * (is_cone ? 1e6 : 2.0), round == 1 ? 1.0 : 0.0);
        along(from, axis) = round == 0 ? sign * FAR : extent.at(axis, sign) + sign * before;
        (sign < 0.0 ? next.low : next.high)[axis] =
            nearest_to(region, from, found) ? along(found, axis) : sign * INFINITY;
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
    shape.spaces.push_back({normal, dot(normal, Vector3{point[0], point[1], point[2]} - to)});
    return "";
  }
  return "is a plane that is too far away";
}

void add_ends(const Extent &extent, int axis, WallShape &shape)
{
  Vector3 normal = {};
  for (const double sign : {-1.0, 1.0}) {
    along(normal, axis) = sign;
    const double end = sign < 0.0 ? extent.low[axis] : extent.high[axis];
    if (std::isfinite(end)) shape.spaces.push_back({normal, sign * end});
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
    shape.spaces.push_back({normal, dot(normal, x - to)});
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
  along(v, axis) = 1.0;
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
    place[side] = along(found, beside);
  }
  return {0.5 * (place[0] + place[1]), 0.5 * (place[1] - place[0])};
}

std::string read_body(Region *region, Extent extent, WallShape &shape)
{
  const int axis = axis_of(region, extent);
  if (axis < 0) return "has no axis that can be seen: use a cylinder, or planes";
  const int beside[] = {(axis + 1) % 3, (axis + 2) % 3};
  Revolution &body = shape.body;
  shape.is_body = true;
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
      along(at, axis) = end;
      if (!nearest_to(region, at + 1e-6 * size * unit(beside[0]) + size * outward, found))
        return "has an end or a tip that cannot be seen: give it radii above 0, or use planes";
      along(at, axis) = end = along(found, axis);
      radius[side] = rim_of(region, at, outward, beside[0], round == 0 ? size : radius[side],
                            round == 0 ? 1e6 * size : size, (round == 0 ? 1.0 : 1e-4) * size)
                         .radius;
    }
    const int wide =
        radius[1] > radius[0];    // its rim is nearest to all that is beyond and beside of it
    Vector3 at = body.center;
    along(at, axis) = wide ? extent.high[axis] : extent.low[axis];
    for (const int b : beside)
      along(body.center, b) =
          rim_of(region, at, (wide ? 1.0 : -1.0) * body.axis, b, radius[wide], size, size).middle;
    along(body.center, axis) = extent.middle(axis);
  }
  add_ends(extent, axis, shape);
  const double half = ends ? extent.half(axis) : 1.0, fall = radius[0] - radius[1],
               slant = std::hypot(2.0 * half, fall);
  const double nx = 2.0 * half / slant, ny = fall / slant;
  body.side = {nx, ny, 0.5 * nx * (radius[0] + radius[1])};
  return std::isfinite(body.side.offset) ? "" : "has a rim that cannot be seen: use planes";
}

}    // namespace

/* ---------------------------------------------------------------------- */

std::string LAMMPS_NS::read_solid(Region *region, WallShape &shape)
{
  shape.region = region;
  shape.spaces.clear();
  shape.is_body = false;
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
    shape.x = extent.middle(0);
    shape.y = extent.middle(1);
    shape.z = extent.middle(2);
    shape.radius = extent.half(0);
    return "";
  }
  for (int axis = 0; axis < 3; ++axis) add_ends(extent, axis, shape);
  return shape.spaces.empty() ? "has no surface: all of its sides are INF" : "";
}
