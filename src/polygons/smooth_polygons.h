// Smooth polygons: springs around a soft area, with contacts between the vertices of a polygon and the edges of others.

#ifndef DEFORMABLE_SMOOTH_POLYGONS_H
#define DEFORMABLE_SMOOTH_POLYGONS_H

#include "polygons/edge_contact.h"
#include "polygons/edge_neighbors.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace deformable {

// Stiffnesses of a polygon, and its values at rest.
struct PolygonParameters {
  double kL, length, kA, area;
};

struct SmoothPolygons {
  PolygonVertices vertices;
  std::vector<PolygonParameters> parameters;    // of each polygon
  Repulsion repulsion;
};

// A vertex that touches the edge of another polygon: the vector to it from the edge's first vertex, and the force on it.
struct Touch {
  int vertex, edge;
  double dx, dy;
  EdgeContact contact;
};

struct PolygonEnergy {
  double springs = 0.0, areas = 0.0, contacts = 0.0;
  std::vector<double> gradient;         // of the energy, 2 a vertex
  std::vector<double> area_gradient;    // of the area of the vertex' own polygon, 2 a vertex
  std::vector<double> pressure;         // kA (A0 - A) of each polygon
  std::vector<Touch> touches;
};

// A symmetric sparse matrix in the coordinates of vertices; entries at the same place add up.
struct Triplets {
  std::vector<int> row, column;
  std::vector<double> value;

  void add(int r, int c, double v)
  {
    row.push_back(r);
    column.push_back(c);
    value.push_back(v);
  }
};

// Springs of a polygon, kL/2 sum (l - l0)^2.
inline void add_springs(const PolygonVertices &v, int m, const PolygonParameters &p,
                        PolygonEnergy &u)
{
  for (int k = v.first[m]; k < v.first[m + 1]; ++k) {
    const int next = v.next[k];
    const double ex = v.x[2 * next] - v.x[2 * k], ey = v.x[2 * next + 1] - v.x[2 * k + 1];
    const double length = std::hypot(ex, ey), stretch = length - p.length;
    const double tx = p.kL * stretch * ex / length, ty = p.kL * stretch * ey / length;
    u.springs += 0.5 * p.kL * stretch * stretch;
    u.gradient[2 * k] -= tx;
    u.gradient[2 * k + 1] -= ty;
    u.gradient[2 * next] += tx;
    u.gradient[2 * next + 1] += ty;
  }
}

// Area of a polygon, kA/2 (A - A0)^2 with A = 1/2 sum (x_k y_k+1 - x_k+1 y_k), and
// dA/dx_k = (y_k+1 - y_k-1)/2, dA/dy_k = (x_k-1 - x_k+1)/2.
inline void add_area(const PolygonVertices &v, int m, const PolygonParameters &p, PolygonEnergy &u)
{
  const double *x = v.x.data(),
               *origin = x + 2 * v.first[m];    // about it, far images lose no digits
  double twice = 0.0;
  for (int k = v.first[m]; k < v.first[m + 1]; ++k) {
    const double *here = x + 2 * k, *next = x + 2 * v.next[k], *before = x + 2 * v.before[k];
    twice += (here[0] - origin[0]) * (next[1] - origin[1]) -
             (next[0] - origin[0]) * (here[1] - origin[1]);
    u.area_gradient[2 * k] = 0.5 * (next[1] - before[1]);
    u.area_gradient[2 * k + 1] = 0.5 * (before[0] - next[0]);
  }
  const double deficit = p.area - 0.5 * twice;
  u.areas += 0.5 * p.kA * deficit * deficit;
  u.pressure.push_back(p.kA * deficit);
  for (int d = 2 * v.first[m]; d < 2 * v.first[m + 1]; ++d)
    u.gradient[d] -= p.kA * deficit * u.area_gradient[d];
}

// U = kL/2 sum (l - l0)^2 + kA/2 sum (A - A0)^2 + contacts, see edge_contact.h, and its gradient.
inline PolygonEnergy polygon_energy(const SmoothPolygons &polygons)
{
  const PolygonVertices &v = polygons.vertices;
  PolygonEnergy u;
  u.gradient.assign(v.x.size(), 0.0);
  u.area_gradient.assign(v.x.size(), 0.0);
  for (int m = 0; m < static_cast<int>(polygons.parameters.size()); ++m) {
    add_springs(v, m, polygons.parameters[m], u);
    add_area(v, m, polygons.parameters[m], u);
  }
  for_each_near_edge(
      v, polygons.repulsion.c + v.longest_edge(), [&](int a, int k, double dx, double dy) {
        const int next = v.next[k];
        EdgeContact contact;
        if (!edge_contact(dx, dy, v.x[2 * next] - v.x[2 * k], v.x[2 * next + 1] - v.x[2 * k + 1],
                          polygons.repulsion, contact))
          return;
        u.contacts += contact.energy;
        u.gradient[2 * a] -= contact.vertex_x;
        u.gradient[2 * a + 1] -= contact.vertex_y;
        u.gradient[2 * next] -= contact.end_x;
        u.gradient[2 * next + 1] -= contact.end_y;
        u.gradient[2 * k] += contact.vertex_x + contact.end_x;
        u.gradient[2 * k + 1] += contact.vertex_y + contact.end_y;
        u.touches.push_back({a, k, dx, dy, contact});
      });
  return u;
}

// Second derivatives of `polygon_energy`, without the dense part kA grad(A) grad(A)^T of each polygon.
inline Triplets polygon_hessian(const SmoothPolygons &polygons, const PolygonEnergy &u)
{
  const PolygonVertices &v = polygons.vertices;
  Triplets h;
  for (int k = 0; k < v.size(); ++k) {
    const PolygonParameters &p = polygons.parameters[v.polygon[k]];
    const int next = v.next[k];
    const double e[2] = {v.x[2 * next] - v.x[2 * k], v.x[2 * next + 1] - v.x[2 * k + 1]};
    const double length = std::hypot(e[0], e[1]), ratio = p.length / length;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        const double along = e[i] * e[j] / (length * length);
        const double s = p.kL * ((i == j ? 1.0 - ratio : 0.0) + ratio * along);
        h.add(2 * k + i, 2 * k + j, s);
        h.add(2 * next + i, 2 * next + j, s);
        h.add(2 * k + i, 2 * next + j, -s);
        h.add(2 * next + j, 2 * k + i, -s);
      }
    const double half =
        -0.5 * u.pressure[v.polygon[k]];    // d2A/dx_k dy_k+1 = 1/2 = -d2A/dy_k dx_k+1
    h.add(2 * k, 2 * next + 1, half);
    h.add(2 * next + 1, 2 * k, half);
    h.add(2 * k + 1, 2 * next, -half);
    h.add(2 * next, 2 * k + 1, -half);
  }
  for (const Touch &touch : u.touches) {
    const int k = touch.edge, next = v.next[k], at[3] = {touch.vertex, k, next};
    EdgeStiffness s;
    edge_stiffness(touch.dx, touch.dy, v.x[2 * next] - v.x[2 * k],
                   v.x[2 * next + 1] - v.x[2 * k + 1], polygons.repulsion, s);
    for (int p = 0; p < 6; ++p)
      for (int q = 0; q < 6; ++q)
        h.add(2 * at[p / 2] + p % 2, 2 * at[q / 2] + q % 2, s.value[p][q]);
  }
  return h;
}

}    // namespace deformable

#endif
