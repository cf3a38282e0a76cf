// Droplets with given forces, side by side: the formulas of droplet.h in vectors. Compiled for each level of
// SIMD instructions, see cmake/sources.cmake.

#include "kernels/force_kernels.h"
#include "kernels/lanes.h"
#include "laws/droplet.h"

#include <algorithm>

namespace deformable::DEFORMABLE_LEVEL {

// The logarithm of vectors of doubles, the same on every level of SIMD instructions.
struct Logarithm {
  Lanes value, over;    // ln x, 1/x
};

// artanh(t)/t by powers of t^2: interpolated at Chebyshev's points of t^2 < 0.0295, with an error below 2e-18.
constexpr int TERMS = 8;
constexpr double ARTANH[TERMS] = {1.0,
                                  0.33333333333333826,
                                  0.1999999999965117,
                                  0.1428571438032084,
                                  0.11111098528362971,
                                  0.09091815840117472,
                                  0.07656264074106932,
                                  0.07404855181113693};

// For positive, finite x that are not denormal. x = 2^e a, sqrt(1/2) <= a < sqrt(2):
//   ln a = 2 artanh t,   t = (a - 1)/(a + 1)
DEFORMABLE_LANE_FUNCTION Logarithm logarithm(Lanes x)
{
  typedef unsigned long long Bits __attribute__((vector_size(8 * W)));
  constexpr unsigned long long ONE = 0x3ff0000000000000ULL, FRACTION = 0x000fffffffffffffULL,
                               TO_52 = 0x4330000000000000ULL;    // 2^52
  constexpr double BIAS = 4503599627370496.0 + 1023.0, LN_2 = 0.69314718055994530942;
  const Bits bits = (Bits)x;
  // the exponent as the low bits of a number of the size of 2^52: conversions of integers are slow on older processors
  Lanes exponent = (Lanes)((bits >> 52) | TO_52) - BIAS;
  Lanes a = (Lanes)((bits & FRACTION) | ONE);
  const Mask high = a > 1.41421356237309504880;
  a = select(high, 0.5 * a, a);
  exponent = select(high, exponent + 1.0, exponent);
  const Lanes sum = a + 1.0, quotient = 1.0 / (x * sum);    // one division for both
  const Lanes t = (a - 1.0) * (x * quotient), t2 = t * t;
  Lanes series = all(ARTANH[TERMS - 1]);
  for (int n = TERMS - 2; n >= 0; --n) series = series * t2 + ARTANH[n];
  return {exponent * LN_2 + 2.0 * t * series, sum * quotient};
}

// Indentations, work and compliances from the forces of the contacts and their responses.
DEFORMABLE_LANE_FUNCTION void finish_droplets(const RingBatches &b, const DropletArrays &d,
                                              int batch)
{
  const int begin = b.first[batch], end = b.first[batch + 1];
  const RingArrays &r = b.rings;
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
    const Lanes radius = load<Lanes>(r.radius + droplet),
                tension = load<Lanes>(d.tension + droplet), of_all = of.squares * of.slope,
                per_tension = load<Lanes>(r.per_pressure + droplet);
    const Lanes slope = of.slope * (0.25 / PI), bend = of.squares * of.bend;
    const Lanes least =
        select(sum > NO_FORCE, LEAST_OF_MEAN * of.facet * (8.0 * PI), all(LEAST_ALONE));
    const Lanes l_at_least = LOG_8_PI - logarithm(least).value;
    for (int c = begin + w; c < end; c += LANES) {
      const Lanes f = load<Lanes>(d.force + c), response = load<Lanes>(d.response + c);
      const Lanes l = LOG_8_PI - logarithm(larger(f, all(NO_FORCE))).value;
      const Lanes l_of_compliance = select(f > NO_FORCE, l, l_at_least);
      const Lanes own = own_compliance(l_of_compliance, of.logarithm);
      work += own_work(f, l, of.logarithm) + 0.5 * f * response;
      store(b.contacts.indentation + c,
            radius * (own_indentation(f, l, of.logarithm) + (response + of_all)));
      store(b.contacts.compliance + c,
            (own + 2.0 * slope * f + bend) * per_tension * (1.0 / r.scale));
      store(b.contacts.own + c, own);
      store(b.contacts.share + c, f);
    }
    store(d.load + droplet, of.x);
    store(d.facet + droplet, of.facet);
    store(r.total + droplet, sum * radius * tension);
    store(r.work + droplet, tension * radius * radius * work);
    store(r.mixed + droplet, -slope);
    store(r.rate + droplet, bend);
  }
}

static void shape_droplets(RingBatches b, DropletArrays d, PairForces p)
{
  for (int batch = b.begin; batch < b.end; ++batch) {
    const int first = b.first[batch], places = b.first[batch + 1] - first;
    const int *const pair_side = b.contacts.pair_side + first;
    double *const nx = d.nx + first, *const ny = d.ny + first, *const nz = d.nz + first,
                  *const f = d.force + first, *const response = d.response + first,
                  *const tx = d.tx + first, *const ty = d.ty + first, *const tz = d.tz + first;
    double unit[LANES];
    for (int w = 0; w < LANES; ++w)
      unit[w] = 1.0 / (b.rings.radius[batch * LANES + w] * d.tension[batch * LANES + w]);
    for (int c = 0; c < places; ++c) {
      const int k = pair_side[c] >> 1;
      const double sign = pair_side[c] & 1 ? -1.0 : 1.0;
      f[c] = unit[c % LANES] * p.force[k];
      nx[c] = sign * p.nx[k];
      ny[c] = sign * p.ny[k];
      nz[c] = sign * p.nz[k];
    }
    for (int w = 0; w < LANES; w += W) {
      float *green = b.contacts.green + b.first_green[batch],
            *d_green = d.d_green + b.first_green[batch];
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
    finish_droplets(b, d, batch);
  }
}

DEFORMABLE_LANE_FUNCTION void add(double *to, Floats x, const double *unit)
{
  float numbers[FLOATS];
  store_floats(numbers, x);
  for (int w = 0; w < FLOATS; w += W)
    store(to + w, load<Lanes>(to + w) + load<Lanes>(unit + w) * load<Lanes>(numbers + w));
}

static void adapt_droplets(RingBatches b, DropletArrays d, PairForces p, const float *changes,
                           double unit_of_changes)
{
  for (int batch = b.begin; batch < b.end; ++batch) {
    const int first = b.first[batch], places = b.first[batch + 1] - first;
    const int *const pair_side = b.contacts.pair_side + first;
    float *const y = static_cast<float *>(b.contacts.scratch), *const nx = y + places,
                 *const ny = nx + places, *const nz = ny + places, *const sum = nz + places,
                 *const tx = sum + places, *const ty = tx + places, *const tz = ty + places;
    for (int c = 0; c < places; ++c) {
      y[c] = changes[pair_side[c] >> 1];
      nx[c] = static_cast<float>(d.nx[first + c]);
      ny[c] = static_cast<float>(d.ny[first + c]);
      nz[c] = static_cast<float>(d.nz[first + c]);
    }
    double unit[LANES], of_changes[LANES];
    for (int w = 0; w < LANES; ++w) {
      unit[w] = 1.0 / (b.rings.radius[batch * LANES + w] * d.tension[batch * LANES + w]);
      of_changes[w] = unit[w] * unit_of_changes;
    }
    for (int w = 0; w < LANES; w += FLOATS) {
      const float *green = b.contacts.green + b.first_green[batch],
                  *d_green = d.d_green + b.first_green[batch];
      for (int c = w; c < places; c += LANES) {
        const Floats of_c = load<Floats>(y + c), x = load<Floats>(nx + c),
                     yc = load<Floats>(ny + c), z = load<Floats>(nz + c);
        Floats own{}, own_x{}, own_y{}, own_z{};
        for (int k = w; k < c; k += LANES) {
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
        add(d.response + first + c, load<Floats>(sum + c), of_changes + w);
        add(d.tx + first + c, load<Floats>(tx + c), of_changes + w);
        add(d.ty + first + c, load<Floats>(ty + c), of_changes + w);
        add(d.tz + first + c, load<Floats>(tz + c), of_changes + w);
      }
    }
    for (int c = 0; c < places; ++c)
      d.force[first + c] = unit[c % LANES] * p.force[pair_side[c] >> 1];
    finish_droplets(b, d, batch);
  }
}

extern const DropletKernels droplet_kernels;

const DropletKernels droplet_kernels = {shape_droplets, adapt_droplets};

}    // namespace deformable::DEFORMABLE_LEVEL
