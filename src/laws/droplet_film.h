// A droplet in three dimensions whose contacts may be films that stick: what they add to the work of droplet.h.
//
// The outline meets the film of contact c at the angle theta, s = sin theta, C = cos theta: C = 1 - w/(2 g) between like droplets, 1 - w/g
// at a wall, and Neumann's triangle between others. A film may bear a tension, f < 0. In units of R and g R, with the load x
// and S = sum f^2/(8 pi) of droplet.h,
//   W = W_0(f) + sum u(f_c, P) + 4 pi {1 - L^2/3 - 2/(3 L) + X [2 - 4 L/3 - 2/(3 L^2)]},   X = x - S/(8 pi)
//   P = (2/L) (1 + X/L),   L^3 = 1 - (1/V0) sum u_P,   V0 = 4 pi/3
//   a_c = dW_0/df_c + (L - 1) (f_c/(4 pi) - 1) + u_f
// W is stationary in L, the radius of the outline that goes on behind the films, and in the pressure P. W_0 has forces of both signs
// as DropletLoad says. Where the outline of a film has the slope psi it has the radius r from the axis,
//   r = (rho/2) (sin psi + sqrt(sin^2 psi + k)),   k = 2 f/(pi rho),   rho = 2/P,   u = pi int_0^theta r^2 sin psi dpsi
// and r(theta) is the radius of the film. The least force is -(pi rho/2) s^2; there r = rho s/2, and the film gives way without a bound.
//
// Between unlike droplets f_i = F/(g_i R_i), and side i has P lambda_i in place of P:
//   lambda_i = g_j (C_j + C_i R_i/R_j)/g_f,   g_f = g_i + g_j - w,   at half of the adhesion w
// Between droplets of unlike radii the film is a cap, and both sides together have the further term of CurvedFilm.

#ifndef DEFORMABLE_DROPLET_FILM_H
#define DEFORMABLE_DROPLET_FILM_H

#include "laws/droplet.h"
#include "laws/numbers.h"
#include "laws/trigonometry.h"

#include <algorithm>
#include <cmath>

namespace deformable {

// The law was judged up to the first of these angles, and compared with exact shapes up to the second one. Films may cover this part of
// a droplet.
constexpr double LARGEST_FILM_ANGLE = 0.7, MOST_FILM_ANGLE = 1.0, LARGEST_COVER = 0.5;
// A film is torn where y = q/s, the root of its force above the least one, is this: at 0.9999 of the largest pull. At y = 0 it gives
// way without a bound.
constexpr double TORN = 0.01;

// One side of the film of a pair, or of a wall: s, 1 - C and lambda. T is double, or a number with derivatives.
template <class T> struct FilmSideOf {
  T sine, rise, lean;

  double angle() const { return std::asin(sine); }
};
using FilmSide = FilmSideOf<double>;

// 1 - C of Neumann's triangle: (g_j^2 - (g_f - g_i)^2)/(2 g_f g_i)
template <class T> T film_rise(const T &tension_i, const T &tension_j, const T &adhesion)
{
  const T film = tension_i + tension_j - adhesion;
  const T rise = adhesion * (2.0 * tension_j - adhesion) / (2.0 * film * tension_i);
  return rise > 1.0 ? T(1.0) : larger(rise, T(0.0));
}

template <class T>
FilmSideOf<T> film_side(const T &radius_i, const T &tension_i, const T &radius_j,
                        const T &tension_j, const T &adhesion)
{
  const T rise = film_rise(tension_i, tension_j, adhesion), half = 0.5 * adhesion;
  const T Ci = 1.0 - film_rise(tension_i, tension_j, half),
          Cj = 1.0 - film_rise(tension_j, tension_i, half);
  return {root(rise * (2.0 - rise)), rise,
          tension_j * (Cj + Ci * radius_i / radius_j) / (tension_i + tension_j - half)};
}

template <class T> FilmSideOf<T> film_side_of_wall(const T &tension, const T &adhesion)
{
  const T part = adhesion / tension, rise = part > 1.0 ? T(1.0) : part;
  return {root(rise * (2.0 - rise)), rise, T(1.0)};
}

// 1/sqrt(1 - y) = sum b_i y^i: the first two are exact, the others to 2.8e-5 for angles up to 0.8.
constexpr int FILM_POWERS = 6;
constexpr double FILM_SERIES[FILM_POWERS] = {1.0,        0.5,         0.36038727,
                                             0.49431753, -0.46349913, 1.321883};

// |f|, but not less than NO_FORCE, and its logarithm: those of f -> 0 in W_0 and in u cancel.
template <class T> DEFORMABLE_INLINE T some_force(T f)
{
  const T least = T{} + NO_FORCE;
  return larger(magnitude(f), least);
}

// k = f P/pi, q = sqrt(s^2 + k), and int ds/q = ln[(s + q)/sqrt|k|] from 0. log_f: ln |f|, log_P: ln P, log: of a T.
template <class T> struct FilmRoot {
  T k, q, per_q, lambda;

  template <class Log>
  DEFORMABLE_INLINE FilmRoot(T f, T log_f, T P, T log_P, T sine, Log &&log)
  {
    constexpr double LOG_PI = 1.1447298858494002;
    k = (1.0 / PI) * with_sign_of(some_force(f), f) * P;
    const T square = sine * sine + k, zero = T{};
    q = root(larger(square, zero));
    per_q = 1.0 / larger(q, 1e-3 * sine + 1e-200);
    lambda = sine > 0.0 ? log(sine + q) - 0.5 * (log_f + log_P - LOG_PI) : zero;
  }
};

// u and its derivatives by f and by P, rho = 2/P:
//   u   = (rho f/2) (1 - C) + (pi rho^2/2) [(1 - C)^2 (2 + C)/3 + I]     u_f = (rho/2) (1 - C + J)     u_ff = K/(2 pi)
//   I   = sum b_i T_(2i+2),  J = sum b_i U_(2i+2),  K = sum b_i [s^(2i+1)/q - (2i + 1) U_(2i)]
//   T_m = int s^m q ds = [s^(m-1) q^3 - (m - 1) k T_(m-2)]/(m + 2),   U_m = int s^m/q ds = [s^(m-1) q - (m - 1) k U_(m-2)]/m
template <class T> struct FilmTerm {
  T u, f, P, ff, fP, PP;
  T radius;    // of the film

  template <class Log>
  DEFORMABLE_INLINE FilmTerm(T force, T log_f, T pressure, T log_P, T sine, T rise, Log &&log)
  {
    const FilmRoot<T> at(force, log_f, pressure, log_P, sine, log);
    const T k = at.k, q = at.q, s2 = sine * sine, cube = q * q * q;
    T power = sine, even = 0.5 * (sine * q + k * at.lambda), odd = at.lambda, I{}, J{}, K{};
#pragma GCC unroll 6
    for (int i = 0; i < FILM_POWERS; ++i) {
      const double n = 2.0 * i + 1.0, b = FILM_SERIES[i];
      K += b * (power * at.per_q - n * odd);
      even = (power * cube - n * k * even) * (1.0 / (n + 3.0));
      odd = (power * q - n * k * odd) * (1.0 / (n + 1.0));
      I += b * even;
      J += b * odd;
      power *= s2;
    }
    const T half = 1.0 / pressure, cap = rise * rise * (3.0 - rise) * (1.0 / 3.0);    // rho/2
    u = half * (force * rise + 2.0 * PI * half * (cap + I));
    f = half * (rise + J);
    ff = (0.5 / PI) * K;
    P = half * (force * f - 2.0 * u);
    fP = half * (force * ff - f);
    PP = half * half * (6.0 * u + force * (force * ff - 4.0 * f));
    radius = half * (sine + q);
  }
};

// What all contacts share, if some are films: w and the balance go with e_c = f_c + pi s_c^2 in place of f_c. Both are by the sums
// of e and e^2. `rate`, `mixed` and `square`, which only correct, leave out how w changes.
template <class T> struct FilmLoad : DropletLoad<T> {
  T tilt;    // d(S psi)/df_c has the further term tilt s_c^2

  template <class Log, class Exp>
  DEFORMABLE_INLINE FilmLoad(T sum, T sum_of_squares, T sum_of_e, T squares_of_e, Log &&log,
                             Exp &&exp)
  {
    this->x = sum * BY_SUM;
    this->squares = sum_of_squares * BY_SUM;
    this->held = sum_of_e * BY_SUM;
    const T least = T{} + 1e-100, per_e = 1.0 / larger(sum_of_e, least), y = squares_of_e * per_e,
            w = y * per_e;
    this->facet = y * BY_SUM;
    const DropletPsi<T> of(this->x, w, log);
    const T turn = 2.0 * PSI_UNEVEN * of.by_P * this->squares * per_e;
    tilt = PI * turn * per_e;
    this->psi = of.psi;
    this->slope = BY_SUM * this->squares * of.by_x - turn * w;
    this->stretch = of.psi + 4.0 * tilt;
    this->rate = (BY_SUM * BY_SUM) * this->squares * of.by_xx;
    this->mixed = (BY_SUM * 0.25 / PI) * of.by_x;
    this->square = T{};
    this->damp(exp);
  }
};

// The least force that a film may bear.
template <class T> DEFORMABLE_INLINE T least_of_film(T sine, T pressure)
{
  return (-PI * (1.0 - TORN * TORN)) * sine * sine / pressure;
}

// P and its derivative by L.
template <class T> struct FilmPressure {
  T P, slope;

  DEFORMABLE_INLINE FilmPressure(T L, T X)
  {
    const T over = 1.0 / L, of_X = X * over, least = T{} + 1.0;
    P = larger(2.0 * over * (1.0 + of_X), least);    // of forces that no droplet bears
    slope = -2.0 * over * over * (1.0 + 2.0 * of_X);
  }
};

// 4 pi {1 - L^2/3 - 2/(3 L) + X [2 - 4 L/3 - 2/(3 L^2)]} = (4 pi/3) (L - 1)^2 {-(L + 2)/L - 2 X (2 L + 1)/L^2}, to all digits
template <class T> DEFORMABLE_INLINE T work_of_stretch(T L, T X)
{
  const T over = 1.0 / L, d = L - 1.0;
  return (-4.0 / 3.0 * PI) * d * d * over * (L + 2.0 + 2.0 * X * over * (2.0 * L + 1.0));
}

// What a film between droplets of one tension g and unlike radii has beside u of both sides, by F and the pressures p_i and p_j inside:
//   2 pi g ((p_i - p_j)/(4 g))^2 Y,   rho = 4 g/(p_i + p_j),   k = 2 F/(pi g rho),   in units of g
//   Y = int_0^theta r^4 (1/4 - s/q) s dpsi = (rho/2)^4 [k^2/4 I_1 - 2 k I_3 - 6 I_5 - sum b_i (6 U_(2i+6) + 5 k U_(2i+4))]
// with I_n = int s^n dpsi, and d U_m/dk = -V_m/2, V_m = int s^m/q^3 ds = U_(m-2) - k V_(m-2).
template <class T> struct CurvedFilm {
  T energy, by_force, by_p_i, by_p_j;

  template <class Log>
  DEFORMABLE_INLINE CurvedFilm(T force, T p_i, T p_j, T tension, T sine, T rise, Log &&log)
  {
    const T mean = 0.5 * (p_i + p_j), per_g = 1.0 / tension, half = tension / mean;    // rho/2
    const T f = force * per_g, P = mean * per_g;
    const FilmRoot<T> at(f, log(some_force(f)), P, log(P), sine, log);
    const T k = at.k, q = at.q, s2 = sine * sine, C = 1.0 - rise;
    const T I1 = rise, I3 = rise * rise * (2.0 + C) * (1.0 / 3.0),
            I5 = rise - (2.0 / 3.0) * (1.0 - C * C * C) + 0.2 * (1.0 - C * C * C * C * C);
    // U_2, V_2 and then each next one
    T U = 0.5 * (sine * q - k * at.lambda), V = at.lambda - sine * at.per_q, power = sine * s2,
      sum{}, slope{};
#pragma GCC unroll 6
    for (int i = 0; i < FILM_POWERS; ++i) {
      const double m = 2.0 * i + 4.0, b = FILM_SERIES[i];
      const T V4 = U - k * V, U4 = (power * q - (m - 1.0) * k * U) * (1.0 / m);
      power *= s2;
      const T V6 = U4 - k * V4, U6 = (power * q - (m + 1.0) * k * U4) * (1.0 / (m + 2.0));
      sum += b * (6.0 * U6 + 5.0 * k * U4);
      slope += b * (5.0 * U4 - 3.0 * V6 - 2.5 * k * V4);
      U = U4;
      V = V4;
    }
    const T fourth = half * half * half * half;
    const T Y = fourth * (0.25 * k * k * I1 - 2.0 * k * I3 - 6.0 * I5 - sum),
            Y_k = fourth * (0.5 * k * I1 - 2.0 * I3 - slope);
    const T turn = (p_i - p_j) * 0.25 * per_g, twice = 2.0 * PI * tension * turn * turn,
            k_by_F = mean * per_g * per_g * (1.0 / PI);
    energy = twice * Y;
    by_force = twice * Y_k * k_by_F;
    // Y goes with rho^4, rho with 1/p, k with p
    const T by_mean = twice * (k * Y_k - 4.0 * Y) / mean, by_turn = PI * turn * Y;
    by_p_i = 0.5 * by_mean + by_turn;
    by_p_j = 0.5 * by_mean - by_turn;
  }
};

}    // namespace deformable

#endif
