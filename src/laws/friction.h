// Friction and damping of one contact: what a step does to its spring, and what it loses.

#ifndef DEFORMABLE_FRICTION_H
#define DEFORMABLE_FRICTION_H

#include "laws/parameter_rules.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace deformable {

// The spring along the contact has the length xi and the stiffness kt, beside it is a dashpot gt; another one, gn, is along
// the normal. Coulomb's coefficient mu may be infinite.
struct Friction {
  double mu = 0.0, kt = 0.0, gt = 0.0, gn = 0.0;
};

inline std::string invalid_friction(const Friction &c)
{
  if (!(c.mu >= 0.0)) return "mu must be 0, positive or inf, not " + shown_number(c.mu);
  const auto finite = [](double value) { return value >= 0.0 && std::isfinite(value); };
  if (!finite(c.kt)) return "kt must be 0 or positive and finite, not " + shown_number(c.kt);
  if (!finite(c.gt)) return "gt must be 0 or positive and finite, not " + shown_number(c.gt);
  if (!finite(c.gn)) return "damp must be 0 or positive and finite, not " + shown_number(c.gn);
  return "";
}

// A film that is pulled does not rub.
inline double most_friction(double mu, double force)
{
  return force > 0.0 ? mu * force : 0.0;
}

struct Rub {
  double xi, force;
  bool slides;
};

// After a step dt in which the two sides have moved by `way` along the contact, which is pressed by `normal` now:
//   f = kt xi + gt dxi/dt,   dxi/dt = way/dt   held to |f| <= mu normal. Where it slides, dxi/dt = (f - kt xi)/gt,
// implicit in xi, so that xi = f/kt without a dashpot.
inline Rub rub(const Friction &c, double xi, double way, double dt, double normal)
{
  const double most = most_friction(c.mu, normal), force = c.kt * (xi + way) + c.gt * way / dt;
  if (std::fabs(force) <= most) return {xi + way, force, false};
  const double held = std::copysign(most, force), stiff = c.gt + c.kt * dt;
  return {(c.gt * xi + dt * held) / stiff, held, true};
}

// Along the normal, positive where the sides separate: f_d = gn way/dt, never more than what presses.
inline double damping(double gn, double way, double dt, double normal)
{
  return std::min(gn * way / dt, std::max(normal, 0.0));
}

// What a step loses by sliding and in the dashpot. From the mean force F of both ends and the change of xi, the work F way
// is that on the spring, kt (xi_1^2 - xi_0^2)/2, and
//   F (way - (xi_1 - xi_0))   and   (F - kt (xi_0 + xi_1)/2) (xi_1 - xi_0)
struct RubLoss {
  double sliding, dashpot;
};

inline RubLoss loss(double kt, const Rub &before, const Rub &now, double way)
{
  const double mean = 0.5 * (before.force + now.force), change = now.xi - before.xi;
  return {mean * (way - change), (mean - 0.5 * kt * (before.xi + now.xi)) * change};
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
