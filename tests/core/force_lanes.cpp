// Rings side by side against the formulas for a single one, for all numbers of contacts. Ends with an error at the
// first difference; prints how many numbers it has compared. The width of vectors is DEFORMABLE_LANES.

#define DEFORMABLE_LEVEL level

#include "force_lanes.h"

#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

using namespace deformable;
using namespace deformable::level;

namespace {

int compared = 0;

void require_equal(double found, double expected, double scale, const char *what, int contacts,
                   double tolerance = 1e-12)
{
  ++compared;
  if (std::fabs(found - expected) <= tolerance * scale) return;
  std::fprintf(stderr, "%s of %d contacts: %.17g, not %.17g\n", what, contacts, found, expected);
  std::exit(1);
}

struct Batch {
  int n;
  std::vector<double> force, angle, nx, ny;    // of pairs: the last one is empty
  std::vector<float> x;
  std::vector<int> seat;
  std::vector<double> radius, kA, kP, ring[8], indentation, compliance, slope, rate;
  std::vector<float> green, product;
  std::vector<double> memory;
  double *scratch;

  Batch(int n, bool soft, std::mt19937 &random) : n(n), scratch(nullptr)
  {
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const int pairs = n * LANES;
    for (int k = 0; k < pairs; ++k) {
      const double theta = PI * (2.0 * uniform(random) - 1.0);
      force.push_back(uniform(random) < 0.2 ? 0.0 : 1e-4 * uniform(random));
      angle.push_back(theta);
      nx.push_back(std::cos(theta));
      ny.push_back(std::sin(theta));
      x.push_back(static_cast<float>(uniform(random) - 0.5));
      seat.push_back(2 * k + (uniform(random) < 0.5));
    }
    for (std::vector<double> *v : {&force, &angle, &nx, &ny}) v->push_back(0.0);
    x.push_back(0.0F);
    for (int m = n / 2; m < n; ++m)
      seat[m * LANES] = 2 * pairs;    // fewer contacts in the first lane
    for (int w = 0; w < LANES; ++w) {
      radius.push_back(0.5 + uniform(random));
      kA.push_back(std::pow(10.0, 2.0 * uniform(random) - 1.0));
      const bool finite = soft && w % 2 == 0;
      kP.push_back(finite ? std::pow(10.0, 4.0 * uniform(random) - 2.0)
                          : std::numeric_limits<double>::infinity());
    }
    for (std::vector<double> &v : ring) v.assign(LANES, 0.0);
    for (std::vector<double> *v : {&indentation, &compliance, &slope, &rate}) v->assign(pairs, 0.0);
    product.assign(pairs, 0.0F);
    green.assign(pairs * n, 0.0F);
    memory.assign(5 * pairs + 2 * LANES, 0.0);
    const auto address = reinterpret_cast<std::size_t>(memory.data());
    scratch = memory.data() + (64 - address % 64) % 64 / sizeof(double);
  }

  ContactArrays contacts(int w)
  {
    return contacts_of({seat.data(), indentation.data(), compliance.data(), slope.data(),
                        product.data(), green.data(), scratch},
                       w, w);
  }
  RingArrays rings(int w)
  {
    return rings_of({radius.data(), kA.data(), kP.data(), ring[0].data(), ring[1].data(),
                     ring[2].data(), ring[3].data(), ring[4].data(), ring[5].data(), ring[6].data(),
                     ring[7].data()},
                    w);
  }
};

template <int SIZE, bool SOFT> void check(int n, std::mt19937 &random)
{
  Batch b(n, SOFT, random);
  const PairDirections pairs = {b.force.data(), b.angle.data(), b.nx.data(), b.ny.data()};
  // a second time with pressures to start from
  for (const double factor : {1.0, 1.03}) {
    for (double &f : b.force) f *= factor;
    for (int w = 0; w < LANES; w += W)
      if (!shape_lanes<SIZE, SOFT>(pairs, n, b.contacts(w), b.rings(w))) std::exit(2);
  }
  for (const bool slopes : {false, true}) {
    for (int w = 0; w < LANES; w += W)
      if (slopes)
        slope_lanes<SIZE>(pairs, n, b.contacts(w), b.rings(w), &b.rate[w]);
      else
        multiply_lanes<SIZE, SOFT>(b.x.data(), 0.25, n, b.contacts(w), b.rings(w));
    for (int w = 0; w < LANES; ++w) {
      std::vector<double> f(n), x(n), t(n), gf(n, 0.0), gx(n, 0.0), slope(n, 0.0);
      RingLoad load = {0.0, 0.0};
      for (int m = 0; m < n; ++m) {
        const int seat = b.seat[m * LANES + w], k = seat >> 1;
        f[m] = b.force[k];
        x[m] = 4.0 * b.x[k];
        t[m] = b.angle[k] + (seat & 1 ? PI : 0.0);
        load.total += f[m];
      }
      for (int m = 0; m < n; ++m) {
        for (int k = 0; k < n; ++k) {
          const double d = std::remainder(t[m] - t[k], 2.0 * PI), size = std::fabs(d);
          const double g = green(size, std::sin(size), std::cos(size));
          gf[m] += g * f[k];
          gx[m] += g * x[k];
          if (m != k)
            slope[m] +=
                std::copysign(1.0, d) * d_green(size, std::sin(size), std::cos(size)) * f[k];
        }
        load.work += 0.5 * f[m] * gf[m];
      }
      const Stiffness stiffness = {b.kA[w], b.kP[w]};
      LoadedRing ring;
      if (!find_pressure(b.radius[w], stiffness, load, ring)) std::exit(3);
      const RingCompliance c = compliance_of(b.radius[w], stiffness, load.work, ring);
      double along = 0.0, sum = 0.0, largest = 0.0;
      for (int m = 0; m < n; ++m) {
        along += gf[m] * c.per_pressure * x[m];
        sum += x[m];
        largest = std::max(largest, std::fabs(gf[m]) * c.per_pressure);
      }
      for (int m = 0; m < n; ++m) {
        const int place = m * LANES + w;
        const double a = gf[m] * c.per_pressure;
        if (b.seat[place] >> 1 == n * LANES) continue;    // empty
        if (slopes) {
          require_equal(b.slope[place], slope[m] * c.per_pressure, n * largest, "slope", n);
          require_equal(b.rate[place],
                        slope_rate(load.total * c.per_pressure, 0.0, a, f[m] * c.per_pressure),
                        n * largest, "rate of the slope", n);
          continue;
        }
        require_equal(b.indentation[place], a - ring.expansion, largest, "indentation", n);
        if (ring.pressure == 0.0) continue;
        const double scale = n * (c.per_pressure + c.rate +
                                  largest * (2.0 * c.mixed + largest * std::fabs(c.square)));
        require_equal(b.compliance[place], c.diagonal(a), scale, "compliance", n);
        const double product = c.per_pressure * gx[m] - c.mixed * (a * sum + along) -
                               c.square * a * along + c.rate * sum;
        // in single precision
        require_equal(b.product[place], product, scale, "product", n, 3e-7);
      }
      require_equal(b.ring[0][w], ring.pressure, ring.pressure, "pressure", n);
    }
  }
}

template <bool SOFT> void check_sizes(std::mt19937 &random)
{
  for (int repeat = 0; repeat < 20; ++repeat) {
    for (const int n : {1, 2, 3, 9, 30}) check<0, SOFT>(n, random);
    check<3, SOFT>(3, random);
    check<5, SOFT>(5, random);
    check<8, SOFT>(8, random);
  }
}

}    // namespace

int main()
{
  std::mt19937 random(1);
  check_sizes<false>(random);
  check_sizes<true>(random);
  std::printf("%d\n", compared);
}
