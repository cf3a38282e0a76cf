#include "kernels/spring_matrix.h"

#include "kernels/large_vector.h"

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace deformable;

void SpringMatrix::factorize(const FrontKernels &kernels_, int dimension_, int n, const double *x,
                             const std::vector<char> &held, const std::vector<Element> &elements,
                             double epsilon)
{
  kernels = kernels_;
  dimension = dimension_;
  size = n;
  find_neighbors(elements);
  order.resize(n);
  std::iota(order.begin(), order.end(), 0);
  side.assign(n, -1);
  group.assign(n, -1);
  sides = groups = 0;
  fronts.clear();
  dissect(x, 0, n);
  place.resize(n);
  for (int k = 0; k < n; ++k) place[order[k]] = k;
  find_blocks(held, elements, epsilon);
  factorize_fronts();
}

void SpringMatrix::find_neighbors(const std::vector<Element> &elements)
{
  first_neighbor.assign(size + 1, 0);
  for (const Element &e : elements)
    if (e.j >= 0) {
      ++first_neighbor[e.i];
      ++first_neighbor[e.j];
    }
  std::partial_sum(first_neighbor.begin(), first_neighbor.end(), first_neighbor.begin());
  neighbor.resize(first_neighbor[size]);
  for (const Element &e : elements)
    if (e.j >= 0) {
      neighbor[--first_neighbor[e.i]] = e.j;
      neighbor[--first_neighbor[e.j]] = e.i;
    }
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
  if (n <= FEW) {
    add_front(begin, end);
    return;
  }

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
  const int last = begin + near + end - middle;
  dissect(x, begin, begin + near);
  dissect(x, begin + near, last);
  add_front(last, end);
}

void SpringMatrix::add_front(int begin, int end)
{
  if (begin < end) fronts.push_back({begin, end, 0, 0, 0, 0});
}

/* ----------------------------------------------------------------------
   P: the blocks of d x d numbers on its diagonal, and those of springs.
------------------------------------------------------------------------- */

void SpringMatrix::find_blocks(const std::vector<char> &held, const std::vector<Element> &elements,
                               double epsilon)
{
  const int D = dimension, B = D * D;
  diagonal.assign(static_cast<std::size_t>(B) * size, 0.0);
  const auto is_block = [this](const Element &e) { return e.j >= 0 && group[e.i] == group[e.j]; };
  first_block.assign(size + 1, 0);
  for (const Element &e : elements)
    if (is_block(e)) ++first_block[std::min(place[e.i], place[e.j])];
  std::partial_sum(first_block.begin(), first_block.end(), first_block.begin());
  blocks.resize(first_block[size]);

  for (const Element &e : elements) {
    double a[3], b[3];
    for (int r = 0; r < D; ++r) {
      a[r] = held[3 * e.i + r] ? 0.0 : component(e.n, r);
      b[r] = e.j < 0 || held[3 * e.j + r] ? 0.0 : component(e.n, r);
    }
    double *const of_i = &diagonal[B * place[e.i]];
    for (int t = 0; t < B; ++t) of_i[t] += e.weight * a[t / D] * a[t % D];
    if (e.j < 0) continue;
    double *const of_j = &diagonal[B * place[e.j]];
    for (int t = 0; t < B; ++t) of_j[t] += e.weight * b[t / D] * b[t % D];
    if (!is_block(e)) continue;
    const bool j_later = place[e.j] > place[e.i];
    const double *const below = j_later ? b : a, *const above = j_later ? a : b;
    Block &block = blocks[--first_block[std::min(place[e.i], place[e.j])]];
    block.later = std::max(place[e.i], place[e.j]);
    for (int t = 0; t < B; ++t) block.number[t] = -e.weight * below[t / D] * above[t % D];
  }

  double trace = 0.0;
  int bound = 0;    // coordinates with a spring
  for (int k = 0; k < size; ++k)
    for (int r = 0; r < D; ++r) {
      const double number = diagonal[B * k + (D + 1) * r];
      trace += number;
      bound += number > 0.0;
    }
  mean = trace > 0.0 ? trace / bound : 1.0;
  for (int k = 0; k < size; ++k)
    for (int r = 0; r < D; ++r)
      diagonal[B * k + (D + 1) * r] += held[3 * order[k] + r] ? mean : epsilon * mean;
}

/* ----------------------------------------------------------------------
   Front by front: its columns of P, and what earlier fronts have left of them;
   then L of these columns, and what that subtracts from the rows below. An
   earlier front hands it on to that of its first row.
------------------------------------------------------------------------- */

void SpringMatrix::factorize_fronts()
{
  const int D = dimension, n = static_cast<int>(fronts.size());
  std::vector<int> front_of(size), last_child(n, -1), sibling(n, -1), local(size), seen(size, -1);
  std::vector<std::vector<float>> left(n);
  for (int f = 0; f < n; ++f)
    for (int k = fronts[f].begin; k < fronts[f].end; ++k) front_of[k] = f;
  rows.clear();
  lower.clear();
  std::size_t highest = 0;
  for (int f = 0; f < n; ++f) {
    Front &front = fronts[f];
    const int begin = front.begin, end = front.end;
    const auto add_row = [&](int r) {
      if (r < end || seen[r] == f) return;
      seen[r] = f;
      rows.push_back(r);
    };
    front.first_row = static_cast<int>(rows.size());
    for (int b = first_block[begin]; b < first_block[end]; ++b) add_row(blocks[b].later);
    for (int child = last_child[f]; child >= 0; child = sibling[child])
      for (int r = fronts[child].first_row; r < fronts[child].last_row; ++r) add_row(rows[r]);
    front.last_row = static_cast<int>(rows.size());
    std::sort(rows.begin() + front.first_row, rows.end());
    for (int k = begin; k < end; ++k) local[k] = D * (k - begin);
    const int width = D * (end - begin);
    for (int r = front.first_row; r < front.last_row; ++r)
      local[rows[r]] = width + D * (r - front.first_row);
    const int height = front.height = width + D * (front.last_row - front.first_row);
    highest = std::max<std::size_t>(highest, height);

    // columns of height numbers each, the lower triangle only, and the rows below as a square matrix
    const std::size_t below = height - width;
    front.at = lower.size();
    lower.resize(front.at + static_cast<std::size_t>(width) * height);
    left[f].assign(below * below, 0.0F);
    float *const own = lower.data() + front.at, *const rest = left[f].data();
    const auto at = [&](int row, int col) -> float & {
      return col < width ? own[static_cast<std::size_t>(col) * height + row]
                         : rest[(col - width) * below + row - width];
    };
    for (int k = begin; k < end; ++k) {
      for (int t = 0; t < D * D; ++t)
        at(local[k] + t / D, local[k] + t % D) += static_cast<float>(diagonal[D * D * k + t]);
      for (int b = first_block[k]; b < first_block[k + 1]; ++b)
        for (int t = 0; t < D * D; ++t)
          at(local[blocks[b].later] + t / D, local[k] + t % D) +=
              static_cast<float>(blocks[b].number[t]);
    }
    for (int child = last_child[f]; child >= 0; child = sibling[child]) {
      const Front &of = fronts[child];
      const int side_length = D * (of.last_row - of.first_row);
      const float *column_of_child = left[child].data();
      for (int c = of.first_row; c < of.last_row; ++c)
        for (int s = 0; s < D; ++s, column_of_child += side_length) {
          float *const to = &at(0, local[rows[c]] + s);
          for (int r = c; r < of.last_row; ++r)
            for (int t = 0; t < D; ++t)
              to[local[rows[r]] + t] += column_of_child[D * (r - of.first_row) + t];
        }
      left[child] = {};
    }

    kernels.factorize(own, width, height, rest);
    if (front.first_row == front.last_row) continue;
    const int parent = front_of[rows[front.first_row]];
    sibling[f] = last_child[parent];
    last_child[parent] = f;
  }
  unknown.resize(static_cast<std::size_t>(D) * size);
  lower.resize(lower.size() + FRONT_MARGIN);
  column.resize(highest + FRONT_MARGIN);
}

void SpringMatrix::solve(const std::vector<int> &index, const double *q, double *z)
{
  const int D = dimension, particles = static_cast<int>(index.size());
  double largest = 0.0;    // single precision has a small range
  for (int k = 0; k < 3 * particles; ++k) largest = std::max(largest, std::fabs(q[k]));
  if (!(largest > 0.0)) largest = 1.0;
  std::fill(unknown.begin(), unknown.end(), 0.0F);
  for (int i = 0; i < particles; ++i)
    for (int r = 0; r < D && index[i] >= 0; ++r)
      unknown[D * place[index[i]] + r] = static_cast<float>(q[3 * i + r] / largest);

  float *const y = column.data();
  for (const Front &front : fronts) {
    float *const own = &unknown[D * front.begin];
    const int width = D * (front.end - front.begin), height = front.height;
    std::copy_n(own, width, y);
    std::fill(y + width, y + height, 0.0F);
    kernels.forward(&lower[front.at], width, height, y);
    std::copy_n(y, width, own);
    const float *below = y + width;
    for (int r = front.first_row; r < front.last_row; ++r, below += D)
      for (int s = 0; s < D; ++s) unknown[D * rows[r] + s] += below[s];
  }
  for (auto front = fronts.rbegin(); front != fronts.rend(); ++front) {
    float *const own = &unknown[D * front->begin], *below = y + D * (front->end - front->begin);
    const int width = D * (front->end - front->begin), height = front->height;
    std::copy_n(own, width, y);
    for (int r = front->first_row; r < front->last_row; ++r, below += D)
      std::copy_n(&unknown[D * rows[r]], D, below);
    kernels.backward(&lower[front->at], width, height, y);
    std::copy_n(y, width, own);
  }

  for (int i = 0; i < particles; ++i) {
    for (int r = 0; r < 3; ++r) z[3 * i + r] = q[3 * i + r] / mean;
    for (int r = 0; r < D && index[i] >= 0; ++r)
      z[3 * i + r] = largest * unknown[D * place[index[i]] + r];
  }
}

double SpringMatrix::solves_per_factor() const
{
  double products = 0.0, of_solve = 0.0;
  for (const Front &front : fronts) {
    const double numbers =
        static_cast<double>(front.height) * dimension * (front.end - front.begin);
    products += 0.5 * numbers * front.height;
    of_solve += 2.0 * numbers;
  }
  return of_solve > 0.0 ? products / of_solve : 0.0;
}

double SpringMatrix::memory_usage() const
{
  return bytes_of(order, place, fronts, rows, lower, unknown, column, first_block, blocks, diagonal,
                  first_neighbor, neighbor, side, group);
}
