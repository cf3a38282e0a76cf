// Friction, damping and the film of one contact: what a step does to its spring, and what it loses.
//
// A vector v along a contact with the normal n is given as n x v. That is the same from both sides, where n and v have the other
// sign, and in the plane it is the number v.t, with the tangent t, which is n turned to the left: it stays whatever n does.
// V is Vector2 or Vector3.

#ifndef DEFORMABLE_FRICTION_H
#define DEFORMABLE_FRICTION_H

#include "laws/parameter_rules.h"
#include "laws/vector2.h"
#include "laws/vector3.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace deformable {

// The spring along the contact has the length xi and the stiffness kt, beside it is a dashpot gt; another one, gn, is along
// the normal. Coulomb's coefficient mu may be infinite. A film has the constant c and the power n; it may act in one direction only.
// A coefficient of restitution below 1 is in the place of gn.
struct Friction {
  double mu = 0.0, kt = 0.0, gt = 0.0, gn = 0.0;
  double film = 0.0, power = 1.0;
  bool film_shears = true, film_squeezes = true;
  double restitution = 1.0, ratio = 0.0;    // and its damping ratio
};

// A cross product: a number, or a Vector3.
template <class V> using Along = decltype(cross(V{}, V{}));

// A vector v at a contact: n x v and n.v.
template <class V> struct ContactVector {
  Along<V> along;
  double normal;
};

inline double size_along(double v)
{
  return std::fabs(v);
}
inline double size_along(const Vector3 &v)
{
  return length(v);
}

template <class V> ContactVector<V> at_contact(const V &n, const V &v)
{
  return {cross(n, v), dot(n, v)};
}
template <class V> V from_contact(const V &n, const ContactVector<V> &v)
{
  return v.normal * n + cross(v.along, n);
}
template <class V> ContactVector<V> operator+(const ContactVector<V> &a, const ContactVector<V> &b)
{
  return {a.along + b.along, a.normal + b.normal};
}
template <class V> ContactVector<V> operator*(double s, const ContactVector<V> &a)
{
  return {s * a.along, s * a.normal};
}
template <class V> double dot(const ContactVector<V> &a, const ContactVector<V> &b)
{
  return dot(a.along, b.along) + a.normal * b.normal;
}

inline std::string invalid_friction(const Friction &c)
{
  if (!(c.mu >= 0.0)) return "mu must be 0, positive or inf, not " + shown_number(c.mu);
  const auto finite = [](double value) { return value >= 0.0 && std::isfinite(value); };
  if (!finite(c.kt)) return "kt must be 0 or positive and finite, not " + shown_number(c.kt);
  if (!finite(c.gt)) return "gt must be 0 or positive and finite, not " + shown_number(c.gt);
  if (!finite(c.gn)) return "damp must be 0 or positive and finite, not " + shown_number(c.gn);
  if (!finite(c.film)) return "film must be 0 or positive and finite, not " + shown_number(c.film);
  if (!(c.restitution > 0.0 && c.restitution <= 1.0))
    return "restitution must be above 0 and 1 at most, not " + shown_number(c.restitution);
  if (c.restitution < 1.0 && c.gn > 0.0)
    return "damp must be 0 beside a restitution, not " + shown_number(c.gn);
  if (!(c.power > 0.0 && c.power <= 1.0))
    return "the power of a film must be above 0 and 1 at most, not " + shown_number(c.power);
  return "";
}

// A film that is pulled does not rub.
inline double most_friction(double mu, double force)
{
  return force > 0.0 ? mu * force : 0.0;
}

// Restitution of a spring and a dashpot of the damping ratio z, whose contact ends where its force does, as that does not pull:
//   ln e = -2 z arccos(z)/sqrt(1 - z^2),   for z > 1 -2 z arcosh(z)/sqrt(z^2 - 1)
inline double restitution_of(double z)
{
  constexpr double NEAR = 1e-4;    // of z = 1, where both are -2 (1 + 2 (z - 1)/3)
  if (std::fabs(z - 1.0) < NEAR) return std::exp(-2.0 - 4.0 / 3.0 * (z - 1.0));
  const double angle = z < 1.0 ? std::acos(z) : std::acosh(z);
  return std::exp(-2.0 * z * angle / std::sqrt(std::fabs(1.0 - z * z)));
}

// The inverse, for 0 < e <= 1, by bisection: e < 1/z^2. Exactly 0 for e = 1.
inline double damping_ratio(double restitution)
{
  if (restitution == 1.0) return 0.0;
  double low = 0.0, high = 1.0 / std::sqrt(restitution);
  for (int n = 0; n < 60; ++n) {
    const double z = 0.5 * (low + high);
    (restitution_of(z) > restitution ? low : high) = z;
  }
  return 0.5 * (low + high);
}

// The dashpot gn of that damping ratio where the contact of two bodies with the reduced mass m bears the force f and has the
// energy U: that of a spring with the same force and energy, k = f^2/2U,
//   gn = 2 z sqrt(m k).
// So the restitution is the same for any law of the contact and any velocity: with y = sqrt(2U/m) and ds = dy/dx dt, the
// motion m dv/dt = -f - gn v is that of a linear oscillator, dy/ds = v, dv/ds = -y - 2 z v.
inline double dashpot(double ratio, double mass, double force, double energy)
{
  return energy > 0.0 ? 2.0 * ratio * force * std::sqrt(0.5 * mass / energy) : 0.0;
}

template <class A> struct Rub {    // A: Along<V>
  A xi, force;
  bool slides;
};

// After a step dt in which the two sides have moved by `way` along the contact, which is pressed by `normal` now:
//   f = kt xi + gt dxi/dt,   dxi/dt = way/dt   held to |f| <= mu normal. Where it slides, dxi/dt = (f - kt xi)/gt,
// implicit in xi, so that xi = f/kt without a dashpot. The direction of f is that of the force without a bound.
template <class A> Rub<A> rub(const Friction &c, const A &xi, const A &way, double dt,
                              double normal)
{
  const A force = c.kt * (xi + way) + c.gt * way / dt;
  const double most = most_friction(c.mu, normal), size = size_along(force);
  if (size <= most) return {xi + way, force, false};
  const A held = most * (force / size);
  const double stiff = c.gt + c.kt * dt;
  return {(c.gt * xi + dt * held) / stiff, held, true};
}

// Along the normal, positive where the sides separate: f_d = gn way/dt, never more than what presses.
inline double damping(double gn, double way, double dt, double normal)
{
  return std::min(gn * way / dt, std::max(normal, 0.0));
}

// What a step loses by sliding and in the dashpot. From the mean force F of both ends and the change of xi, the work F.way
// is that on the spring, kt (xi_1^2 - xi_0^2)/2, and
//   F.(way - (xi_1 - xi_0))   and   (F - kt (xi_0 + xi_1)/2).(xi_1 - xi_0)
struct RubLoss {
  double sliding, dashpot;
};

template <class A> RubLoss loss(double kt, const Rub<A> &before, const Rub<A> &now, const A &way)
{
  const A mean = 0.5 * (before.force + now.force), change = now.xi - before.xi;
  return {dot(mean, way - change), dot(mean - 0.5 * kt * (before.xi + now.xi), change)};
}

// The power of the same by the force now, where the sides move by v.
template <class A> RubLoss power(const Friction &c, const Rub<A> &now, const A &v)
{
  const A on_dashpot = now.force - c.kt * now.xi;
  const A rate = !now.slides ? v : c.gt > 0.0 ? on_dashpot / c.gt : A{};    // dxi/dt
  return {dot(now.force, v - rate), dot(on_dashpot, rate)};
}

// A film of the size S, its length in the plane and its area in space, drags its sides against each other by
//   f = c S |v|^(n-1) v,   0 < n <= 1,
// along the contact and along its normal. Returns f/v. For n < 1 it grows without bound where the sides come to rest, so that it
// is `most` there: f is linear in v below |v| = (c S/most)^(1/(1-n)).
inline double film_constant(const Friction &c, double size, double speed, double most)
{
  const double whole = c.film * size;
  if (c.power == 1.0 || !(whole > 0.0)) return whole;
  return std::min(whole * std::pow(speed, c.power - 1.0), most);
}

// Dashpots with this constant between particles of mass m stop them without overshooting in a step of Euler's method, with all
// contacts together. Each of z contacts takes 2 lever g/m at most from the rate of a particle, as
//   sum g |v_i - v_j|^2 <= 2 sum g (|v_i|^2 + |v_j|^2) and |v + w x b|^2 <= lever (m v^2 + I w^2)/m
inline double largest_film_constant(double mass, double lever, double dt, int dimension)
{
  const double contacts = dimension == 2 ? 6.0 : 12.0;    // of equal particles
  return mass / (2.0 * contacts * lever * dt);
}

// Beyond this time step a contact of two particles of mass m gets out of hand. Along it they move like the mass
// m/(2 lever), lever = 1 + m R^2/I, or 1 without spins; along the normal like m/2. Leapfrog with forces that know the
// velocity of the last half step is stable below k dt^2 + 2 g dt = 4 m; a quarter of that is left to particles with
// several contacts.
inline double largest_time_step(const Friction &c, double mass, double lever)
{
  const double along = 0.5 * mass / lever, across = 0.5 * mass;
  const double rubs =
      c.mu > 0.0 ? along / (c.gt + std::sqrt(c.gt * c.gt + c.kt * along)) : INFINITY;
  return std::min(rubs, 0.5 * across / c.gn);
}

}    // namespace deformable

#endif
