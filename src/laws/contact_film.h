// Contacts that stick: the angles at which outlines meet their film, and what the angles do to a ring.

#ifndef DEFORMABLE_CONTACT_FILM_H
#define DEFORMABLE_CONTACT_FILM_H

#include "laws/contact_curve.h"

namespace deformable {

// An adhesion w, an energy per length, lowers the tension of a film to T_i + T_j - w. Both outlines meet it at the angles
// of Neumann's triangle,
//   T_i cos theta_i + T_j cos theta_j = T_i + T_j - w,   T_i sin theta_i = T_j sin theta_j,
// which exists for w below twice the smaller tension. A wall is a partner of infinite tension: cos theta = 1 - w/T.

// No film has a larger adhesion, over the weaker tension: angles are held there.
constexpr double LARGEST_ADHESION = 1.96;

// A film has no length left where f = -2 T sin theta: for a droplet of constant area and tension at a wall, alone, at
//   h/R = (cos theta + sin theta/(2 pi)) [1 - (theta + sin theta cos theta + sin^2 theta/(2 pi))/pi]^(-1/2)
// from the center. This is R at theta = 53.8 degrees, w = 0.41 T: more adhesive droplets, pairs of twice that, have no film at touch.
constexpr double LARGEST_AT_TOUCH = 0.41;

// A ring sees the film as an arc of half angle b (contact_curve.h) and its free outline goes on to alpha = theta + b. With
// L = f/p, q = T/p and half the chord s = L/2 + q sin alpha,
//   A = pi E^2 - L.GL/2 - sum [q^2 (alpha - sin alpha cos alpha) + L q (1 - cos alpha) - 4 s^2 cap],
//   P = 2 pi E + sum [2 s b/sin b - 2 q alpha - L],
// so that P p and A p^2 are polynomials in T. They are those of a ring without angles for the total force and the work
//   F'' = F' + 2 T Y,   Q'' = Q' + T^2 (sum square + Y^2/pi) + T (sum f linear + F' Y/pi),   Y = sum perimeter,
// with F' and Q' of contact_curve.h and the tension T = gamma + kP (P - P0). The middle of the film is closer to the center
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

// Half of the film's chord, of a contact of the length L.
inline double half_chord(double length, double q, double t, double u)
{
  const double sine = 2.0 * (t + u) * (1.0 - t * u) / ((1.0 + t * t) * (1.0 + u * u));
  return 0.5 * length + q * sine;
}

}    // namespace deformable

#endif
