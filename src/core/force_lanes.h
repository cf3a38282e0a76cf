// Rings with given forces, several side by side: the formulas of ring_forces.h in vectors.
//
// A batch has LANES rings with the same number of places for contacts. An array of contacts has the first contact
// of all rings of the batch, then the second one, and so on. Forces and directions are those of pairs of rings,
// which the kernels gather. Kernels are templates of the number of lanes that a register holds and of the number of
// contacts, so that all loops unroll; 0 contacts stands for a number known at run time only.

#ifndef DEFORMABLE_FORCE_LANES_H
#define DEFORMABLE_FORCE_LANES_H

#include "ring_forces.h"

#include <cstring>
#include <utility>

namespace deformable {

#define DEFORMABLE_KERNEL inline __attribute__((always_inline))

constexpr int LANES = 8;

template <int N> struct LaneVector {
  typedef double Type __attribute__((vector_size(8 * N)));
};

template <class V> DEFORMABLE_KERNEL V load(const double *from)
{
  V v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

template <class V> DEFORMABLE_KERNEL void store(double *to, const V &v)
{
  std::memcpy(to, &v, sizeof v);
}

// Pairs as rings see them. The direction is that from the first ring of a pair; `seat` is 2 x the index of the pair,
// + 1 for the second ring.
struct PairArrays {
  const double *force, *angle, *nx, *ny;
};

// The rings of a batch: arrays of LANES numbers.
struct RingLanes {
  const double *radius, *kA, *kP;    // of the ring without skin
  double *pressure, *expansion, *work, *total;
  double *per_pressure, *mixed, *square, *rate;    // compliance, see RingCompliance
};

// The contacts of a batch, and G and G' of each two of them: the lower triangles by rows.
struct ContactLanes {
  int contacts;
  const int *seat;
  double *indentation, *compliance;    // a and da_c/df_c
  double *green, *d_green;
  double *scratch;    // for 3 numbers a contact, where their number is not known to the compiler
};

// Written out, because compilers turn a loop into instructions that gather, which are slow.
template <class V, int... LANE>
DEFORMABLE_KERNEL V gather(const double *x, const int *seat, std::integer_sequence<int, LANE...>)
{
  return V{x[seat[LANE] >> 1]...};
}

template <class V> DEFORMABLE_KERNEL V gather(const double *x, const int *seat)
{
  return gather<V>(x, seat, std::make_integer_sequence<int, sizeof(V) / 8>());
}

// p^3 = kA Q, from the last pressure where that is close: two steps of Halley's method, each of which triples the
// digits.
template <class V> DEFORMABLE_KERNEL V cube_root(V cube, V guess)
{
  constexpr int N = sizeof(V) / 8;
  constexpr double CLOSE = 0.05, NOTHING = 1e-280;
  const V zero = {};
  const V guessed = guess * guess * guess;
  V off = cube - guessed;
  off = off < zero ? -off : off;
  const V allowed = CLOSE * guessed;
  bool close = true;
#pragma GCC unroll 8
  for (int w = 0; w < N; ++w) close &= off[w] <= allowed[w];
  if (!close)
    for (int w = 0; w < N; ++w)
      if (!(off[w] <= allowed[w])) guess[w] = std::cbrt(cube[w]);
  for (int step = 0; step < 2; ++step) {
    const V third = guess * guess * guess;
    guess *= (third + 2.0 * cube) / (2.0 * third + cube + NOTHING);
  }
  return cube > zero + NOTHING ? guess : zero;
}

// Pressure and compliance of the rings of lanes w0 on; returns false where a ring does not exist.
template <class V, bool SOFT> DEFORMABLE_KERNEL bool press(const RingLanes &r, V work, V total)
{
  constexpr int N = sizeof(V) / 8;
  const V zero = {};
  bool exist = true;
  store(r.work, work);
  store(r.total, total);
  if (SOFT) {
    for (int w = 0; w < N; ++w) {
      const Stiffness k = {r.kA[w], r.kP[w]};
      LoadedRing ring = {r.pressure[w], r.expansion[w]};
      exist &= find_pressure(r.radius[w], k, {work[w], total[w]}, ring);
      const RingCompliance c = compliance_of(r.radius[w], k, work[w], ring);
      r.pressure[w] = ring.pressure;
      r.expansion[w] = ring.expansion;
      r.per_pressure[w] = c.per_pressure;
      r.mixed[w] = c.mixed;
      r.square[w] = c.square;
      r.rate[w] = c.rate;
    }
    return exist;
  }
  const V kA = load<V>(r.kA), p = cube_root(kA * work, load<V>(r.pressure));
  const V per_p = p > zero ? 1.0 / (p > zero ? p : zero + 1.0) : zero;
  store(r.pressure, p);
  store(r.per_pressure, per_p);
  store(r.square, kA * per_p * per_p * (1.0 / 3.0));
  return exist;
}

// Shapes the rings for the forces of their pairs. NEW computes G and G' from the directions, which otherwise are
// those of the last call.
template <class V, int SIZE, bool SOFT, bool NEW>
DEFORMABLE_KERNEL bool shape_lanes(const PairArrays &pairs, const ContactLanes &c,
                                   const RingLanes &rings)
{
  constexpr int N = sizeof(V) / 8, FIXED = SIZE > 0 ? SIZE : 1;
  const int n = SIZE > 0 ? SIZE : c.contacts;
  const V zero = {}, infinity = zero + std::numeric_limits<double>::infinity();
  V forces[FIXED], products[FIXED], angles[FIXED], nxs[FIXED], nys[FIXED];
  V *force = forces, *product = products, *angle = angles, *nx = nxs, *ny = nys;
  if (SIZE == 0) {
    force = reinterpret_cast<V *>(c.scratch);
    product = force + n;
    angle = product + n;
    nx = angle + n;
    ny = nx + n;
  }
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const int *const seat = c.seat + m * LANES;
    force[m] = gather<V>(pairs.force, seat);
    product[m] = GREEN_AT_ZERO * force[m];
    double *const g = c.green + m * (m - 1) / 2 * LANES, *const dg =
                                                             c.d_green + m * (m - 1) / 2 * LANES;
    if (NEW) {
      V sign;
#pragma GCC unroll 8
      for (int w = 0; w < N; ++w) sign[w] = 1.0 - 2.0 * (seat[w] & 1);
      const V seen = gather<V>(pairs.angle, seat);
      const V opposite = seen > zero ? seen - PI : seen + PI;
      angle[m] = sign > zero ? seen : opposite;
      nx[m] = sign * gather<V>(pairs.nx, seat);
      ny[m] = sign * gather<V>(pairs.ny, seat);
    }
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      V green;
      if (NEW) {
        const V t = angle[m] - angle[k], cosine = nx[m] * nx[k] + ny[m] * ny[k];
        const V cross = nx[k] * ny[m] - ny[k] * nx[m];
        const V size = t < zero ? -t : t, sine = t < zero ? -cross : cross;
        const V rest = 0.5 * (PI - size);
        green = (0.5 + 0.25 * cosine - rest * sine) * (1.0 / PI);
        const V slope = (0.25 * sine - rest * cosine) * (1.0 / PI);
        store(g + k * LANES, green);
        store(dg + k * LANES, t < zero ? -slope : slope);
      } else {
        green = load<V>(g + k * LANES);
      }
      product[m] += green * force[k];
      product[k] += green * force[m];
    }
  }
  V work = zero, total = zero;
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    work += force[m] * product[m];
    total += force[m];
  }
  const bool exist = press<V, SOFT>(rings, 0.5 * work, total);
  const V per_p = load<V>(rings.per_pressure), square = load<V>(rings.square);
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const V b = product[m] * per_p;
    V a = b, diagonal = GREEN_AT_ZERO * per_p;
    if (SOFT) {
      a -= load<V>(rings.expansion);
      diagonal += load<V>(rings.rate) - 2.0 * load<V>(rings.mixed) * b;
    }
    diagonal -= square * b * b;
    store(c.indentation + m * LANES, a);
    store(c.compliance + m * LANES, per_p > zero ? diagonal : infinity);
  }
  return exist;
}

// C x of each ring, x by pair, the product by contact.
template <class V, int SIZE, bool SOFT>
DEFORMABLE_KERNEL void multiply_lanes(const double *x, const ContactLanes &c,
                                      const RingLanes &rings, double *to)
{
  constexpr int FIXED = SIZE > 0 ? SIZE : 1;
  const int n = SIZE > 0 ? SIZE : c.contacts;
  V xs[FIXED], products[FIXED], *own = xs, *product = products;
  if (SIZE == 0) {
    own = reinterpret_cast<V *>(c.scratch);
    product = own + n;
  }
  V along = {}, sum = {};
  const V delta = SOFT ? load<V>(rings.expansion) : V{};
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    own[m] = gather<V>(x, c.seat + m * LANES);
    product[m] = GREEN_AT_ZERO * own[m];
    const V a = load<V>(c.indentation + m * LANES);
    along += (SOFT ? a + delta : a) * own[m];
    if (SOFT) sum += own[m];
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      const V green = load<V>(c.green + (m * (m - 1) / 2 + k) * LANES);
      product[m] += green * own[k];
      product[k] += green * own[m];
    }
  }
  const V per_p = load<V>(rings.per_pressure);
  V of_b = load<V>(rings.square) * along, constant = {};
  if (SOFT) {
    const V mixed = load<V>(rings.mixed);
    of_b += mixed * sum;
    constant = load<V>(rings.rate) * sum - mixed * along;
  }
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    const V a = load<V>(c.indentation + m * LANES);
    V y = per_p * product[m] - of_b * (SOFT ? a + delta : a);
    if (SOFT) y += constant;
    store(to + m * LANES, y);
  }
}

// The slope of the outline at each contact, sum_k L_k G'(theta_c - theta_k); -f_c times that is dU/dtheta_c.
template <class V, int SIZE>
DEFORMABLE_KERNEL void slope_lanes(const double *force, const ContactLanes &c,
                                   const RingLanes &rings, double *to)
{
  constexpr int FIXED = SIZE > 0 ? SIZE : 1;
  const int n = SIZE > 0 ? SIZE : c.contacts;
  V forces[FIXED], slopes[FIXED], *own = forces, *slope = slopes;
  if (SIZE == 0) {
    own = reinterpret_cast<V *>(c.scratch);
    slope = own + n;
  }
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) {
    own[m] = gather<V>(force, c.seat + m * LANES);
    slope[m] = V{};
#pragma GCC unroll 8
    for (int k = 0; k < m; ++k) {
      const V d_green = load<V>(c.d_green + (m * (m - 1) / 2 + k) * LANES);
      slope[m] += d_green * own[k];
      slope[k] -= d_green * own[m];
    }
  }
  const V per_p = load<V>(rings.per_pressure);
#pragma GCC unroll 8
  for (int m = 0; m < n; ++m) store(to + m * LANES, per_p * slope[m]);
}

}    // namespace deformable

#endif
