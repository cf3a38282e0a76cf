// The outline of a ring whose contacts are arcs, for pictures: a closed polygon as in outline.h.

#ifndef DEFORMABLE_CURVED_OUTLINE_H
#define DEFORMABLE_CURVED_OUTLINE_H

#include "response/outline.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace deformable {

// A contact as its ring sees it, see contact_curve.h: its direction, L, and b, positive where the arc is convex. And the
// angle at which the outline meets it, see contact_film.h; then L may be negative.
struct CurvedContact {
  double angle, length, half_angle, contact_angle;

  // from the direction of the contact to that of the free outline's normal at its end
  double turn() const { return contact_angle + half_angle; }
};

// The outline between two contacts goes from the direction of the first one plus its turn to that of the second one minus
// its turn, with the support function H = E - sum L G; where the turn is negative that function goes on beyond the contact.
// The ends of a contact are those of the chord of contact_film.h, which is the same one for both its particles: away from
// rest, where a ring has a first harmonic, the outline is shifted there by a little. An arc joins them. radius: E.
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
  struct Chord {
    Point end[2];    // counterclockwise
  };
  double mean_radius = radius;    // of the free outline
  for (const CurvedContact &c : contacts) mean_radius -= c.length / (2.0 * PI);
  const auto chord_of = [&](const CurvedContact &contact) {
    double height = radius - mean_radius * (1.0 - std::cos(contact.turn())), along = 0.0;
    for (const CurvedContact &other : contacts) {
      const double t = std::remainder(contact.angle - other.angle, 2.0 * PI), size = std::fabs(t);
      const double sine = std::sin(size), cosine = std::cos(size);
      height -= other.length * green(size, sine, cosine);
      if (&other != &contact)
        along -= (t < 0.0 ? -1.0 : 1.0) * other.length * d_green(size, sine, cosine);
    }
    const double half = 0.5 * contact.length + mean_radius * std::sin(contact.turn());
    const double c = std::cos(contact.angle), d = std::sin(contact.angle);
    const auto point = [&](double x) { return Point{height * c - x * d, height * d + x * c}; };
    return Chord{{point(along - std::max(half, 0.0)), point(along + std::max(half, 0.0))}};
  };
  std::vector<Chord> chord;
  for (const CurvedContact &c : contacts) chord.push_back(chord_of(c));
  const auto begin_of = [&](int gap) { return contacts[gap].angle + contacts[gap].turn(); };
  const auto end_of = [&](int gap) {
    const int next = gap + 1 < n ? gap + 1 : 0;
    return contacts[next].angle - contacts[next].turn() + (next == 0 ? 2.0 * PI : 0.0);
  };

  for (int gap = 0; gap < n; ++gap) {
    const double from = begin_of(gap), to = end_of(gap);
    const Chords chords = chords_of(std::max(to - from, 0.0), points, outline.same_area);
    const int next = gap + 1 < n ? gap + 1 : 0;
    const Point begin = chord[gap].end[1], end = chord[next].end[0];
    const Point first = free_point(gap, from, 1.0), last = free_point(gap, to, 1.0);
    outline.add(begin.x, begin.y);
    for (int m = 1; m < chords.count; ++m) {
      const double part = static_cast<double>(m) / chords.count, rest = 1.0 - part;
      const Point p = free_point(gap, from + (to - from) * part, chords.stretch);
      outline.add(p.x + rest * (begin.x - first.x) + part * (end.x - last.x),
                  p.y + rest * (begin.y - first.y) + part * (end.y - last.y));
    }
    outline.add(end.x, end.y);
    // from the end of this gap to the begin of the next one
    const double b = contacts[next].half_angle, theta = contacts[next].angle;
    const int parts =
        std::fabs(b) < STRAIGHT ? 1 : std::max(2, static_cast<int>(points * std::fabs(b) / PI));
    // chords cut off 1/parts^2 of the area of a flat arc
    const double stretch = outline.same_area && parts > 1 ? 1.0 + 1.0 / (parts * parts - 1.0) : 1.0;
    const Point one = chord[next].end[0], other = chord[next].end[1];
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
