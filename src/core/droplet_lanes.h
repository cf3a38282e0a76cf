// Droplets with given forces, contacts of a droplet side by side: see droplet.h and droplet_kernels.h. Each place has its own
// sums, over contacts in their order, so that all levels agree to the last bit.

#ifndef DEFORMABLE_DROPLET_LANES_H
#define DEFORMABLE_DROPLET_LANES_H

#include "droplet.h"
#include "droplet_kernels.h"
#include "lane_logarithm.h"

#include <algorithm>

namespace deformable::DEFORMABLE_LEVEL {

// Indentations and work, and what their derivatives need, from the forces of the places and their responses.
DEFORMABLE_LANE_FUNCTION void finish_droplet(const DropletArrays &d, int i)
{
  const int begin = d.first[i], end = d.first[i + 1], contacts = begin + d.contacts[i];
  double sum = 0.0, sum_of_squares = 0.0;
  for (int c = begin; c < contacts; ++c) {
    sum += d.force[c];
    sum_of_squares += d.force[c] * d.force[c];
  }
  const DropletLoad load(sum, sum_of_squares);
  const double radius = d.radius[i], of_all = load.squares * load.slope,
               over_tension = 1.0 / d.tension[i];
  double work = 0.0;
  for (int c = begin; c < end; c += W) {
    const Lanes f = deformable::DEFORMABLE_LEVEL::load<Lanes>(d.force + c),
                response = deformable::DEFORMABLE_LEVEL::load<Lanes>(d.response + c);
    const Lanes l = LOG_8_PI - logarithm(larger(f, all(1e-300))).value;
    const Lanes own = own_work(f, l, load.logarithm) + 0.5 * f * response;
    for (int w = 0; w < W; ++w) work += own[w];
    store(d.indentation + c,
          radius * (own_indentation(f, l, load.logarithm) + (response + of_all)));
    store(d.compliance + c, own_compliance(l, load.logarithm) * over_tension);
    store(d.rounded + c, f);
  }
  d.load[i] = load.x;
  d.work[i] = d.tension[i] * radius * radius * work;
  d.slope[i] = static_cast<float>(load.slope);
  d.bend[i] = static_cast<float>(load.squares * load.bend);
}

static void evaluate_droplets(const DropletArrays &d, const PairForces &p, int begin, int end)
{
  for (int i = begin; i < end; ++i) {
    const int first = d.first[i], places = d.first[i + 1] - first, contacts = d.contacts[i];
    double *const nx = d.nx + first, *const ny = d.ny + first, *const nz = d.nz + first,
                  *const f = d.force + first;
    const double unit = 1.0 / (d.radius[i] * d.tension[i]);
    for (int c = 0; c < places; ++c) {
      const int k = d.seat[first + c] >> 1;
      const double sign = d.seat[first + c] & 1 ? -1.0 : 1.0;
      f[c] = unit * p.force[k];
      nx[c] = sign * p.nx[k];
      ny[c] = sign * p.ny[k];
      nz[c] = sign * p.nz[k];
    }
    float *const green = d.green + d.matrix[i], *const d_green = d.d_green + d.matrix[i];
    const Lanes lane = each_lane([](int w) DEFORMABLE_LANE_LAMBDA { return 1.0 * w; });
    for (int row = 0; row < places; row += W) {
      const Lanes x = load<Lanes>(nx + row), y = load<Lanes>(ny + row), z = load<Lanes>(nz + row);
      Lanes response{}, tx{}, ty{}, tz{};
      for (int k = 0; k < contacts; ++k) {
        const Lanes m = x * nx[k] + y * ny[k] + z * nz[k];
        const Logarithm half = logarithm(larger(0.5 - 0.5 * m, all(SMALLEST_HALF)));
        const Mask same = lane == static_cast<double>(k - row);
        const Lanes g = select(same, Lanes{}, droplet_green(m, half.value)),
                    dg = select(same, Lanes{}, d_droplet_green(m, half.value, half.over));
        store(green + k * places + row, g);
        store(d_green + k * places + row, dg);
        const Lanes turned = dg * f[k];
        response += g * f[k];
        tx += turned * nx[k];
        ty += turned * ny[k];
        tz += turned * nz[k];
      }
      store(d.response + first + row, response);
      store(d.tx + first + row, tx);
      store(d.ty + first + row, ty);
      store(d.tz + first + row, tz);
    }
    finish_droplet(d, i);
  }
}

// Steps of the forces of the places of droplet i, into `scratch`. Returns the end of those that are not 0.
DEFORMABLE_LANE_FUNCTION int gather_steps(const DropletArrays &d, const float *step, int i)
{
  const int first = d.first[i], places = d.first[i + 1] - first;
  for (int c = 0; c < places; ++c) d.scratch[c] = step[d.seat[first + c] >> 1];
  int end = d.contacts[i];
  while (end > 0 && d.scratch[end - 1] == 0.0f) --end;
  return end;
}

DEFORMABLE_LANE_FUNCTION void add(double *to, Floats x, double unit)
{
  float numbers[FLOATS];
  store_floats(numbers, x);
  for (int w = 0; w < FLOATS; w += W)
    store(to + w, load<Lanes>(to + w) + unit * load<Lanes>(numbers + w));
}

static void adapt_droplets(const DropletArrays &d, const PairForces &p, const float *step,
                           int begin, int end)
{
  for (int i = begin; i < end; ++i) {
    const int first = d.first[i], places = d.first[i + 1] - first,
              end_of_steps = gather_steps(d, step, i);
    const double unit = 1.0 / (d.radius[i] * d.tension[i]);
    const float *const green = d.green + d.matrix[i], *const d_green = d.d_green + d.matrix[i],
                       *const y = d.scratch;
    const double *const nx = d.nx + first, *const ny = d.ny + first, *const nz = d.nz + first;
    for (int row = 0; row < places; row += FLOATS) {
      Floats response{}, tx{}, ty{}, tz{};
      for (int k = 0; k < end_of_steps; ++k) {
        const Floats turned = load<Floats>(d_green + k * places + row) * y[k];
        response += load<Floats>(green + k * places + row) * y[k];
        tx += turned * static_cast<float>(nx[k]);
        ty += turned * static_cast<float>(ny[k]);
        tz += turned * static_cast<float>(nz[k]);
      }
      add(d.response + first + row, response, unit);
      add(d.tx + first + row, tx, unit);
      add(d.ty + first + row, ty, unit);
      add(d.tz + first + row, tz, unit);
    }
    for (int c = first; c < first + places; ++c) d.force[c] = unit * p.force[d.seat[c] >> 1];
    finish_droplet(d, i);
  }
}

// The derivatives of a by f are  G + own + (f/4pi) L'.1 + 1.(f/4pi) L' + 1 S L'' 1, with L' by sum f.
static void multiply_droplets(const DropletArrays &d, const float *step, float *product, int begin,
                              int end)
{
  for (int i = begin; i < end; ++i) {
    const int first = d.first[i], places = d.first[i + 1] - first,
              end_of_steps = gather_steps(d, step, i);
    const float *const green = d.green + d.matrix[i], *const y = d.scratch;
    const float *const f = d.rounded + first;
    float sum = 0.0f, along = 0.0f;
    for (int c = 0; c < end_of_steps; ++c) {
      sum += y[c];
      along += f[c] * y[c];
    }
    const float slope = d.slope[i] * static_cast<float>(0.25 / PI);
    const float of_all = slope * along + d.bend[i] * sum, of_each = slope * sum,
                unit = static_cast<float>(1.0 / d.tension[i]);
    for (int row = 0; row < places; row += FLOATS) {
      const Floats own = load<Floats>(d.compliance + first + row), here = load<Floats>(y + row);
      Floats sums = of_each * load<Floats>(f + row) + of_all;
      for (int k = 0; k < end_of_steps; ++k) sums += load<Floats>(green + k * places + row) * y[k];
      store_floats(product + first + row, own * here + unit * sums);
    }
  }
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
