// The outline of a ring by its support function.

#ifndef DEFORMABLE_SUPPORT_H
#define DEFORMABLE_SUPPORT_H

#include "laws/green.h"
#include "laws/shape.h"

#include <algorithm>

namespace deformable {

// The outline's support function in one direction:
//   H = R - sum L G,  H' = -sum L G',  rho = H + H'' = q - (1/pi) sum L cos   (between contacts)
struct Support {
  double height, d_height, curvature_radius;
};

inline Support ring_support(double radius, const Contacts &contacts, const Shape &shape,
                            double theta)
{
  Support support = {radius, 0.0, radius};
  const double x = std::cos(theta), y = std::sin(theta);
  for (int c = 0; c < contacts.size; ++c) {
    const double length = shape.contact[c].length;
    if (length == 0.0) continue;
    const Contact &at = contacts[c];
    const double turns = std::floor((theta - at.angle) / (2.0 * PI));
    const double t = theta - at.angle - 2.0 * PI * turns;
    const double sine = at.nx * y - at.ny * x, cosine = at.nx * x + at.ny * y;
    support.height -= length * green(t, sine, cosine);
    support.d_height -= length * d_green(t, sine, cosine);
    support.curvature_radius -= length * (0.5 + cosine) / PI;
  }
  return support;
}

// Largest H - R: how far the outline bulges out of the undeformed circle. Newton's method for H' = 0, with
// H'' = rho - H, starts from the best of 48 directions.
inline double ring_bulge(double radius, const Contacts &contacts, const Shape &shape)
{
  constexpr int SAMPLES = 48;
  struct Sample {
    double theta[SAMPLES], x[SAMPLES], y[SAMPLES];
    Sample()
    {
      for (int k = 0; k < SAMPLES; ++k) {
        theta[k] = 2.0 * PI * k / SAMPLES;
        x[k] = std::cos(theta[k]);
        y[k] = std::sin(theta[k]);
      }
    }
  };
  static const Sample of;
  double bulge[SAMPLES] = {};
  for (int c = 0; c < contacts.size; ++c) {
    const double length = shape.contact[c].length;
    const Contact at = contacts[c];
    const double angle = std::remainder(at.angle, 2.0 * PI);
    for (int k = 0; k < SAMPLES; ++k) {
      double t = of.theta[k] - angle;
      t += t < 0.0 ? 2.0 * PI : t >= 2.0 * PI ? -2.0 * PI : 0.0;
      const double sine = at.nx * of.y[k] - at.ny * of.x[k];
      const double cosine = at.nx * of.x[k] + at.ny * of.y[k];
      bulge[k] -= length * green(t, sine, cosine);
    }
  }
  double best = 0.0, at = 0.0;
  for (int k = 0; k < SAMPLES; ++k)
    if (bulge[k] > best) {
      best = bulge[k];
      at = of.theta[k];
    }
  if (best == 0.0) return 0.0;
  for (int step = 0; step < 4; ++step) {
    const Support support = ring_support(radius, contacts, shape, at);
    best = std::max(best, support.height - radius);
    const double second = support.curvature_radius - support.height;
    if (second >= 0.0) break;
    at -= support.d_height / second;
  }
  return best;
}

constexpr double LEAST_GREEN = -0.10199;    // at 1.305

// An upper bound of ring_bulge that is cheap: -sum L min G.
inline double ring_bulge_at_most(const Contacts &contacts, const Shape &shape)
{
  double length = 0.0;
  for (int c = 0; c < contacts.size; ++c) length += shape.contact[c].length;
  return -LEAST_GREEN * length;
}

}    // namespace deformable

#endif
