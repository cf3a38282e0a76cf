// Vertices near edges of other polygons, in a periodic box: a cell list.

#ifndef DEFORMABLE_EDGE_NEIGHBORS_H
#define DEFORMABLE_EDGE_NEIGHBORS_H

#include <algorithm>
#include <cmath>
#include <cstddef>
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
  double width() const { return lx * ly / std::hypot(ly, xy); }
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
    for (int k = 0; k < size(); ++k)
      longest = std::max(longest,
                         std::hypot(x[2 * next[k]] - x[2 * k], x[2 * next[k] + 1] - x[2 * k + 1]));
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

}    // namespace deformable

#endif
