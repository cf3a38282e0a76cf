// Rings side by side against the formulas for a single one, for all numbers of contacts. Ends with an error at the
// first difference; prints how many numbers it has compared. The width of vectors is DEFORMABLE_LANES.

#define DEFORMABLE_LEVEL level

#include "kernels/curve_lanes.h"
#include "kernels/pair_lanes.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
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

// Line tensions of the rings: none, of some, or droplets without any stiffness.
enum class Tensions { NONE, SOME, DROPLETS };

struct Batch {
  static constexpr double LENGTH = 2.0, SCALE = 0.25;
  int n;
  std::vector<double> force, angle, nx, ny, bend;    // of pairs: the last one is empty
  std::vector<int> pair_side;
  std::vector<double> radius, kA, kP, tension, skin, ring[5], indentation, slope, free_radius,
      bulk_and_swell, change, answer;
  std::vector<int> partner;
  std::vector<float> response[3], compliance, share, green, own, turn, per_lengths, normal[2], rate,
      across;
  std::vector<float> weight, left, direction, step, product, last_product;    // of corrections
  std::vector<double> memory;
  double *scratch;
  bool is_tense;

  Batch(int n, bool soft, Tensions tensions, std::mt19937 &random)
      : n(n),
        scratch(nullptr),
        is_tense(tensions != Tensions::NONE)
  {
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const int pairs = n * LANES;
    for (int k = 0; k < pairs; ++k) {
      const double theta = PI * (2.0 * uniform(random) - 1.0);
      force.push_back(uniform(random) < 0.2 ? 0.0 : 1e-4 * uniform(random));
      angle.push_back(theta);
      nx.push_back(std::cos(theta));
      ny.push_back(std::sin(theta));
      bend.push_back(LARGEST_BEND * (2.0 * uniform(random) - 1.0));
      pair_side.push_back(2 * k + (uniform(random) < 0.5));
    }
    for (std::vector<double> *v : {&force, &angle, &nx, &ny, &bend}) v->push_back(0.0);
    for (int m = n / 2; m < n; ++m)
      pair_side[m * LANES] = 2 * pairs;    // fewer contacts in the first lane
    for (int w = 0; w < LANES; ++w) {
      radius.push_back(0.5 + uniform(random));
      kA.push_back(std::pow(10.0, 2.0 * uniform(random) - 1.0));
      const bool finite = soft && w % 2 == 0;
      kP.push_back(finite ? std::pow(10.0, 4.0 * uniform(random) - 2.0)
                          : std::numeric_limits<double>::infinity());
      tension.push_back(0.0);
      skin.push_back(0.1 * uniform(random));
      if (tensions == Tensions::NONE || (tensions == Tensions::SOME && w % 4 != 0)) continue;
      tension[w] = 0.01 * (0.5 + uniform(random));
      if (tensions == Tensions::SOME && w > 0) continue;
      kA[w] = std::numeric_limits<double>::infinity();
      kP[w] = 0.0;
    }
    for (std::vector<double> &v : ring) v.assign(LANES, 0.0);
    for (std::vector<float> &v : response) v.assign(LANES, 0.0F);
    for (std::vector<double> *v : {&indentation, &slope}) v->assign(pairs, 0.0);
    for (std::vector<double> *v : {&free_radius, &bulk_and_swell, &change}) v->assign(LANES, 0.0);
    per_lengths.assign(LANES, 0.0F);
    answer.assign(pairs + 1, 0.0);
    for (std::vector<float> *v : {&own, &normal[0], &normal[1], &rate, &across})
      v->assign(pairs, 0.0F);
    for (std::vector<float> *v : {&compliance, &share, &step, &product}) v->assign(pairs, 0.0F);
    for (int c = 0; c < pairs; ++c) {
      const bool is_empty = pair_side[c] == 2 * pairs;
      weight.push_back(is_empty ? 0.0F : static_cast<float>(uniform(random)));
      left.push_back(static_cast<float>(uniform(random) - 0.5));
      direction.push_back(is_empty ? 0.0F : static_cast<float>(uniform(random) - 0.5));
      last_product.push_back(is_empty ? 0.0F : static_cast<float>(uniform(random) - 0.5));
      partner.push_back(is_empty ? c : pairs - 1 - c);
    }
    green.assign(pairs * n, 0.0F);
    turn = green;
    memory.assign(7 * pairs + 2 * LANES, 0.0);
    const auto address = reinterpret_cast<std::size_t>(memory.data());
    scratch = memory.data() + (64 - address % 64) % 64 / sizeof(double);
  }

  ContactArrays contacts(int w, bool curved)
  {
    ContactArrays c = {};
    c.pair_side = pair_side.data();
    c.indentation = indentation.data();
    c.compliance = compliance.data();
    c.slope = slope.data();
    c.share = share.data();
    c.green = green.data();
    if (curved) c.own = own.data();
    c.scratch = scratch;
    return contacts_of(c, w, w);
  }
  OutlineArrays outline(int w)
  {
    OutlineArrays o = {};
    o.free_radius = free_radius.data() + w;
    o.bulk_and_swell = bulk_and_swell.data() + w;
    o.per_lengths = per_lengths.data() + w;
    o.change = change.data() + w;
    o.nx = normal[0].data() + w;
    o.ny = normal[1].data() + w;
    o.rate = rate.data() + w;
    o.across = across.data() + w;
    o.turn = turn.data() + w;
    o.length = LENGTH;
    return o;
  }
  CorrectionArrays corrections(int w)
  {
    CorrectionArrays x = {};
    x.partner = partner.data();
    x.weight = weight.data();
    x.left = left.data();
    x.direction = direction.data();
    x.step = step.data();
    x.product = product.data();
    x.last_product = last_product.data();
    return corrections_of(x, w);
  }
  RingArrays rings(int w)
  {
    RingArrays r = {};
    r.radius = radius.data();
    r.stiffness.kA = kA.data();
    r.stiffness.kP = kP.data();
    if (is_tense) r.stiffness.tension = tension.data();
    r.pressure = ring[0].data();
    r.expansion = ring[1].data();
    r.work = ring[2].data();
    r.total = ring[3].data();
    r.per_pressure = ring[4].data();
    r.mixed = response[0].data();
    r.square = response[1].data();
    r.rate = response[2].data();
    r.skin = skin.data();
    r.scale = SCALE;
    return rings_of(r, w);
  }
  PairDirections pairs(bool curved) const
  {
    PairDirections p = {};
    p.force = force.data();
    p.angle = angle.data();
    p.nx = nx.data();
    p.ny = ny.data();
    if (curved) p.bend = bend.data();
    return p;
  }
};

template <int SIZE, bool SOFT>
void check(int n, std::mt19937 &random, Tensions tensions, bool curved)
{
  Batch b(n, SOFT, tensions, random);
  const PairDirections pairs = b.pairs(curved);
  // a second time with pressures to start from
  for (const double factor : {1.0, 1.03}) {
    for (double &f : b.force) f *= factor;
    for (int w = 0; w < LANES; w += W) {
      const ContactArrays contacts = b.contacts(w, curved);
      const bool exist =
          curved ? shape_lanes<SIZE, SOFT, true>(pairs, n, contacts, b.rings(w), b.outline(w))
                 : shape_lanes<SIZE, SOFT>(pairs, n, contacts, b.rings(w));
      if (!exist) std::exit(2);
    }
  }
  // a step along the last direction, and in one with the next product
  const std::vector<float> before = b.direction, left = b.left;
  TurnBy by = {0.5F, 0.25F, b.last_product.data()};
  by.per_scale = 1.0 / b.rings(0).scale;
  Sum none, curvature;
  for (int w = 0; w < LANES; w += FLOATS)
    multiply_lanes<SIZE, SOFT, Turn::ADVANCE>(by, n, b.contacts(w, curved), b.corrections(w),
                                              b.rings(w), none, w);
  const std::vector<float> product = b.product, direction = b.direction;
  for (int c = 0; c < n * LANES; ++c) {
    const float both = b.last_product[c] + b.last_product[b.partner[c]];
    require_equal(b.left[c], left[c] - 0.25F * both, 1.0, "residual", n, 1e-7);
    require_equal(b.step[c], 0.25F * before[c], 1.0, "step", n, 1e-7);
  }
  b.direction = before;
  for (int w = 0; w < LANES; w += FLOATS)
    multiply_lanes<SIZE, SOFT, Turn::ANOTHER>(by, n, b.contacts(w, curved), b.corrections(w),
                                              b.rings(w), curvature, w);
  if (b.product != product || b.direction != direction) std::exit(4);
  double curvatures = 0.0, size = 0.0;
  for (int place = 0; place < n * LANES; ++place) {
    const double product = static_cast<double>(b.direction[place]) * b.product[place];
    curvatures += product;
    size += std::fabs(product);
  }
  require_equal(curvature.total(), curvatures, size, "curvature", n);
  for (int w = 0; w < LANES && !curved; w += W)
    slope_lanes<SIZE>(pairs, n, b.contacts(w, curved), b.rings(w));
  for (const bool slopes : {false, true}) {
    for (int w = 0; w < LANES; ++w) {
      std::vector<double> f(n), x(n), t(n), gf(n, 0.0), gx(n, 0.0), slope(n, 0.0);
      RingLoad load = {0.0, 0.0};
      double caps = 0.0, net_x = 0.0, net_y = 0.0;
      std::vector<double> u(n, 0.0);
      for (int m = 0; m < n; ++m) {
        const int pair_side = b.pair_side[m * LANES + w], k = pair_side >> 1;
        f[m] = b.force[k];
        const int place = m * LANES + w;
        x[m] = 4.0 * b.direction[place];
        require_equal(b.direction[place], b.weight[place] * b.left[place] + 0.5F * before[place],
                      1.0, "direction", n, 1e-7);
        t[m] = b.angle[k] + (pair_side & 1 ? PI : 0.0);
        load.total += f[m];
        net_x += f[m] * std::cos(t[m]);
        net_y += f[m] * std::sin(t[m]);
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
      if (curved) {
        double excess = 0.0, cap = 0.0;
        for (int m = 0; m < n; ++m) {
          const int pair_side = b.pair_side[m * LANES + w];
          u[m] = (pair_side & 1 ? -1.0 : 1.0) * b.bend[pair_side >> 1];
          const double beta = 2.0 * std::atan(u[m]), sine = std::sin(beta);
          if (beta == 0.0) continue;
          excess += f[m] * (beta / sine - 1.0);
          cap += f[m] * f[m] * (beta - sine * std::cos(beta)) / (4.0 * sine * sine);
        }
        const double plain = load.total;
        load.total += excess;
        load.work += (load.total * load.total - plain * plain) / (4.0 * PI) - cap;
        caps = 0.5 * std::min(cap, load.work);
        for (int m = 0; m < n; ++m) gf[m] += excess / (2.0 * PI) - 0.5 * u[m] * f[m];
      }
      const Stiffness stiffness = {b.kA[w], b.kP[w], b.tension[w]};
      LoadedRing ring;
      if (!find_pressure(b.radius[w], stiffness, load, ring)) std::exit(3);
      // at fixed curvature, for curved lines (contact_curve.h)
      RingCompliance c = compliance_of(b.radius[w], stiffness, load.work - caps, ring);
      if (!SOFT) c.square *= 3.0 / (3.0 - 2.0 * caps * b.kA[w] / std::pow(ring.pressure, 3));
      std::vector<double> at(n), own(n);
      for (int m = 0; m < n; ++m) {
        const double v = std::clamp(u[m], -0.1, 0.1), cube = v * v * v;
        at[m] = (gf[m] - f[m] * (0.5 * v + cube)) * c.per_pressure;
        own[m] = -v - cube;
      }
      double along = 0.0, sum = 0.0, largest = 0.0;
      for (int m = 0; m < n; ++m) {
        along += at[m] * x[m];
        sum += x[m];
        largest = std::max(largest, std::fabs(gf[m]) * c.per_pressure);
      }
      for (int m = 0; m < n; ++m) {
        const int place = m * LANES + w;
        const double a = gf[m] * c.per_pressure;
        if (b.pair_side[place] >> 1 == n * LANES) continue;    // empty
        if (slopes) {
          require_equal(b.slope[place], slope[m] * c.per_pressure, n * largest, "slope", n);
          if (!curved) continue;
          require_equal(
              b.rate[place],
              slope_rate(load.total * c.per_pressure,
                         (net_x * std::cos(t[m]) + net_y * std::sin(t[m])) * c.per_pressure, a,
                         f[m] * c.per_pressure) /
                  Batch::LENGTH,
              n * largest, "rate of the slope", n, 1e-7);
          const double q =
              b.radius[w] + b.skin[w] + ring.expansion - load.total * c.per_pressure / (2.0 * PI);
          require_equal(b.free_radius[w], q, b.radius[w] + n * largest, "free radius", n);
          continue;
        }
        require_equal(b.indentation[place], a - ring.expansion, largest, "indentation", n);
        if (ring.pressure == 0.0) continue;
        const double scale = n * (c.per_pressure + c.rate +
                                  largest * (2.0 * c.mixed + largest * std::fabs(c.square)));
        require_equal(0.25 * b.compliance[place], c.diagonal(at[m]) + own[m] * c.per_pressure,
                      scale, "compliance", n, 1e-7);
        const double product = c.per_pressure * (gx[m] + own[m] * x[m]) -
                               c.mixed * (at[m] * sum + along) - c.square * at[m] * along +
                               c.rate * sum;
        // in single precision
        require_equal(b.product[place], product, scale, "product", n, 3e-7);
      }
      require_equal(b.ring[0][w], ring.pressure, ring.pressure, "pressure", n);
    }
  }
}

// A ring whose lines answer, against numbers of an independent code; and what forces do to slopes is what tilts do to indentations.
struct Known {
  double kA, kP, tension, force[3];
  double pressure, indentation[3], slope[3];
  double C[3][2];       // C_11, C_12, C_13 and C_21, C_22, C_23
  double N_12, N_21;    // da_1/dtheta_2/f_2, da_2/dtheta_1/f_1
  double M_11, M_12, M_21;
};

template <bool SOFT> void check_answers(const Known &known)
{
  const double angle[] = {0.0, 2.0, 4.1}, curvature[] = {0.3, -0.2, 0.1};
  std::mt19937 random(1);
  Batch b(3, SOFT, SOFT ? Tensions::DROPLETS : Tensions::NONE, random);
  for (int w = 0; w < LANES; ++w) {
    b.radius[w] = 0.5;
    b.kA[w] = known.kA;
    b.kP[w] = known.kP;
    b.tension[w] = known.tension;
    b.skin[w] = 0.0;
    for (int m = 0; m < 3; ++m) {
      const int k = b.pair_side[m * LANES + w] = 2 * (m * LANES + w);
      b.force[k / 2] = known.force[m];
      b.angle[k / 2] = std::remainder(angle[m], 2.0 * PI);
      b.nx[k / 2] = std::cos(angle[m]);
      b.ny[k / 2] = std::sin(angle[m]);
      b.bend[k / 2] = 0.0;
    }
  }
  const PairDirections pairs = b.pairs(true);
  double chord[3];
  // sin(beta)/s is the curvature
  for (int turn = 0; turn < 30; ++turn) {
    for (int w = 0; w < LANES; w += W)
      if (!shape_lanes<3, SOFT, true>(pairs, 3, b.contacts(w, true), b.rings(w), b.outline(w)))
        std::exit(6);
    for (int m = 0; m < 3; ++m) {
      const double half = 0.5 * known.force[m] / b.ring[0][0];
      chord[m] = half / (1.0 - curvature[m] * b.free_radius[0]);
      const double sine = curvature[m] * chord[m];
      for (int w = 0; w < LANES; ++w)
        b.bend[m * LANES + w] = sine / (1.0 + std::sqrt(1.0 - sine * sine));
    }
  }
  const double unit = Batch::LENGTH / Batch::SCALE;
  require_equal(b.ring[0][0], known.pressure, known.pressure, "pressure", 3, 1e-9);
  for (int m = 0; m < 3; ++m) {
    require_equal(b.indentation[m * LANES], known.indentation[m], 1.0, "indentation", 3, 1e-6);
    require_equal(b.slope[m * LANES], known.slope[m], 1.0, "slope", 3, 1e-6);
  }
  // a unit force at contact m, or a unit of f dtau, or of the area over (2/3) s^3
  const auto act = [&](int m, double force, double pull, double flow) {
    for (int k = 0; k < 3 * LANES; ++k) {
      const bool is_it = k / LANES == m;
      b.step[k] = is_it ? static_cast<float>(force / unit) : 0.0F;
      const float two[] = {is_it ? static_cast<float>(pull / unit) : 0.0F,
                           is_it ? static_cast<float>(flow / (Batch::LENGTH * Batch::LENGTH))
                                 : 0.0F};
      std::memcpy(&b.answer[k], two, sizeof two);
    }
    for (int w = 0; w < LANES; w += FLOATS) {
      const CorrectionArrays g = b.corrections(w);
      follow_lanes<3, SOFT>(b.answer.data(), nullptr, 3, b.contacts(w, true), g, b.rings(w),
                            b.outline(w));
      respond_lanes<3, SOFT>(b.answer.data(), false, 3, b.contacts(w, true), g, b.rings(w),
                             b.outline(w));
    }
  };
  const auto product = [&](int m) { return Batch::LENGTH * b.product[m * LANES]; };
  const auto across = [&](int m) { return Batch::LENGTH * b.across[m * LANES]; };
  const double size = std::fabs(known.C[0][0]), small = 1e-4;
  for (const int m : {0, 1}) {
    act(m, 1.0, 0.0, 0.0);
    for (const int c : {0, 1, 2})
      if (known.C[c][m] != 0.0) require_equal(product(c), known.C[c][m], size, "C", 3, 1e-3);
    const double slope = across(1 - m);
    require_equal(slope, m == 0 ? known.N_12 : known.N_21, size, "slope by force", 3, small);
  }
  act(1, 0.0, 1.0, 0.0);
  require_equal(product(0), known.N_12, size, "indentation by tilt", 3, small);
  act(0, 0.0, 1.0, 0.0);
  require_equal(product(1), known.N_21, size, "indentation by tilt", 3, small);
  const double volume[] = {2.0 / 3.0 * std::pow(chord[0], 3), 2.0 / 3.0 * std::pow(chord[1], 3)};
  act(0, 0.0, 0.0, volume[0]);
  require_equal(product(0), known.M_11, known.M_11, "M_11", 3, 0.2);
  require_equal(product(1), known.M_21, known.M_21, "M_21", 3, 0.2);
  act(1, 0.0, 0.0, volume[1]);
  require_equal(product(0), known.M_12, known.M_12, "M_12", 3, 0.2);
}

template <bool SOFT> void check_sizes(std::mt19937 &random)
{
  for (int repeat = 0; repeat < 20; ++repeat) {
    for (const Tensions tensions : {Tensions::NONE, Tensions::SOME, Tensions::DROPLETS})
      for (const bool curved : {false, true}) {
        if (!SOFT && tensions != Tensions::NONE) continue;
        for (const int n : {1, 2, 3, 9, 30}) check<0, SOFT>(n, random, tensions, curved);
        check<3, SOFT>(3, random, tensions, curved);
        check<5, SOFT>(5, random, tensions, curved);
        check<8, SOFT>(8, random, tensions, curved);
      }
  }
}

// The forces of the last four calls, the last one first, predict this one.
void check_prediction(const double (&f)[4], Extrapolation by, double expected)
{
  const int pairs = LANES + 3;    // vectors, and a rest
  const double unit = 0.25;
  std::vector<double> force(pairs), past(pairs, f[0]);
  std::vector<float> earlier[3];
  for (int n = 0; n < 3; ++n)
    earlier[n].assign(pairs, static_cast<float>((f[n + 1] - f[n]) / unit));
  const PastArrays p = {past.data(), {earlier[0].data(), earlier[1].data(), earlier[2].data()}};
  const std::vector<float> first = earlier[0], second = earlier[1];
  by.smooth /= unit;
  by.unit = unit;
  extrapolate(p, by, nullptr, force.data(), 0, pairs);
  for (const double found : force) require_equal(found, expected, 1.0, "prediction", pairs, 1e-15);
  if (earlier[1] != first || earlier[2] != second) std::exit(5);
}

// Numbers that single precision has exactly.
void check_predictions()
{
  const Extrapolation last = {0, 0, 0, 0, 1, 0}, line = {1, 0, 0, 0, 1, 0},
                      quadratic = {1, 1, 0, 100.0, 1, 0}, stable = {1, 0.5, 0, 100.0, 1, 0},
                      cubic = {1, 1, 1, 0, 1, 0}, no_kinks = {1, 1, 1, 100.0, 1, 0};
  const double parabola[] = {9.0, 4.0, 1.0, 0.0},
               cube[] = {32.0 + 27.0, 32.0 + 8.0, 32.0 + 1.0, 32.0}, kink[] = {1.5, 1.0, 1.0, 1.0},
               falling[] = {1.0, 3.0, 5.0, 7.0};
  check_prediction(parabola, last, 9.0);
  check_prediction(parabola, line, 14.0);
  check_prediction(parabola, stable, 15.0);
  for (const Extrapolation &by : {quadratic, cubic, no_kinks}) check_prediction(parabola, by, 16.0);
  check_prediction(cube, no_kinks, 32.0 + 64.0);
  // third differences of 6 beside a second one of 12, and one as large as the second one
  check_prediction(cube, cubic, 32.0 + 64.0);
  check_prediction(kink, cubic, 2.0);
  check_prediction(kink, no_kinks, 3.0);
  for (const Extrapolation &by : {line, quadratic, cubic, no_kinks})
    check_prediction(falling, by, 0.0);
}

}    // namespace

int main()
{
  std::mt19937 random(1);
  check_predictions();
  check_sizes<false>(random);
  check_sizes<true>(random);
  const double infinite = std::numeric_limits<double>::infinity();
  check_answers<false>({1.0,
                        infinite,
                        0.0,
                        {1e-3, 1.2e-3, 0.9e-3},
                        0.00671986202269,
                        {0.0260556, 0.034311, 0.0257397},
                        {-0.0059593, 0.0016109, 0.0044736},
                        {{28.96839, -12.33055}, {-12.33055, 27.67239}, {-6.42767, 0.0}},
                        21.72052,
                        -20.47568,
                        4.576e-4,
                        4.979e-4,
                        6.33e-4});
  check_answers<true>({infinite,
                       0.0,
                       1.0,
                       {0.5, 0.6, 0.45},
                       2.4740055491,
                       {0.0310147, 0.0430394, 0.0309228},
                       {-0.0080933, 0.0021877, 0.0060755},
                       {{0.0822606, -0.0249428}, {-0.0249428, 0.0901323}, {-0.012044, 0.0}},
                       0.0595445,
                       -0.0588607,
                       2.983e-4,
                       2.824e-4,
                       2.944e-4});
  std::printf("%d\n", compared);
}
