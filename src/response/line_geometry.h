// Contact lines as functions of the centers and of what is free to move in them, to second order.

#ifndef DEFORMABLE_LINE_GEOMETRY_H
#define DEFORMABLE_LINE_GEOMETRY_H

#include "laws/contact.h"
#include "response/energy_blocks.h"

#include <cmath>

namespace deformable {

// Local variables of one side of a contact: the vector v, the shift of the line, its direction and curvature. Laws have
// the first 2, 3 or 5 of them.
enum LineVariable { V_X, V_Y, SHIFT, DIRECTION, CURVATURE, LINE_VARIABLES };

// A quantity with its derivatives by the local variables.
struct LineQuantity {
  double value, first[LINE_VARIABLES] = {}, second[LINE_VARIABLES][LINE_VARIABLES] = {};

  // by v: along n, and second derivatives n n^T, t t^T and n t^T + t n^T
  void by_vector(const SideVector &v, double along, double across, double nn, double tt, double nt)
  {
    const double d = v.length(), nx = v.x / d, ny = v.y / d;
    first[V_X] += along * nx - across * ny;
    first[V_Y] += along * ny + across * nx;
    second[V_X][V_X] += nn * nx * nx + tt * ny * ny - 2.0 * nt * nx * ny;
    second[V_Y][V_Y] += nn * ny * ny + tt * nx * nx + 2.0 * nt * nx * ny;
    const double mixed = (nn - tt) * nx * ny + nt * (nx * nx - ny * ny);
    second[V_X][V_Y] += mixed;
    second[V_Y][V_X] += mixed;
  }
  void mixed(int a, int b, double value_)
  {
    second[a][b] += value_;
    second[b][a] += value_;
  }
};

// What the energy of a ring depends on. Lines are straight, unless CURVATURE is a variable.
struct Line {
  LineQuantity indentation, angle, curvature = {0.0};
  const LineQuantity &operator[](int q) const
  {
    return q == 0 ? indentation : q == 1 ? angle : curvature;
  }
};

// The angle of v: dtheta/dv = turn t,   d^2theta/dv dv = -turn^2 (n t^T + t n^T)
inline LineQuantity angle_of_vector(const SideVector &v)
{
  LineQuantity theta = {angle_of(v.x, v.y)};
  theta.by_vector(v, 0.0, v.turn, 0.0, 0.0, -v.turn * v.turn);
  return theta;
}

// A line at the distance |v|, of a wall: a = R - |v|
inline Line wall_line(const SideVector &v, double radius)
{
  LineQuantity a = {radius - v.length()};
  a.by_vector(v, -1.0, 0.0, 0.0, -v.turn, 0.0);
  return {a, angle_of_vector(v)};
}

// The radical axis: a and da/dd of contact_line,   d^2a/dd^2 = -(R_i^2 - R_j^2)/d^3
inline Line radical_line(const SideVector &v, double radius_i, double radius_j)
{
  const double d = v.length(), per_d = 1.0 / d;
  const ContactLine<double> line = contact_line(d, per_d, radius_i, radius_j);
  LineQuantity a = {line.indentation_i};
  const double slope = line.d_indentation_i;
  const double curvature = -(radius_i - radius_j) * (radius_i + radius_j) * per_d * per_d * per_d;
  a.by_vector(v, slope, 0.0, curvature, slope * v.turn, 0.0);
  return {a, angle_of_vector(v)};
}

// A line that is perpendicular to v, moved from the middle of the overlap towards the center:
//   a = (R_i + R_j - d)/2 + shift
inline Line shifted_line(const SideVector &v, double radius_i, double radius_j, double shift)
{
  LineQuantity a = {0.5 * (radius_i + radius_j - v.length()) + shift};
  a.by_vector(v, -0.5, 0.0, 0.0, -0.5 * v.turn, 0.0);
  a.first[SHIFT] = 1.0;
  return {a, angle_of_vector(v)};
}

// A line of any direction psi, with the normal m = (cos psi, sin psi), so moved:
//   a = (R_i + R_j - m.v)/2 + shift,   theta = psi
inline Line turned_line(const SideVector &v, double radius_i, double radius_j, double shift,
                        double direction)
{
  const double mx = std::cos(direction), my = std::sin(direction);
  const double along = mx * v.x + my * v.y, across = mx * v.y - my * v.x;
  LineQuantity a = {0.5 * (radius_i + radius_j - along) + shift}, theta = {angle_of(mx, my)};
  a.first[V_X] = -0.5 * mx;
  a.first[V_Y] = -0.5 * my;
  a.first[SHIFT] = 1.0;
  a.first[DIRECTION] = -0.5 * across;
  a.second[DIRECTION][DIRECTION] = 0.5 * along;
  a.mixed(DIRECTION, V_X, 0.5 * my);
  a.mixed(DIRECTION, V_Y, -0.5 * mx);
  theta.first[DIRECTION] = 1.0;
  Line line = {a, theta};
  line.curvature.first[CURVATURE] = 1.0;
  return line;
}

}    // namespace deformable

#endif
