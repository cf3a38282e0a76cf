// Contact lines that tilt and bend, and films: slopes of outlines at their contacts, rings with contacts that are arcs, and the
// angles at which outlines meet a film that sticks.

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

// Contacts that stick. An adhesion w, an energy per length, lowers the tension of a film to T_i + T_j - w. Both outlines meet it at
// the angles of Neumann's triangle,
//   T_i cos theta_i + T_j cos theta_j = T_i + T_j - w,   T_i sin theta_i = T_j sin theta_j,
// which exists for w below twice the smaller tension. A wall is a partner of infinite tension: cos theta = 1 - w/T.

// No film has a larger adhesion, over the weaker tension: angles are held there.
constexpr double LARGEST_ADHESION = 1.96;

// A film has no length left where f = -2 T sin theta: for a droplet of constant area and tension at a wall, alone, at
//   h/R = (cos theta + sin theta/(2 pi)) [1 - (theta + sin theta cos theta + sin^2 theta/(2 pi))/pi]^(-1/2)
// from the center. This is R at theta = 53.8 degrees, w = 0.41 T: more adhesive droplets, pairs of twice that, have no film at touch.
constexpr double LARGEST_AT_TOUCH = 0.41;

// A ring sees the film as an arc of half angle b, and its free outline goes on to alpha = theta + b. With
// L = f/p, q = T/p and half the chord s = L/2 + q sin alpha,
//   A = pi E^2 - L.GL/2 - sum [q^2 (alpha - sin alpha cos alpha) + L q (1 - cos alpha) - 4 s^2 cap],
//   P = 2 pi E + sum [2 s b/sin b - 2 q alpha - L],
// so that P p and A p^2 are polynomials in T. They are those of a ring without angles for the total force and the work
//   F'' = F' + 2 T Y,   Q'' = Q' + T^2 (sum square + Y^2/pi) + T (sum f linear + F' Y/pi),   Y = sum perimeter,
// with F' and Q' from above and the tension T = gamma + kP (P - P0). The middle of the film is closer to the center
// by q (depth + Y/pi) than that of the ring without angles, by which a_c is larger. All terms vanish with theta. T is double,
// or a vector of doubles.
template <class T> struct FilmTerms {
  T perimeter;    // (sin alpha) b/sin b - alpha
  T linear;       // (b/sin b)(1 - cos theta) + sin theta (sin b - b cos b)/sin^2 b
  T square;       // perimeter + linear sin alpha
  T depth;        // 1 - cos(theta + b/2)/cos(b/2)
};

// t = tan(theta/2), u = tan(b/2); angle: theta, of its cosine and sine.
template <class T, class Angle>
DEFORMABLE_INLINE FilmTerms<T> film_terms(T t, T u, Angle &&angle)
{
  const T s = u * u, s2 = s * s, part = 1.0 + (1.0 + s) * taylor::arctangent(s, s2, s2 * s2);
  const T per_t = 1.0 / (1.0 + t * t), per_u = 1.0 / (1.0 + s);
  const T sine = 2.0 * t * per_t, versine = 2.0 * t * t * per_t, cosine = 1.0 - versine;
  const T sin_b = 2.0 * u * per_u, cos_b = (1.0 - s) * per_u;
  const T stretch = 1.0 + s * part;    // b/sin b
  FilmTerms<T> terms;
  terms.perimeter = stretch * cos_b * sine - angle(cosine, sine) - stretch * sin_b * versine;
  terms.linear = stretch * versine + sine * u * (1.0 - 0.5 * part * (1.0 - s));
  terms.square = terms.perimeter + terms.linear * (sine * cos_b + cosine * sin_b);
  terms.depth = versine + u * sine;
  return terms;
}

// Q'', F'' and T Y/pi, from the load without angles and the sums over the contacts.
template <class T>
DEFORMABLE_INLINE CurvedLoad<T> film_load(T work, T total, T tension, T perimeter, T linear,
                                          T square)
{
  const T per_pi = perimeter * (1.0 / PI);
  return {work + tension * (tension * (square + perimeter * per_pi) + (linear + total * per_pi)),
          total + 2.0 * perimeter * tension, tension * per_pi};
}

// A line that keeps its curvature, as in corrections of forces (CurvedLines), to first order in u. With h = 2 T sin theta and
// g = f + h the chord of a film is 2 s = g/p. C is that of a straight line, but for
//   G(0) - u f/g on its diagonal,   p b_c less by u (f - h)/2,   2 Q in e less by the sum of (f - 2 h) g cap.
// As the curvature grows by dk, the area v dk goes to the second ring, v = (2/3) s^3 - h s^2/p: where outlines meet the film at an
// angle, its ends take them along. h = 0 without a film.

// Half of the film's chord, of a contact of the length L.
inline double half_chord(double length, double q, double t, double u)
{
  const double sine = 2.0 * (t + u) * (1.0 - t * u) / ((1.0 + t * t) * (1.0 + u * u));
  return 0.5 * length + q * sine;
}

}    // namespace deformable

#endif
