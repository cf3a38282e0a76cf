// Contacts of smooth polygons: the vertices of a polygon against the edges of another.
//
// Sum over vertices a of a polygon and edges k of another polygon, k from vertex v_k to its successor:
//
//   U = sum [ phi(dist(a, edge k)) - phi(|a - v_k|) ],   phi(d) = kr/2 (c - d)^2 for d < c, else 0
//
// Near a corner two edges act on a, and the vertex between them is subtracted once: U and its forces are
// continuous when a slides over convex and concave corners.

#ifndef DEFORMABLE_EDGE_CONTACT_H
#define DEFORMABLE_EDGE_CONTACT_H

#include <cmath>

namespace deformable {

// phi(d) = kr/2 (c - d)_+^2
struct Repulsion {
  double kr, c;
};

// Energy of one vertex against one edge, and the forces; that on the first vertex of the edge is minus their sum.
struct EdgeContact {
  double energy = 0.0;
  double vertex_x = 0.0, vertex_y = 0.0;
  double end_x = 0.0, end_y = 0.0;
};

// Points closer than 1e-150 are one point: no direction joins them, and the squares of their distances lose
// their digits. A vertex on an edge has no force from it, as no side is preferred.
constexpr double POINT_SQUARE = 1e-300;

// phi(d) - phi(r), with d the distance from the vertex to the edge, r that to the first vertex of the edge.
//   foot at the fraction t = p.e/e.e of the edge, n from there to the vertex:
//   t <= 0: d = r, nothing;   0 < t < 1: d = |e x p|/|e|;   t >= 1: d = |p - e|
//   on the vertex kr (c - d) n - kr (c - r) p/r,   on the end -t kr (c - d) n, t clipped at 1
// (px, py): from the first vertex of the edge to the vertex. (ex, ey): from there to the end of the edge.
// Returns false, and leaves `contact`, where nothing acts.
inline bool edge_contact(double px, double py, double ex, double ey, const Repulsion &phi,
                         EdgeContact &contact)
{
  const double along = px * ex + py * ey, square = ex * ex + ey * ey;
  if (!(along > 0.0) || square < POINT_SQUARE) return false;

  double t = 1.0, nx = 0.0, ny = 0.0, d = 0.0;
  if (along < square) {
    const double per_length = 1.0 / std::sqrt(square);
    const double side = (ex * py - ey * px) * per_length;
    d = std::fabs(side);
    if (d >= phi.c) return false;    // and r > d
    t = along * per_length * per_length;
    const double sign = side > 0.0 ? per_length : side < 0.0 ? -per_length : 0.0;
    nx = -sign * ey;
    ny = sign * ex;
  } else {
    const double qx = px - ex, qy = py - ey, d2 = qx * qx + qy * qy;
    if (d2 >= phi.c * phi.c) return false;
    if (d2 >= POINT_SQUARE) {
      d = std::sqrt(d2);
      nx = qx / d;
      ny = qy / d;
    }
  }
  const double push = phi.kr * (phi.c - d);
  contact.energy = 0.5 * push * (phi.c - d);
  contact.vertex_x = push * nx;
  contact.vertex_y = push * ny;
  contact.end_x = -t * contact.vertex_x;
  contact.end_y = -t * contact.vertex_y;

  const double r2 = px * px + py * py;
  if (r2 >= phi.c * phi.c) return true;
  const double r = std::sqrt(r2), back = phi.kr * (phi.c - r);
  contact.energy -= 0.5 * back * (phi.c - r);
  if (r2 >= POINT_SQUARE) {
    contact.vertex_x -= back / r * px;
    contact.vertex_y -= back / r * py;
  }
  return true;
}

// Second derivatives of the same by the places of the vertex, the first vertex and the end of the edge.
struct EdgeStiffness {
  double value[6][6] = {};    // rows and columns: vertex x, y, first vertex x, y, end x, y
};

// Adds `factor` times the second derivatives of phi(|p|), p = (px, py) from point k to point m (0, 1 or 2):
//   phi'' n n - kr (c - r)/r (1 - n n) for both points, minus that across
inline void add_point_stiffness(double px, double py, int m, int k, double factor,
                                const Repulsion &phi, EdgeStiffness &stiffness)
{
  const double r2 = px * px + py * py;
  if (r2 >= phi.c * phi.c || r2 < POINT_SQUARE) return;
  const double r = std::sqrt(r2), n[2] = {px / r, py / r};
  const double tension = -phi.kr * (phi.c - r) / r;    // phi'/r
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) {
      const double h = factor * ((phi.kr - tension) * n[a] * n[b] + (a == b ? tension : 0.0));
      stiffness.value[2 * m + a][2 * m + b] += h;
      stiffness.value[2 * k + a][2 * k + b] += h;
      stiffness.value[2 * m + a][2 * k + b] -= h;
      stiffness.value[2 * k + a][2 * m + b] -= h;
    }
}

// Second derivatives of phi(d), 0 < t < 1. With weights w = (1, t - 1, -t) of the three points, rates
// r = (0, -1, 1)/|e| of the direction u of the edge, and n from the foot to the vertex:
//   grad d = w n,   grad grad d = -(w r u n + r w n u) - r r d n n,   phi'' (grad d)^2 + phi' grad grad d
inline void add_line_stiffness(double px, double py, double ex, double ey, const Repulsion &phi,
                               EdgeStiffness &stiffness)
{
  const double length = std::sqrt(ex * ex + ey * ey), u[2] = {ex / length, ey / length};
  const double side = u[0] * py - u[1] * px, d = std::fabs(side);
  if (d >= phi.c || d * d < POINT_SQUARE) return;
  const double n[2] = {-std::copysign(u[1], u[1] * side), std::copysign(u[0], u[0] * side)};
  const double t = (px * u[0] + py * u[1]) / length;
  const double w[3] = {1.0, t - 1.0, -t}, r[3] = {0.0, -1.0 / length, 1.0 / length};
  const double slope = -phi.kr * (phi.c - d);    // phi'
  for (int m = 0; m < 3; ++m)
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b)
          stiffness.value[2 * m + a][2 * k + b] +=
              phi.kr * w[m] * w[k] * n[a] * n[b] -
              slope * (w[m] * r[k] * u[a] * n[b] + r[m] * w[k] * n[a] * u[b] +
                       r[m] * r[k] * d * n[a] * n[b]);
}

// The second derivatives of `edge_contact`, with its branches: they jump where t = 1, d = c or r = c.
// They diverge as kr c/d and kr c/r; where the force has no direction (POINT_SQUARE) they are left out.
inline bool edge_stiffness(double px, double py, double ex, double ey, const Repulsion &phi,
                           EdgeStiffness &stiffness)
{
  EdgeContact contact;
  if (!edge_contact(px, py, ex, ey, phi, contact)) return false;
  stiffness = {};
  if (px * ex + py * ey < ex * ex + ey * ey)
    add_line_stiffness(px, py, ex, ey, phi, stiffness);
  else
    add_point_stiffness(px - ex, py - ey, 0, 2, 1.0, phi, stiffness);
  add_point_stiffness(px, py, 0, 1, -1.0, phi, stiffness);
  return true;
}

}    // namespace deformable

#endif
