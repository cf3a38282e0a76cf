// Droplets with given forces, side by side: see droplet.h and droplet_kernels.h.

#ifndef DEFORMABLE_DROPLET_LANES_H
#define DEFORMABLE_DROPLET_LANES_H

#include "kernels/droplet_kernels.h"
#include "kernels/lane_logarithm.h"
#include "laws/droplet.h"

#include <algorithm>

namespace deformable::DEFORMABLE_LEVEL {

// Indentations and work, and what their derivatives need, from the forces of the places and their responses.
DEFORMABLE_LANE_FUNCTION void finish_droplets(const DropletArrays &d, int batch)
{
  const int begin = d.first[batch] * LANES, end = d.first[batch + 1] * LANES;
  for (int w = 0; w < LANES; w += W) {
    Lanes sum{}, sum_of_squares{}, work{};
    for (int c = begin + w; c < end; c += LANES) {
      const Lanes f = load<Lanes>(d.force + c);
      sum += f;
      sum_of_squares += f * f;
    }
    const DropletLoad<Lanes> of(sum, sum_of_squares,
                                [](Lanes x) DEFORMABLE_LANE_LAMBDA { return logarithm(x).value; });
    const int droplet = batch * LANES + w;
    const Lanes radius = load<Lanes>(d.radius + droplet),
                tension = load<Lanes>(d.tension + droplet), of_all = of.squares * of.slope,
                over_tension = 1.0 / tension;
    for (int c = begin + w; c < end; c += LANES) {
      const Lanes f = load<Lanes>(d.force + c), response = load<Lanes>(d.response + c);
      const Lanes l = LOG_8_PI - logarithm(larger(f, all(NO_FORCE))).value;
      work += own_work(f, l, of.logarithm) + 0.5 * f * response;
      store(d.indentation + c,
            radius * (own_indentation(f, l, of.logarithm) + (response + of_all)));
      store(d.compliance + c, own_compliance(l, of.logarithm) * over_tension);
      store(d.rounded + c, f);
    }
    store(d.load + droplet, of.x);
    store(d.facet + droplet, of.facet);
    store(d.work + droplet, tension * radius * radius * work);
    store(d.slope + droplet, of.slope);
    store(d.bend + droplet, of.squares * of.bend);
  }
}

static void evaluate_droplets(const DropletArrays &d, const PairForces &p, int begin, int end)
{
  for (int batch = begin; batch < end; ++batch) {
    const int first = d.first[batch] * LANES, places = d.first[batch + 1] * LANES - first;
    double *const nx = d.nx + first, *const ny = d.ny + first, *const nz = d.nz + first,
                  *const f = d.force + first, *const response = d.response + first,
                  *const tx = d.tx + first, *const ty = d.ty + first, *const tz = d.tz + first;
    double unit[LANES];
    for (int w = 0; w < LANES; ++w)
      unit[w] = 1.0 / (d.radius[batch * LANES + w] * d.tension[batch * LANES + w]);
    for (int c = 0; c < places; ++c) {
      const int k = d.seat[first + c] >> 1;
      const double sign = d.seat[first + c] & 1 ? -1.0 : 1.0;
      f[c] = unit[c % LANES] * p.force[k];
      nx[c] = sign * p.nx[k];
      ny[c] = sign * p.ny[k];
      nz[c] = sign * p.nz[k];
    }
    for (int w = 0; w < LANES; w += W) {
      float *green = d.green + d.first_green[batch] * LANES,
            *d_green = d.d_green + d.first_green[batch] * LANES;
      for (int c = w; c < places; c += LANES) {
        const Lanes x = load<Lanes>(nx + c), y = load<Lanes>(ny + c), z = load<Lanes>(nz + c),
                    of_c = load<Lanes>(f + c);
        Lanes sum{}, sum_x{}, sum_y{}, sum_z{};
        for (int k = w; k < c; k += LANES) {
          const Lanes xk = load<Lanes>(nx + k), yk = load<Lanes>(ny + k), zk = load<Lanes>(nz + k),
                      of_k = load<Lanes>(f + k);
          const Lanes m = x * xk + y * yk + z * zk, apart = 0.5 - 0.5 * m;
          const Logarithm half = logarithm(larger(apart, all(SMALLEST_HALF)));
          const Lanes g = droplet_green(m, half.value),
                      slope = d_droplet_green(m, half.value, half.over),
                      dg = apart > SMALLEST_HALF ? slope : Lanes{};
          store(green + k, g);
          store(d_green + k, dg);
          const Lanes by_c = dg * of_c, by_k = dg * of_k;
          sum += g * of_k;
          sum_x += by_k * xk;
          sum_y += by_k * yk;
          sum_z += by_k * zk;
          store(response + k, load<Lanes>(response + k) + g * of_c);
          store(tx + k, load<Lanes>(tx + k) + by_c * x);
          store(ty + k, load<Lanes>(ty + k) + by_c * y);
          store(tz + k, load<Lanes>(tz + k) + by_c * z);
        }
        store(response + c, sum);
        store(tx + c, sum_x);
        store(ty + c, sum_y);
        store(tz + c, sum_z);
        green += c - w;
        d_green += c - w;
      }
    }
    finish_droplets(d, batch);
  }
}

// Steps of the forces of the places of a batch. Returns the end of the contacts that take one in any of the droplets.
DEFORMABLE_LANE_FUNCTION int gather_steps(const DropletArrays &d, const float *step, int batch,
                                          float *to)
{
  const int first = d.first[batch] * LANES;
  int end = d.first[batch + 1] * LANES - first;
  for (int c = 0; c < end; ++c) to[c] = step[d.seat[first + c] >> 1];
  while (end > 0 && to[end - 1] == 0.0f) --end;
  return (end + LANES - 1) / LANES * LANES;
}

DEFORMABLE_LANE_FUNCTION void add(double *to, Floats x, const double *unit)
{
  float numbers[FLOATS];
  store_floats(numbers, x);
  for (int w = 0; w < FLOATS; w += W)
    store(to + w, load<Lanes>(to + w) + load<Lanes>(unit + w) * load<Lanes>(numbers + w));
}

static void adapt_droplets(const DropletArrays &d, const PairForces &p, const float *step,
                           int begin, int end)
{
  for (int batch = begin; batch < end; ++batch) {
    const int first = d.first[batch] * LANES, places = d.first[batch + 1] * LANES - first;
    float *const y = d.scratch, *const nx = y + places, *const ny = nx + places,
                 *const nz = ny + places, *const sum = nz + places, *const tx = sum + places,
                 *const ty = tx + places, *const tz = ty + places;
    const int end_of_steps = gather_steps(d, step, batch, y);
    for (int c = 0; c < places; ++c) {
      nx[c] = static_cast<float>(d.nx[first + c]);
      ny[c] = static_cast<float>(d.ny[first + c]);
      nz[c] = static_cast<float>(d.nz[first + c]);
    }
    double unit[LANES];
    for (int w = 0; w < LANES; ++w)
      unit[w] = 1.0 / (d.radius[batch * LANES + w] * d.tension[batch * LANES + w]);
    for (int w = 0; w < LANES; w += FLOATS) {
      const float *green = d.green + d.first_green[batch] * LANES,
                  *d_green = d.d_green + d.first_green[batch] * LANES;
      for (int c = w; c < places; c += LANES) {
        const Floats of_c = load<Floats>(y + c), x = load<Floats>(nx + c),
                     yc = load<Floats>(ny + c), z = load<Floats>(nz + c);
        Floats own{}, own_x{}, own_y{}, own_z{};
        for (int k = w; k < std::min(c, end_of_steps); k += LANES) {
          const Floats g = load<Floats>(green + k), dg = load<Floats>(d_green + k),
                       of_k = load<Floats>(y + k), by_c = dg * of_c, by_k = dg * of_k;
          own += g * of_k;
          own_x += by_k * load<Floats>(nx + k);
          own_y += by_k * load<Floats>(ny + k);
          own_z += by_k * load<Floats>(nz + k);
          store_floats(sum + k, load<Floats>(sum + k) + g * of_c);
          store_floats(tx + k, load<Floats>(tx + k) + by_c * x);
          store_floats(ty + k, load<Floats>(ty + k) + by_c * yc);
          store_floats(tz + k, load<Floats>(tz + k) + by_c * z);
        }
        store_floats(sum + c, own);
        store_floats(tx + c, own_x);
        store_floats(ty + c, own_y);
        store_floats(tz + c, own_z);
        green += c - w;
        d_green += c - w;
      }
      for (int c = w; c < places; c += LANES) {
        add(d.response + first + c, load<Floats>(sum + c), unit + w);
        add(d.tx + first + c, load<Floats>(tx + c), unit + w);
        add(d.ty + first + c, load<Floats>(ty + c), unit + w);
        add(d.tz + first + c, load<Floats>(tz + c), unit + w);
      }
    }
    for (int c = 0; c < places; ++c)
      d.force[first + c] = unit[c % LANES] * p.force[d.seat[first + c] >> 1];
    finish_droplets(d, batch);
  }
}

// The derivatives of a by f are  G + own + (f/4pi) L'.1 + 1.(f/4pi) L' + 1 S L'' 1, with L' by sum f.
static void multiply_droplets(const DropletArrays &d, const float *step, float *product, int begin,
                              int end)
{
  for (int batch = begin; batch < end; ++batch) {
    const int first = d.first[batch] * LANES;
    float *const y = d.scratch, *const result = product + first;
    const float *const f = d.rounded + first, *const compliance = d.compliance + first;
    const int places = d.first[batch + 1] * LANES - first,
              end_of_steps = gather_steps(d, step, batch, y);
    for (int w = 0; w < LANES; w += FLOATS) {
      const int droplet = batch * LANES + w;
      const Floats tension = floats_of(
          [&](int lane)
              DEFORMABLE_LANE_LAMBDA { return static_cast<float>(d.tension[droplet + lane]); },
          std::make_integer_sequence<int, FLOATS>());
      const Floats unit = 1.0f / tension;
      Floats sum{}, along{};
      for (int c = w; c < end_of_steps; c += LANES) {
        sum += load<Floats>(y + c);
        along += load<Floats>(f + c) * load<Floats>(y + c);
      }
      const Floats slope = load<Floats>(d.slope + droplet) * static_cast<float>(0.25 / PI);
      const Floats of_all = slope * along + load<Floats>(d.bend + droplet) * sum,
                   of_each = slope * sum;
      const float *green = d.green + d.first_green[batch] * LANES;
      for (int c = w; c < places; c += LANES) {
        const Floats of_c = load<Floats>(y + c);
        Floats own = of_each * load<Floats>(f + c) + of_all;
        for (int k = w; k < std::min(c, end_of_steps); k += LANES) {
          const Floats g = load<Floats>(green + k);
          own += g * load<Floats>(y + k);
          store_floats(result + k, load<Floats>(result + k) + g * of_c);
        }
        store_floats(result + c, own);
        green += c - w;
      }
      for (int c = w; c < places; c += LANES)
        store_floats(result + c, load<Floats>(compliance + c) * load<Floats>(y + c) +
                                     unit * load<Floats>(result + c));
    }
  }
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
