// Contact lines that tilt and bend: slopes of outlines at their contacts, and rings with contacts that are arcs.

#ifndef DEFORMABLE_CONTACT_CURVE_H
#define DEFORMABLE_CONTACT_CURVE_H

#include "laws/ring_forces.h"

namespace deformable {

// No line tilts by more than 0.3 rad.
constexpr double LARGEST_SINE = 0.29552020666133957;

// No line bends by more than sin beta = 1/2. This is tan(beta/2) then.
constexpr double LARGEST_BEND = 0.2679491924311227;

// The line of a pair at distance d is at rest at the tilt tau with d sin tau = t_i + t_j, where
//   t_c = sum over k of L_k G'(theta_c - theta_k)
// is the slope -dH/dtheta of an outline at the contact, and -p L_c t_c = dU/dtheta_c. While the lengths L stay,
//   dt_c/dtheta_c = sum over k != c of L_k G''(theta_c - theta_k) = (sum L/2 + along)/pi - (GL)_c - G(0) L_c,
//   along = n_c . sum over k of L_k n_k,
// because G'' = -G + 1/2pi + cos(t)/pi for t != 0. `along` vanishes in a ring at rest. T is double, or a vector of
// doubles.
template <class T> DEFORMABLE_INLINE T slope_rate(T lengths, T along, T green_lengths, T length)
{
  return (0.5 * lengths + along) * (1.0 / PI) - green_lengths - GREEN_AT_ZERO * length;
}

// Between unequal pressures the line is an arc of half angle beta, convex for the ring i of larger pressure:
//   sin beta = f (1/p_j - 1/p_i)/(2 (Q_i + Q_j)),   Q = q + skin the radius of curvature of the free outline.
// Each ring sees the half angle b = beta (i) or -beta (j). With L = f/p and the radius E of ring_forces.h,
//   A = pi E^2 - L.GL/2 + sum [L^2 cap + q L excess],   P = 2 pi E + sum L excess,   q = E - sum L/2 pi,
// and the middle of the arc is at the distance E - (GL)_c + u L_c/2 from the center, u = tan(b/2). With X = sum f excess
// and E + X/2 pi p in place of E, those are the formulas of ring_forces.h for the total force and the work
//   F' = F + X,   Q' = f.Gf/2 - sum f^2 cap + X (X + 2 F)/4 pi,
// which therefore give pressure, expansion and energy;  a_c = [(Gf)_c + X/2 pi - u f_c/2]/p - delta.
template <class T> struct ArcTerms {
  T excess;    // b/sin b - 1
  T cap;       // (b - sin b cos b)/(4 sin^2 b)
  T sweep;     // excess/sin^2 b
};

template <class T> DEFORMABLE_INLINE ArcTerms<T> arc_terms(T u)
{
  const T s = u * u, s2 = s * s, more = 1.0 + s;
  const T part = 1.0 + more * taylor::arctangent(s, s2, s2 * s2);
  return {s * part, u * 0.125 * (more * part + 2.0), 0.25 * more * more * part};
}

// The length of the arc that a contact of the length L is part of.
inline double arc_length(double length, double q, double u)
{
  return (length + 4.0 * q * u / (1.0 + u * u)) * (1.0 + arc_terms(u).excess);
}

// Q', F' and X/2 pi, from f.Gf/2 and the sums of f, of f excess and of f^2 cap.
template <class T> struct CurvedLoad {
  T work, total, shift;
};

template <class T> DEFORMABLE_INLINE CurvedLoad<T> curved_load(T work, T total, T excess, T cap)
{
  return {work - cap + excess * (excess + 2.0 * total) * (0.25 / PI), total + excess,
          excess * (0.5 / PI)};
}

// The tension of the outline, T = p q; gamma + kP (P - P0) where the perimeter changes. `total` is F'.
inline double tension(double radius, const LoadedRing &ring, double total)
{
  return ring.pressure * (radius + ring.expansion) - total / (2.0 * PI);
}

}    // namespace deformable

#endif
