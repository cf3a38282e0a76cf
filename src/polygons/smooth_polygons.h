// Smooth polygons: springs around a soft area, with contacts between the vertices of a polygon and the edges of others.

#ifndef DEFORMABLE_SMOOTH_POLYGONS_H
#define DEFORMABLE_SMOOTH_POLYGONS_H

#include "polygons/edge_contact.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace deformable {

// Lattice vectors (lx, 0) and (xy, ly).
struct Box {
  double lx, xy, ly;

  // A position in lattice vectors.
  void fractions(double x, double y, double &a, double &b) const
  {
    b = y / ly;
    a = (x - b * xy) / lx;
  }
  // The nearest image of a vector that is shorter than half of the box is wide in each direction.
  void to_nearest(double &x, double &y) const
  {
    double a, b;
    fractions(x, y, a, b);
    x -= std::rint(a) * lx + std::rint(b) * xy;
    y -= std::rint(b) * ly;
  }
  // Distances between opposite sides.
  double width() const { return lx * ly / std::sqrt(ly * ly + xy * xy); }
  double height() const { return ly; }
};

// Closed polygons of vertices, each polygon unwrapped.
struct PolygonVertices {
  Box box;
  std::vector<double> x;     // 2 a vertex
  std::vector<int> first;    // the vertices of polygon m are first[m] to first[m + 1] - 1
  std::vector<int> polygon, next, before;    // of each vertex

  PolygonVertices(const Box &box, std::vector<double> x, std::vector<int> first)
      : box(box),
        x(std::move(x)),
        first(std::move(first))
  {
    const int polygons = static_cast<int>(this->first.size()) - 1;
    for (int m = 0; m < polygons; ++m) {
      const int begin = this->first[m], end = this->first[m + 1];
      for (int k = begin; k < end; ++k) {
        polygon.push_back(m);
        next.push_back(k + 1 < end ? k + 1 : begin);
        before.push_back(k > begin ? k - 1 : end - 1);
      }
    }
  }

  int size() const { return static_cast<int>(polygon.size()); }

  double longest_edge() const
  {
    double longest = 0.0;
    for (int k = 0; k < size(); ++k) {
      const double ex = x[2 * next[k]] - x[2 * k], ey = x[2 * next[k] + 1] - x[2 * k + 1];
      longest = std::max(longest, std::sqrt(ex * ex + ey * ey));
    }
    return longest;
  }
};

// Calls visit(a, k, dx, dy) for each vertex a and each edge from k to its successor, of another polygon, with
// k within this distance of a; (dx, dy) goes from k to the nearest image of a. The distance must be below
// half of the box' width and height.
template <class Visit>
void for_each_near_edge(const PolygonVertices &v, double distance, Visit &&visit)
{
  const int columns = std::max(1, static_cast<int>(v.box.width() / distance));
  const int rows = std::max(1, static_cast<int>(v.box.height() / distance));
  const auto wrapped = [](int n, int count) { return (n % count + count) % count; };
  std::vector<int> column(v.size()), row(v.size()), start(columns * rows + 1, 0), sorted(v.size());
  for (int k = 0; k < v.size(); ++k) {
    double a, b;
    v.box.fractions(v.x[2 * k], v.x[2 * k + 1], a, b);
    // a position that rounds to the far end of the box is in the first cell
    column[k] = wrapped(static_cast<int>((a - std::floor(a)) * columns), columns);
    row[k] = wrapped(static_cast<int>((b - std::floor(b)) * rows), rows);
    ++start[row[k] * columns + column[k] + 1];
  }
  for (std::size_t cell = 1; cell < start.size(); ++cell) start[cell] += start[cell - 1];
  std::vector<int> filled(start);
  for (int k = 0; k < v.size(); ++k) sorted[filled[row[k] * columns + column[k]]++] = k;

  // with fewer than three cells in a direction, some neighbors are the same cell
  const int right = columns > 2 ? 1 : columns - 2, up = rows > 2 ? 1 : rows - 2;
  for (int a = 0; a < v.size(); ++a)
    for (int j = -1; j <= up; ++j)
      for (int i = -1; i <= right; ++i) {
        const int cell = wrapped(row[a] + j, rows) * columns + wrapped(column[a] + i, columns);
        for (int n = start[cell]; n < start[cell + 1]; ++n) {
          const int k = sorted[n];
          if (v.polygon[a] == v.polygon[k]) continue;
          double dx = v.x[2 * a] - v.x[2 * k], dy = v.x[2 * a + 1] - v.x[2 * k + 1];
          v.box.to_nearest(dx, dy);
          if (dx * dx + dy * dy < distance * distance) visit(a, k, dx, dy);
        }
      }
}

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
    const double length = std::sqrt(ex * ex + ey * ey), stretch = length - p.length;
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
  // about the origin, far images lose no digits
  const double *x = v.x.data(), *origin = x + 2 * v.first[m];
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
    const double length = std::sqrt(e[0] * e[0] + e[1] * e[1]), ratio = p.length / length;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        const double along = e[i] * e[j] / (length * length);
        const double s = p.kL * ((i == j ? 1.0 - ratio : 0.0) + ratio * along);
        h.add(2 * k + i, 2 * k + j, s);
        h.add(2 * next + i, 2 * next + j, s);
        h.add(2 * k + i, 2 * next + j, -s);
        h.add(2 * next + j, 2 * k + i, -s);
      }
    // d2A/dx_k dy_k+1 = 1/2 = -d2A/dy_k dx_k+1
    const double half = -0.5 * u.pressure[v.polygon[k]];
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
