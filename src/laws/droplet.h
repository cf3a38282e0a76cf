// A droplet in three dimensions between contacts, one force each: Morse and Witten's theory with a term for large loads.
//
// A droplet of radius R and tension g keeps its volume. In units of R and g R its contacts have outward normals n_c and bear
// forces f_c >= 0. With m = n_c.n_k and the load x = sum f/(8 pi), the part of the surface that facets would cover, the work
//   w = sum f^2/(8 pi) [l - 1/3 + L] + 1/2 sum_{c != k} G(m) f_c f_k,   l = ln(8 pi/f),   L = ln(1 + 4 x^2)/2
// is what forces take from the energy: its derivatives are the indentations,
//   a_c = dw/df_c = f/(4 pi) [l - 5/6 + L] + S dL/dx/(8 pi) + sum_k G f_k,   S = sum f^2/(8 pi)
// and the energy of the droplet is f.a - w. It is asymptotically exact for small forces. L is not in the published theory, whose
// work is not convex beyond small loads; the 4 in it was fitted to the osmotic pressure of fcc crystals. Beyond the model, at
// x > 1/2, L has the further term 30 (x - 1/2)^3: without it forces grew without end, as w would fall in some directions.
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
// volume and center. log_half: ln((1 - m)/2).
//   G(m) = -[1/2 + 4 m/3 + m ln((1 - m)/2)]/(4 pi)
template <class T> DEFORMABLE_INLINE T droplet_green(T m, T log_half)
{
  return (0.5 + m * (4.0 / 3.0 + log_half)) * (-0.25 / PI);
}

// dG/dm. over_half: 2/(1 - m).
template <class T> DEFORMABLE_INLINE T d_droplet_green(T m, T log_half, T over_half)
{
  return (4.0 / 3.0 + log_half - 0.5 * m * over_half) * (-0.25 / PI);
}

// d^2G/dm^2.
inline double dd_droplet_green(double over_half)
{
  return over_half * (2.0 + over_half) * (0.0625 / PI);
}

// Cosines are cut where (1 - m)/2 is this: contacts in one direction repel each other strongly, but not without a limit. Beyond
// it G is constant.
constexpr double SMALLEST_HALF = 1e-12;

// G has its smallest value, -0.0468, at m = 0.269: no contact bulges by more than this times x R.
constexpr double BULGE_PER_LOAD = 1.177;
// Beyond this load the theory is off by more than it is worth; the work may lose its convexity.
constexpr double LARGEST_LOAD = 0.4;
// And beyond this part of the surface in the mean facet, y = sum f^2/(8 pi sum f), where contacts are few and strong: two plates
// bear a quarter less than they should. Dense packings have less than this up to LARGEST_LOAD.
constexpr double LARGEST_FACET = 0.05;
// Where the further term of L begins, and its factor: w is convex again from x = 0.9 on between regular contacts.
constexpr double CONTINUED_LOAD = 0.5, STIFFENING = 30.0;
// Of a radius: contacts that are farther outside bear nothing. That is never met up to LARGEST_LOAD.
constexpr double LARGEST_BULGE = 0.5;

// How far contacts may lie outside of the undeformed droplet and still bear a force.
inline double droplet_bulge(double radius, double load)
{
  return radius * std::min(BULGE_PER_LOAD * load, LARGEST_BULGE);
}

// Contacts that bear nothing have the logarithm of this force.
constexpr double NO_FORCE = 1e-300;
// The compliance of a contact grows without bound as its force vanishes. The solver takes that of this part of the mean force
// at least, or of LEAST_ALONE where a droplet bears nothing: then a contact that opens takes a step of the right size.
constexpr double LEAST_OF_MEAN = 1e-3, LEAST_ALONE = 1e-2;

// What all contacts of a droplet share. log: ln of a T.
template <class T> struct DropletLoad {
  T x, squares;                // sum f^2/(8 pi)
  T facet;                     // y
  T logarithm, slope, bend;    // L, and its first and second derivatives by sum f

  template <class Log>
  DEFORMABLE_INLINE DropletLoad(T sum, T sum_of_squares, Log &&log)
      : x(sum * (0.125 / PI)),
        squares(sum_of_squares * (0.125 / PI)),
        facet(squares / (sum > NO_FORCE ? sum : T{} + NO_FORCE))
  {
    constexpr double BY_SUM = 0.125 / PI;
    const T q = 1.0 + 4.0 * x * x, far = x - CONTINUED_LOAD, over = far > 0.0 ? far : T{},
            stiff = STIFFENING * over * over;
    logarithm = 0.5 * log(q) + stiff * over;
    slope = (4.0 * x / q + 3.0 * stiff) * BY_SUM;
    bend = ((4.0 - 32.0 * x * x / q) / q + 6.0 * STIFFENING * over) * (BY_SUM * BY_SUM);
  }
};

// The part of a contact's own force in w, in a, and in da/df; l = ln(8 pi/f). At f = 0 the first two vanish, and the last
// one is as large as l.
template <class T> DEFORMABLE_INLINE T own_work(T f, T l, T logarithm)
{
  return f * f * (l + (logarithm - 1.0 / 3.0)) * (0.125 / PI);
}

template <class T> DEFORMABLE_INLINE T own_indentation(T f, T l, T logarithm)
{
  return f * (l + (logarithm - 5.0 / 6.0)) * (0.25 / PI);
}

template <class T> DEFORMABLE_INLINE T own_compliance(T l, T logarithm)
{
  return (l + (logarithm - 11.0 / 6.0)) * (0.25 / PI);
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
