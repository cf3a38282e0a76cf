// The outline of a ring whose contacts are arcs, for pictures: a closed polygon as in outline.h.

#ifndef DEFORMABLE_CURVED_OUTLINE_H
#define DEFORMABLE_CURVED_OUTLINE_H

#include "outline.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace deformable {

// A contact as its ring sees it, see contact_curve.h: its direction, L, and b, positive where the arc is convex.
struct CurvedContact {
  double angle, length, half_angle;
};

// The outline between two contacts goes from the direction theta + b of the first one to theta - b of the second one, with
// the support function H = E - sum L G; where b < 0 that function goes on beyond the contact. An arc joins the two ends
// of a contact, whose tangents it has there. radius: E.
inline void curved_outline(double radius, std::vector<CurvedContact> contacts, int points,
                           Outline &outline)
{
  constexpr double STRAIGHT = 1e-5;
  const int n = static_cast<int>(contacts.size());
  if (n == 0) return circle_outline(radius, points, outline);
  std::sort(contacts.begin(), contacts.end(),
            [](const CurvedContact &a, const CurvedContact &b) { return a.angle < b.angle; });
  struct Point {
    double x, y;
  };
  const auto free_point = [&](int gap, double theta, double stretch) {
    Support s = {radius, 0.0, radius};
    for (int k = 0; k < n; ++k) {
      const double t = theta - contacts[k].angle + (k > gap ? 2.0 * PI : 0.0);
      const double length = contacts[k].length, sine = std::sin(t), cosine = std::cos(t);
      s.height -= length * green(t, sine, cosine);
      s.d_height -= length * d_green(t, sine, cosine);
      s.curvature_radius -= length * (0.5 + cosine) / PI;
    }
    const double height = s.height + (stretch - 1.0) * s.curvature_radius;
    const double c = std::cos(theta), d = std::sin(theta);
    return Point{height * c - s.d_height * d, height * d + s.d_height * c};
  };
  const auto begin_of = [&](int gap) { return contacts[gap].angle + contacts[gap].half_angle; };
  const auto end_of = [&](int gap) {
    const int next = gap + 1 < n ? gap + 1 : 0;
    return contacts[next].angle - contacts[next].half_angle + (next == 0 ? 2.0 * PI : 0.0);
  };

  for (int gap = 0; gap < n; ++gap) {
    const double from = begin_of(gap), to = end_of(gap);
    const Chords chords = chords_of(std::max(to - from, 0.0), points, outline.same_area);
    for (int m = 0; m <= chords.count; ++m) {
      const bool is_end = m == 0 || m == chords.count;
      const Point p =
          free_point(gap, from + (to - from) * m / chords.count, is_end ? 1.0 : chords.stretch);
      outline.add(p.x, p.y);
    }
    // from the end of this gap to the begin of the next one
    const int next = gap + 1 < n ? gap + 1 : 0;
    const double b = contacts[next].half_angle, theta = contacts[next].angle;
    const int parts =
        std::fabs(b) < STRAIGHT ? 1 : std::max(2, static_cast<int>(points * std::fabs(b) / PI));
    // chords cut off 1/parts^2 of the area of a flat arc
    const double stretch = outline.same_area && parts > 1 ? 1.0 + 1.0 / (parts * parts - 1.0) : 1.0;
    const Point one = free_point(gap, to, 1.0), other = free_point(next, begin_of(next), 1.0);
    const double per_sine =
        parts > 1 ? 0.5 * std::hypot(other.x - one.x, other.y - one.y) / std::sin(std::fabs(b))
                  : 0.0;
    for (int m = 1; m < parts; ++m) {
      const double psi = b * (2.0 * m / parts - 1.0), sagitta = std::cos(psi) - std::cos(b);
      const double out = stretch * std::copysign(per_sine, b) * sagitta;
      const double part = 0.5 * (1.0 + std::sin(psi) / std::sin(b));
      outline.add(one.x + part * (other.x - one.x) + out * std::cos(theta),
                  one.y + part * (other.y - one.y) + out * std::sin(theta));
    }
  }
}

}    // namespace deformable

#endif
