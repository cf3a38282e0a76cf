// The outline of a ring by its support function.

#ifndef DEFORMABLE_SUPPORT_H
#define DEFORMABLE_SUPPORT_H

#include "green.h"
#include "shape.h"

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
  for (int c = 0; c < contacts.size; ++c) {
    const double length = shape.contact[c].length;
    if (length == 0.0) continue;
    double t = std::remainder(theta - contacts[c].angle, 2.0 * PI);
    const double sign = t < 0.0 ? -1.0 : 1.0;
    t = std::fabs(t);
    const double sine = std::sin(t), cosine = std::cos(t);
    support.height -= length * green(t, sine, cosine);
    support.d_height -= length * sign * d_green(t, sine, cosine);
    support.curvature_radius -= length * (0.5 + cosine) / PI;
  }
  return support;
}

// Largest H - R: how far the outline bulges out of the undeformed circle. Newton's method for H' = 0, with
// H'' = rho - H, starts from the best of 48 directions.
inline double ring_bulge(double radius, const Contacts &contacts, const Shape &shape)
{
  constexpr int SAMPLES = 48;
  double best = 0.0, at = 0.0;
  for (int k = 0; k < SAMPLES; ++k) {
    const double theta = 2.0 * PI * k / SAMPLES;
    const double height = ring_support(radius, contacts, shape, theta).height - radius;
    if (height > best) {
      best = height;
      at = theta;
    }
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

// An upper bound of ring_bulge that is cheap: -sum L min G.
inline double ring_bulge_at_most(const Contacts &contacts, const Shape &shape)
{
  constexpr double LEAST_GREEN = -0.10199;    // at 1.305
  double length = 0.0;
  for (int c = 0; c < contacts.size; ++c) length += shape.contact[c].length;
  return -LEAST_GREEN * length;
}

}    // namespace deformable

#endif
