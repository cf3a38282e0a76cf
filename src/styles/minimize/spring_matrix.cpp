#include "styles/minimize/spring_matrix.h"

#include "solver/large_vector.h"

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace LAMMPS_NS;
using deformable::Vector3;

namespace {

double component(const Vector3 &v, int axis)
{
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

// A block is stored row by row. c -= a b^T
template <int D> void subtract_product(const double *a, const double *b, double *c)
{
  for (int r = 0; r < D; ++r)
    for (int s = 0; s < D; ++s) {
      double sum = 0.0;
      for (int t = 0; t < D; ++t) sum += a[D * r + t] * b[D * s + t];
      c[D * r + s] -= sum;
    }
}

// The inverse of the lower triangle l of a = l l^T, which is positive definite.
template <int D> void inverse_triangle(const double *a, double *inverse)
{
  double l[D][D] = {};
  for (int r = 0; r < D; ++r)
    for (int s = 0; s <= r; ++s) {
      double sum = a[D * r + s];
      for (int t = 0; t < s; ++t) sum -= l[r][t] * l[s][t];
      l[r][s] = r == s ? std::sqrt(sum) : sum / l[s][s];
    }
  for (int s = 0; s < D; ++s)
    for (int r = 0; r < D; ++r) {
      double sum = r == s ? 1.0 : 0.0;
      for (int t = s; t < r; ++t) sum -= l[r][t] * inverse[D * t + s];
      inverse[D * r + s] = r < s ? 0.0 : sum / l[r][r];
    }
}

}    // namespace

/* ---------------------------------------------------------------------- */

void SpringMatrix::factorize(int dimension_, int n, const double *x, const std::vector<char> &held,
                             const std::vector<Element> &elements)
{
  dimension = dimension_;
  size = n;

  first_neighbor.assign(n + 1, 0);
  for (const Element &e : elements)
    if (e.j >= 0) {
      ++first_neighbor[e.i];
      ++first_neighbor[e.j];
    }
  std::partial_sum(first_neighbor.begin(), first_neighbor.end(), first_neighbor.begin());
  neighbor.resize(first_neighbor[n]);
  for (const Element &e : elements)
    if (e.j >= 0) {
      neighbor[--first_neighbor[e.i]] = e.j;
      neighbor[--first_neighbor[e.j]] = e.i;
    }

  order.resize(n);
  std::iota(order.begin(), order.end(), 0);
  side.assign(n, -1);
  group.assign(n, -1);
  sides = groups = 0;
  dissect(x, 0, n);
  place.resize(n);
  for (int k = 0; k < n; ++k) place[order[k]] = k;
  find_structure();
  if (dimension == 2)
    factorize<2>(held, elements);
  else
    factorize<3>(held, elements);
}

/* ----------------------------------------------------------------------
   Orders the particles of one part: those on one side of the middle of its
   longest extent, those on the other side, those that part them.
------------------------------------------------------------------------- */

void SpringMatrix::dissect(const double *x, int begin, int end)
{
  constexpr int FEW = 16;
  // In space L grows faster than the number of particles: the time of larger parts is more than that of the calls that they spare.
  const int most = dimension == 2 ? 1 << 15 : 1 << 8;
  const int n = end - begin;
  if (n == 0) return;
  if (n <= most && group[order[begin]] < 0) {
    for (int k = begin; k < end; ++k) group[order[k]] = groups;
    ++groups;
  }
  if (n <= FEW) return;

  int axis = 0;
  double longest = -1.0;
  for (int a = 0; a < dimension; ++a) {
    double low = x[3 * order[begin] + a], high = low;
    for (int k = begin; k < end; ++k) {
      low = std::min(low, x[3 * order[k] + a]);
      high = std::max(high, x[3 * order[k] + a]);
    }
    if (high - low <= longest) continue;
    longest = high - low;
    axis = a;
  }
  const auto at = [this](int k) { return order.begin() + k; };
  const int middle = begin + n / 2;
  std::nth_element(at(begin), at(middle), at(end),
                   [&](int i, int j) { return x[3 * i + axis] < x[3 * j + axis]; });
  if (n > most) {
    dissect(x, begin, middle);
    dissect(x, middle, end);
    return;
  }
  const int far = ++sides;
  for (int k = middle; k < end; ++k) side[order[k]] = far;
  const auto touches = [&](int i) {
    const auto of = neighbor.begin();
    return std::any_of(of + first_neighbor[i], of + first_neighbor[i + 1],
                       [&](int j) { return side[j] == far; });
  };
  const auto parting = std::partition(at(begin), at(middle), [&](int i) { return !touches(i); });
  const int near = static_cast<int>(parting - at(begin));
  std::rotate(parting, at(middle), at(end));
  dissect(x, begin, begin + near);
  dissect(x, begin + near, begin + near + end - middle);
}

/* ----------------------------------------------------------------------
   Column k of L has the rows of column k of P, and those of all columns whose
   first row is k.
------------------------------------------------------------------------- */

void SpringMatrix::find_structure()
{
  const int n = size;
  std::vector<int> last_child(n, -1), sibling(n, -1), seen(n, -1);
  first.assign(n + 1, 0);
  row.clear();
  for (int k = 0; k < n; ++k) {
    const int i = order[k];
    const auto add = [&](int r) {
      if (r <= k || seen[r] == k) return;
      seen[r] = k;
      row.push_back(r);
    };
    for (int c = first_neighbor[i]; c < first_neighbor[i + 1]; ++c)
      if (group[neighbor[c]] == group[i]) add(place[neighbor[c]]);
    for (int child = last_child[k]; child >= 0; child = sibling[child])
      for (int b = first[child]; b < first[child + 1]; ++b) add(row[b]);
    first[k + 1] = static_cast<int>(row.size());
    if (first[k] == first[k + 1]) continue;
    std::sort(row.begin() + first[k], row.end());
    const int parent = row[first[k]];
    sibling[k] = last_child[parent];
    last_child[parent] = k;
  }
}

/* ----------------------------------------------------------------------
   Column by column: all earlier columns that have a block in row k are
   subtracted from column k. They stand in a list of those whose next block is
   in this row.
------------------------------------------------------------------------- */

template <int D>
void SpringMatrix::factorize(const std::vector<char> &held, const std::vector<Element> &elements)
{
  constexpr int B = D * D;
  const int n = size;
  value.assign(B * row.size(), 0.0);
  diagonal.assign(B * n, 0.0);
  unknown.resize(D * n);
  products = 0.0;

  for (const Element &e : elements) {
    double a[D], b[D];
    for (int r = 0; r < D; ++r) {
      a[r] = held[3 * e.i + r] ? 0.0 : component(e.n, r);
      b[r] = e.j < 0 || held[3 * e.j + r] ? 0.0 : component(e.n, r);
    }
    double *const of_i = &diagonal[B * place[e.i]];
    for (int r = 0; r < D; ++r)
      for (int s = 0; s < D; ++s) of_i[D * r + s] += e.weight * a[r] * a[s];
    if (e.j < 0) continue;
    double *const of_j = &diagonal[B * place[e.j]];
    for (int r = 0; r < D; ++r)
      for (int s = 0; s < D; ++s) of_j[D * r + s] += e.weight * b[r] * b[s];
    if (group[e.i] != group[e.j]) continue;
    const bool later = place[e.i] > place[e.j];    // the row is that of the later one
    const int k = later ? place[e.j] : place[e.i];
    const int r_place = later ? place[e.i] : place[e.j];
    const auto found =
        std::lower_bound(row.begin() + first[k], row.begin() + first[k + 1], r_place);
    double *const block = &value[B * (found - row.begin())];
    const double *const below = later ? a : b, *const above = later ? b : a;
    for (int r = 0; r < D; ++r)
      for (int s = 0; s < D; ++s) block[D * r + s] -= e.weight * below[r] * above[s];
  }

  double trace = 0.0;
  int free = 0;
  for (int k = 0; k < n; ++k)
    for (int r = 0; r < D; ++r) {
      trace += diagonal[B * k + (D + 1) * r];
      free += !held[3 * order[k] + r];
    }
  mean = trace > 0.0 ? trace / free : 1.0;
  for (int k = 0; k < n; ++k)
    for (int r = 0; r < D; ++r)
      diagonal[B * k + (D + 1) * r] += held[3 * order[k] + r] ? mean : EPSILON * mean;

  std::vector<int> next(n), chain(n, -1), in_row(n, -1);
  std::vector<double> whole_column(B * n);
  double *const column = whole_column.data(), *const lower = value.data();
  const int *const rows = row.data();
  for (int k = 0; k < n; ++k) {
    const int begin = first[k], end = first[k + 1];
    const double blocks = end - begin;
    products += 0.5 * blocks * (blocks + 3.0);
    double *const on_diagonal = &diagonal[B * k];
    for (int b = begin; b < end; ++b) std::copy_n(lower + B * b, B, column + B * rows[b]);
    for (int c = in_row[k]; c >= 0;) {
      const int of_k = next[c]++, end_of_c = first[c + 1], following = chain[c];
      const double *const factor = lower + B * of_k;
      subtract_product<D>(factor, factor, on_diagonal);
      for (int b = of_k + 1; b < end_of_c; ++b)
        subtract_product<D>(lower + B * b, factor, column + B * rows[b]);
      if (next[c] < end_of_c) {
        const int r = rows[next[c]];
        chain[c] = in_row[r];
        in_row[r] = c;
      }
      c = following;
    }
    double inverse[B];
    inverse_triangle<D>(on_diagonal, inverse);
    std::copy_n(inverse, B, on_diagonal);
    for (int b = begin; b < end; ++b) {
      double *const block = lower + B * b;
      std::fill_n(block, B, 0.0);
      subtract_product<D>(column + B * rows[b], inverse, block);
      for (int t = 0; t < B; ++t) block[t] = -block[t];
    }
    if (begin == end) continue;
    next[k] = begin;
    chain[k] = in_row[row[begin]];
    in_row[row[begin]] = k;
  }
}

/* ---------------------------------------------------------------------- */

template <int D> void SpringMatrix::solve_blocks()
{
  constexpr int B = D * D;
  const int *const begin_of = first.data(), *const rows = row.data();
  const double *const blocks = value.data(), *const inverses = diagonal.data();
  double *const u = unknown.data();
  for (int k = 0; k < size; ++k) {
    const double *const inverse = inverses + B * k;
    double v[D];
    for (int r = 0; r < D; ++r) {
      v[r] = 0.0;
      for (int s = 0; s <= r; ++s) v[r] += inverse[D * r + s] * u[D * k + s];
    }
    for (int r = 0; r < D; ++r) u[D * k + r] = v[r];
    for (int b = begin_of[k]; b < begin_of[k + 1]; ++b) {
      const double *const block = blocks + B * b;
      double *const w = u + D * rows[b];
      for (int r = 0; r < D; ++r) {
        double product = 0.0;
        for (int s = 0; s < D; ++s) product += block[D * r + s] * v[s];
        w[r] -= product;
      }
    }
  }
  for (int k = size - 1; k >= 0; --k) {
    const double *const inverse = inverses + B * k;
    double v[D];
    for (int r = 0; r < D; ++r) v[r] = u[D * k + r];
    for (int b = begin_of[k]; b < begin_of[k + 1]; ++b) {
      const double *const block = blocks + B * b, *const w = u + D * rows[b];
      for (int s = 0; s < D; ++s) {
        double product = 0.0;
        for (int r = 0; r < D; ++r) product += block[D * r + s] * w[r];
        v[s] -= product;
      }
    }
    for (int r = 0; r < D; ++r) {
      double sum = 0.0;
      for (int s = r; s < D; ++s) sum += inverse[D * s + r] * v[s];
      u[D * k + r] = sum;
    }
  }
}

void SpringMatrix::solve(const std::vector<int> &index, const double *q, double *z)
{
  const int particles = static_cast<int>(index.size());
  std::fill(unknown.begin(), unknown.end(), 0.0);
  for (int i = 0; i < particles; ++i)
    if (index[i] >= 0) std::copy_n(q + 3 * i, dimension, &unknown[dimension * place[index[i]]]);
  if (dimension == 2)
    solve_blocks<2>();
  else
    solve_blocks<3>();
  for (int i = 0; i < particles; ++i) {
    for (int r = 0; r < 3; ++r) z[3 * i + r] = q[3 * i + r] / mean;
    if (index[i] >= 0) std::copy_n(&unknown[dimension * place[index[i]]], dimension, z + 3 * i);
  }
}

double SpringMatrix::solves_per_factor() const
{
  return size == 0 ? 0.0 : products * dimension / (2.0 * row.size() + size);
}

double SpringMatrix::memory_usage() const
{
  return bytes_of(order, place, first, row, value, diagonal, unknown, first_neighbor, neighbor,
                  side, group);
}
