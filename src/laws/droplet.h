// A droplet in three dimensions between contacts, one force each: Morse and Witten's theory to the next order.
//
// A droplet of radius R and tension g keeps its volume. In units of R and g R its contacts have outward normals n_c and bear
// forces f_c >= 0. The work W(f, n) is what forces take from the energy: its derivatives by forces are the indentations a, and
// the energy of the droplet is f.a - W. With m = n_c.n_k, q = (1 - m)/2, l = ln(8 pi/f), the load x = sum f/(8 pi), which is
// the part of the surface that facets would cover, s = f^2/(8 pi) and the evenness w = sum f^2/(sum f)^2,
//   W = sum s (l - 1/3) + 1/2 sum_{c != k} G(m) f_c f_k                            Morse and Witten
//     + sum s [psi - 2 a1 + f/(12 pi)] + D^4 [T1 + 2 x J] + D^16 (2/3) I3 + (BALANCE/2) x |sum f n|^2
//   a1_c = (f/(4 pi)) (l - 5/6) + sum_{k != c} G f_k                               the indentation of first order
//   t_c  = -sum_{k != c} G'(m) f_k (n_k - m n_c),   T1 = -1/2 sum f_c t_c^2        R t: the place of the facet beside the line of
//                                                                                  centers
//   J    = sum_{c, k} G2(m) f_c f_k,   I3 = A tr Q^3 + B sum f^3 + C sum_{c, k} G2(m) f_c^2 f_k,   Q = sum f (n n - 1/3)
//   psi  = ln(1 + P x)/P,   P = 1.43 (1 + 10 w),   D = exp(-DECAY x/4)
// where J and I3 are the integrals of the square and the cube of the shape of first order over the sphere; A, B and C were
// fitted to the second integral. All terms of third order in f are exact but for that. How they go on at large loads has two
// numbers that were fitted to exact shapes, 1.43 and DECAY. The last term vanishes where forces balance; without it W would
// not be convex for others. Beyond the model, at x > 1/2, psi has the further term 30 (x - 1/2)^3: without it forces grew
// without end.
//
// The terms of third order, with the shape of first order zeta = -sum f G(n.u):
//   the area has none in zeta, the volume gives -(2/3) int zeta^3, and the pressure goes with the mean of zeta, which gives 2 x J;
//   the height in a direction is 1 + zeta + |grad zeta|^2/2: a facet gains by a shift t across the line of centers, -f t^2/2;
//   within a facet the outline is flat, and the pressure on it is p (1 - a)^2: s l becomes s (l + x - 2 a1);
//   a pure self term remains, f^3/(96 pi^2).
//
// The film between droplets i and j has the curvature that the difference of their pressures asks for, so its area is F over the
// mean pressure: l has the further term ln(lambda_i), lambda_i = g_j (R_i + R_j)/(R_j (g_i + g_j)), in the first line of W. It
// may turn, too, if the places R t of both sides differ. That gives back the energy
//   F |R_i t_i - R_j t_j|^2/(2 (R_i + R_j)) D_i D_j                                the film turns by (R_i t_i - R_j t_j)/d
// of which both droplets have a half. A wall has lambda = 1, and does not turn.
//
// Sources: D. C. Morse and T. A. Witten, Europhys. Lett. 22, 549 (1993); R. Hoehler and S. Cohen-Addad, Soft Matter 13, 1371
// (2017).

#ifndef DEFORMABLE_DROPLET_H
#define DEFORMABLE_DROPLET_H

#include "laws/trigonometry.h"

#include <algorithm>
#include <cmath>

namespace deformable {

// T is double, or a vector of doubles.

// Displacement of the surface toward the center by a unit force in another direction, at the cosine m < 1 from it. It keeps
// volume and center. log_half: ln q.
//   G(m) = -[1/2 + 4 m/3 + m ln q]/(4 pi)
template <class T> DEFORMABLE_INLINE T droplet_green(T m, T log_half)
{
  return (0.5 + m * (4.0 / 3.0 + log_half)) * (-0.25 / PI);
}

// dG/dm. over_half: 1/q.
template <class T> DEFORMABLE_INLINE T d_droplet_green(T m, T log_half, T over_half)
{
  return (4.0 / 3.0 + log_half - 0.5 * m * over_half) * (-0.25 / PI);
}

// d^2G/dm^2 = [1/q + m/(4 q^2)]/(4 pi)
template <class T> DEFORMABLE_INLINE T dd_droplet_green(T m, T over_half)
{
  return over_half * (1.0 + 0.25 * m * over_half) * (0.25 / PI);
}

// Integral of G(n_c.u) G(n_k.u) over the sphere of all u,
//   4 pi G2(m) = 1/12 + (10/27 - pi^2/18) m + (1 - m)/3 ln q + (m/3) Li2(1 - q),   4 pi G2(1) = 49/108,
// as A(q) + q B(q) ln q, with A and B of degrees 6 and 4: least squares at Chebyshev's points, to 3e-10.
constexpr double GREEN2_AT_ONE = 49.0 / 108.0 * (0.25 / PI);
constexpr double GREEN2_A[] = {0.45370370419819173,  -1.0740660508148902, 0.5844269853816528,
                               0.1475786928332522,   0.10519466174736324, 0.04328011203201802,
                               0.0011562133057813342};
constexpr double GREEN2_B[] = {1.0000011662487065, -0.4997402714402126, -0.21506475750506304,
                               -0.09475931143928624, -0.01619532441376531};

template <class T> DEFORMABLE_INLINE T droplet_green2(T q, T log_q)
{
  T a = T{} + GREEN2_A[6], b = T{} + GREEN2_B[4];
  for (int n = 5; n >= 0; --n) a = a * q + GREEN2_A[n];
  for (int n = 3; n >= 0; --n) b = b * q + GREEN2_B[n];
  return (a + q * b * log_q) * (0.25 / PI);
}

// dG2/dm = -1/2 dG2/dq
template <class T> DEFORMABLE_INLINE T d_droplet_green2(T q, T log_q)
{
  T a = T{} + 6.0 * GREEN2_A[6], b = T{} + GREEN2_B[4], qb = T{} + 5.0 * GREEN2_B[4];
  for (int n = 5; n >= 1; --n) a = a * q + n * GREEN2_A[n];
  for (int n = 3; n >= 0; --n) b = b * q + GREEN2_B[n];
  for (int n = 3; n >= 0; --n) qb = qb * q + (n + 1) * GREEN2_B[n];
  return (a + b + qb * log_q) * (-0.125 / PI);
}

// Cosines are cut where (1 - m)/2 is this: contacts in one direction repel each other strongly, but not without a limit. Beyond
// it G is constant. T1 would fall without a bound as two contacts approach each other: within 10 degrees t has the G' that
// they have there.
constexpr double SMALLEST_HALF = 1e-12, SMALLEST_APART = 0.0076,
                 SLOPE_AT_SMALLEST = 5.437985992907296;

// G has its smallest value, -0.0468, at m = 0.269: no contact bulges by more than this times x R.
constexpr double BULGE_PER_LOAD = 1.177;
// A pull has its largest bulge on the opposite side, where G(-1) = 0.0663 is.
constexpr double BULGE_PER_PULL = 1.67;
// Beyond this load the theory is off by more than it is worth; the work may lose its convexity.
constexpr double LARGEST_LOAD = 0.4;
// And beyond this part of the surface in the mean facet, y = sum f^2/(8 pi sum f), where contacts are few and strong. Dense
// packings have less than this up to LARGEST_LOAD.
constexpr double LARGEST_FACET = 0.05;
// Where the further term of psi begins, and its factor.
constexpr double CONTINUED_LOAD = 0.5, STIFFENING = 30.0;
// Of a radius: contacts that are farther outside bear nothing. That is never met up to LARGEST_LOAD.
constexpr double LARGEST_BULGE = 0.5;

constexpr double PSI_EVEN = 1.43, PSI_UNEVEN = 14.3, DECAY = 2.6, BALANCE = 0.5;
constexpr double CUBE_TRACE = -0.00368257, CUBE_FORCES = -0.00026156, CUBE_GREEN2 = -0.11453672;
constexpr double BY_SUM = 0.125 / PI;    // dx/df
// 1 + P x is cut there, far beyond the pull of any films.
constexpr double LEAST_OF_PSI = 1e-3;

// How far contacts may lie outside of the undeformed droplet and still bear a force.
inline double droplet_bulge(double radius, double load)
{
  return radius * std::min(BULGE_PER_LOAD * load, LARGEST_BULGE);
}

// lambda of droplet i.
inline double film_ratio(double radius_i, double tension_i, double radius_j, double tension_j)
{
  return tension_j * (radius_i + radius_j) / (radius_j * (tension_i + tension_j));
}

// Contacts that bear nothing have the logarithm of this force.
constexpr double NO_FORCE = 1e-300;
// The compliance of a contact grows without bound as its force vanishes. The solver takes that of this part of the mean force
// at least, or of LEAST_ALONE where a droplet bears nothing: then a contact that opens takes a step of the right size.
constexpr double LEAST_OF_MEAN = 1e-3, LEAST_ALONE = 1e-2;
// And no compliance below this: beyond the model W is not convex.
constexpr double LEAST_COMPLIANCE = 0.01;

// psi(x, P(w)), P = 1.43 (1 + 10 w), and its derivatives by x and P. x may be negative, as where films pull. log: of a T.
template <class T> struct DropletPsi {
  T psi, by_x, by_P, by_xx, by_xP, by_PP;

  template <class Log> DEFORMABLE_INLINE DropletPsi(T x, T w, Log &&log)
  {
    const T P = PSI_EVEN + PSI_UNEVEN * w, per_P = 1.0 / P, z = P * x, sum = 1.0 + z,
            least = T{} + LEAST_OF_PSI, u = sum > LEAST_OF_PSI ? sum : least, per_u = 1.0 / u;
    const T above = u - 1.0;    // ln(1 + z) to all digits
    const T rounded = above != 0.0 ? above : T{} + 1.0, L = log(u) * (z / rounded);
    const T ln = above != 0.0 ? L : z;
    const T far = x - CONTINUED_LOAD, over = far > 0.0 ? far : T{},
            stiff = STIFFENING * over * over;
    psi = ln * per_P + stiff * over;
    by_x = per_u + 3.0 * stiff;
    by_P = (x * per_u - ln * per_P) * per_P;
    by_xx = T{} - P * per_u * per_u + 6.0 * STIFFENING * over;
    by_xP = T{} - x * per_u * per_u;
    by_PP = ((2.0 * (ln * per_P - x * per_u)) * per_P - x * x * per_u * per_u) * per_P;
  }
};

// What all contacts of a droplet share. log, exp: of a T.
//   S = sum f^2/(8 pi), psi(x, P), P = P(w):   d(S psi)/df_c = slope + f_c/(4 pi) stretch,
//   d^2(S psi)/df_c df_k = rate + mixed (f_c + f_k) + square f_c f_k,   for c = k also stretch/(4 pi)
template <class T> struct DropletLoad {
  T x, squares;    // S
  T held;          // x of the term that holds forces which do not balance
  T facet;         // y
  T psi, slope, stretch, rate, mixed, square;
  T damping, first, third;    // D, D^4, D^16

  template <class Log, class Exp>
  DEFORMABLE_INLINE DropletLoad(T sum, T sum_of_squares, Log &&log, Exp &&exp)
      : x(sum * BY_SUM),
        squares(sum_of_squares * BY_SUM),
        held(x)
  {
    constexpr double LEAST = 1e-100;
    const T least = T{} + LEAST, some = x > LEAST ? x : least;
    const T y = squares / some, w = y / some * BY_SUM;
    facet = y * BY_SUM;
    const DropletPsi<T> of(x, w, log);
    const T turn = PSI_UNEVEN * w;    // dP/dw w
    psi = of.psi;
    slope = BY_SUM * (squares * of.by_x - 2.0 * turn * y * of.by_P);
    stretch = psi + turn * of.by_P;
    rate = (BY_SUM * BY_SUM) * (squares * of.by_xx - 4.0 * turn * y * of.by_xP) +
           BY_SUM * (turn * w) * (4.0 * PSI_UNEVEN * w * of.by_PP + 6.0 * of.by_P);
    mixed = (BY_SUM * 0.25 / PI) * (of.by_x + turn * of.by_xP -
                                    (4.0 * turn * of.by_P + 2.0 * turn * turn * of.by_PP) / some);
    square = (0.0625 / (PI * PI)) * (PSI_UNEVEN * BY_SUM) * (2.0 * of.by_P + turn * of.by_PP) /
             (some * some);
    damp(exp);
  }

 protected:
  DropletLoad() = default;
  template <class Exp> DEFORMABLE_INLINE void damp(Exp &&exp)
  {
    damping = exp(x * (-0.25 * DECAY));
    const T twice = damping * damping;
    first = twice * twice;
    const T doubled = first * first;
    third = doubled * doubled;
  }
};

// The terms of W that all contacts share, D^4 [T1 + 2 x J] + D^16 (2/3) I3 + (BALANCE/2) x |sum f n|^2, by these four. `by_force`: what
// they and S psi add to each indentation by way of x.
template <class T> struct SharedTerms {
  T work, by_force;

  DEFORMABLE_INLINE SharedTerms(const DropletLoad<T> &of, const T &T1, const T &J, const T &I3,
                                const T &off)
  {
    const T uneven = T1 + 2.0 * of.x * J;
    work = of.first * uneven + (2.0 / 3.0) * of.third * I3 + (0.5 * BALANCE) * of.held * off;
    by_force = of.slope + BY_SUM * (of.first * (2.0 * J - DECAY * uneven) -
                                    (8.0 / 3.0 * DECAY) * of.third * I3 + (0.5 * BALANCE) * off);
  }
};

// The part of a contact's own force in W, in a, and in da/df; l = ln(8 pi/f), `film` = ln(lambda). At f = 0 the first two vanish,
// and the last one is as large as l.
//   s (l + film - 1/3 + psi) + f^3/(96 pi^2) - f^3 (l - 5/6)/(16 pi^2)
template <class T> DEFORMABLE_INLINE T own_work(T f, T l, T film, T psi)
{
  return f * f * BY_SUM * (l + film + (psi - 1.0 / 3.0) - f * (l - 1.0) * (0.5 / PI));
}

template <class T> DEFORMABLE_INLINE T own_indentation(T f, T l, T film, T stretch)
{
  return f * (0.25 / PI) * (l + film + (stretch - 5.0 / 6.0) - f * (3.0 * l - 4.0) * (0.25 / PI));
}

template <class T> DEFORMABLE_INLINE T own_compliance(T f, T l, T film, T stretch)
{
  return (0.25 / PI) * (l + film + (stretch - 11.0 / 6.0) - f * (6.0 * l - 11.0) * (0.25 / PI));
}

// The energy f.a - W of a droplet between nothing but one contact, in units of gR^2. There T1 = 0, and the terms of third order
// are J = G2(1) f^2, tr Q^3 = (2/9) f^3 and |sum f n|^2 = f^2.
inline double droplet_energy_alone(double f, double film)
{
  const auto log = [](double x) { return std::log(x); };
  const auto exp = [](double x) { return std::exp(x); };
  const DropletLoad<double> of(f, f * f, log, exp);
  const double l = std::log(8.0 * PI / f), cube = f * f * f;
  const double second = 2.0 * BY_SUM * GREEN2_AT_ONE * cube * of.first;
  const double third = 2.0 / 3.0 * cube * of.third *
                       (2.0 / 9.0 * CUBE_TRACE + CUBE_FORCES + CUBE_GREEN2 * GREEN2_AT_ONE);
  const double own = f * own_indentation(f, l, film, of.stretch) - own_work(f, l, film, of.psi);
  return own + f * of.slope + (2.0 - DECAY * of.x) * second + (2.0 - 4.0 * DECAY * of.x) * third +
         BALANCE * BY_SUM * cube;
}

constexpr double LOG_8_PI = 3.2241714275292361;    // ln(8 pi)

// The pressure inside: 2 g/R at rest. The surface, of the energy e = g (4 pi R^2) + U, and the contacts at the distances
// h = R - a hold it:  3 V p = 2 e + sum F h  (as energies scale with lengths).
inline double droplet_pressure(double radius, double tension, double energy, double force_times_h)
{
  const double surface = 4.0 * PI * radius * radius, volume = surface * radius / 3.0;
  return (2.0 * (tension * surface + energy) + force_times_h) / (3.0 * volume);
}

// A facet that bears the force F at the pressure 2 g/R has this radius.
inline double facet_radius(double force, double radius, double tension)
{
  return std::sqrt(force * radius / (2.0 * PI * tension));
}

}    // namespace deformable

#endif
