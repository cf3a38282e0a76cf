// The outline for pictures, for other programs and for the comparison of shapes: a closed polygon about the
// center of the particle, counterclockwise. Every point is exact; or the ends of contacts are, and the points on
// arcs lie so much outside, by 1e-4 of the radius where 180 make a turn, that the polygon has the outline's area.

#ifndef DEFORMABLE_OUTLINE_H
#define DEFORMABLE_OUTLINE_H

#include "laws/sector.h"
#include "laws/support.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace deformable {

// The line from a point to the next one.
struct Piece {
  int contact;    // index of the contact that it is part of, or FREE
  double turn;    // from the direction of the outline's normal at its begin to that at its end
};

struct Outline {
  static constexpr int FREE = -1;
  bool same_area = false;
  std::vector<double> xy = {};    // x0 y0 x1 y1 ...
  std::vector<Piece> pieces = {};
  void add(double x, double y, const Piece &piece)
  {
    xy.push_back(x);
    xy.push_back(y);
    pieces.push_back(piece);
  }
};

// The chords of an arc, and the distance of its inner points from its center over its radius. For the area of the
// arc, n triangles of the angle d have (n - 2) g^2 + 2 g = n d / sin d, as the two ends stay where they are.
struct Chords {
  int count;
  double stretch;
};

inline Chords chords_of(double opening, int points, bool same_area)
{
  const int n = static_cast<int>(points * opening / (2.0 * PI));
  if (!same_area) return {std::max(1, n), 1.0};
  if (opening < 1e-5) return {1, 1.0};    // cuts off nothing, opening^3/12
  const int count = std::max(2, n);
  const double filled = opening / std::sin(opening / count);
  return {count, filled / (1.0 + std::sqrt(1.0 + (count - 2) * filled))};
}

inline void circle_outline(double radius, int points, Outline &outline)
{
  points = std::max(points, 3);
  const double d = 2.0 * PI / points,
               stretch = outline.same_area ? std::sqrt(d / std::sin(d)) : 1.0;
  for (int k = 0; k < points; ++k) {
    const double theta = 2.0 * PI * k / points;
    outline.add(stretch * radius * std::cos(theta), stretch * radius * std::sin(theta),
                {Outline::FREE, d});
  }
}

// x(theta) = H n + H' t. At an active contact H' jumps by L: the outline is straight there, and both ends
// of the contact are points of it.
inline void ring_outline(double radius, const Contacts &contacts, const Shape &shape, int *order,
                         int points, Outline &outline)
{
  const auto point = [&](double theta, double slope_correction, double stretch,
                         const Piece &piece) {
    const Support support = ring_support(radius, contacts, shape, theta);
    const double c = std::cos(theta), s = std::sin(theta);
    const double height = support.height + (stretch - 1.0) * support.curvature_radius;
    const double slope = support.d_height + slope_correction;
    outline.add(height * c - slope * s, height * s + slope * c, piece);
  };
  sort_by_angle(contacts, order);
  std::vector<int> active;
  for (int k = 0; k < contacts.size; ++k)
    if (shape.contact[order[k]].length > 0.0) active.push_back(order[k]);
  if (active.empty()) return circle_outline(radius, points, outline);

  for (std::size_t k = 0; k < active.size(); ++k) {
    const int i = active[k], next = active[k + 1 < active.size() ? k + 1 : 0];
    const double from = contacts[i].angle;
    const double to = contacts[next].angle + (k + 1 < active.size() ? 0.0 : 2.0 * PI);
    // at the contact itself ring_support takes t = 0+: H' is that behind the contact
    point(from, -shape.contact[i].length, 1.0, {i, 0.0});
    const Chords chords = chords_of(to - from, points, outline.same_area);
    const Piece chord = {Outline::FREE, (to - from) / chords.count};
    point(from, 0.0, 1.0, chord);
    for (int m = 1; m < chords.count; ++m)
      point(from + (to - from) * m / chords.count, 0.0, chords.stretch, chord);
  }
}

// One arc of a sector law: its center relative to that of the circle, its radius, and the directions of its
// normals from beginning to end, counterclockwise. Straight flats join the arcs to the outline.
struct Arc {
  double x, y, radius, from, to;
};

// From the foot of contact i, the center of the arc is l_i along the line and q inwards.
inline Arc sector_arc(double radius, const Contact &i, const Opening &o, const Sector &part)
{
  const double inward = part.shrinkage - i.indentation;
  return {inward * i.nx - part.length_i * i.ny, inward * i.ny + part.length_i * i.nx,
          radius - part.shrinkage, i.angle, i.angle + o.angle};
}

// next: the contact behind the arc
inline void arc_outline(const Arc &arc, int points, Outline &outline, int next = Outline::FREE)
{
  const double opening = arc.to - arc.from;
  const Chords chords = chords_of(opening, points, outline.same_area);
  for (int m = 0; m <= chords.count; ++m) {
    const double theta = arc.from + opening * m / chords.count;
    const bool is_end = m == 0 || m == chords.count;
    const double radius = is_end ? arc.radius : chords.stretch * arc.radius;
    outline.add(arc.x + radius * std::cos(theta), arc.y + radius * std::sin(theta),
                m == chords.count ? Piece{next, 0.0}
                                  : Piece{Outline::FREE, opening / chords.count});
  }
}

template <class SectorOf>
void sector_outline(double radius, const Contacts &contacts, int *order, int points,
                    Outline &outline, SectorOf &&sector_of)
{
  if (contacts.size < 2) return circle_outline(radius, points, outline);
  sort_by_angle(contacts, order);
  for_each_sector(contacts, order, [&](int, int i, int k, const Opening &o) {
    const Sector part = sector_of(o, contacts[i].indentation, contacts[k].indentation);
    arc_outline(sector_arc(radius, contacts[i], o, part), points, outline, k);
  });
}

// A contact that is an arc, as its ring sees it (contact_curve.h): its direction, L, and b, positive where the arc is convex. And the
// angle at which the outline meets it; then L may be negative.
struct CurvedContact {
  double angle, length, half_angle, contact_angle;
  int index = 0;    // of the caller

  // from the direction of the contact to that of the free outline's normal at its end
  double turn() const { return contact_angle + half_angle; }
};

// The outline of a ring whose contacts are arcs. radius: E.
//
// Between two contacts it goes from the direction of the first one plus its turn to that of the second one minus its turn, with the
// support function H = E - sum L G; where the turn is negative that function goes on beyond the contact. The ends of a contact are
// those of the chord of contact_curve.h, which is the same one for both its particles: away from rest, where a ring has a first
// harmonic, the outline is shifted there by a little. An arc joins them.
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
    const Piece free_chord = {Outline::FREE, std::max(to - from, 0.0) / chords.count};
    outline.add(begin.x, begin.y, free_chord);
    for (int m = 1; m < chords.count; ++m) {
      const double part = static_cast<double>(m) / chords.count, rest = 1.0 - part;
      const Point p = free_point(gap, from + (to - from) * part, chords.stretch);
      outline.add(p.x + rest * (begin.x - first.x) + part * (end.x - last.x),
                  p.y + rest * (begin.y - first.y) + part * (end.y - last.y), free_chord);
    }
    // from the end of this gap to the begin of the next one
    const double b = contacts[next].half_angle, theta = contacts[next].angle;
    const int parts =
        std::fabs(b) < STRAIGHT ? 1 : std::max(2, static_cast<int>(points * std::fabs(b) / PI));
    // chords cut off 1/parts^2 of the area of a flat arc
    const Piece part_of_contact = {contacts[next].index, 2.0 * b / parts};
    outline.add(end.x, end.y, part_of_contact);
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
                  one.y + part * (other.y - one.y) + out * std::sin(theta), part_of_contact);
    }
  }
}

}    // namespace deformable

#endif
