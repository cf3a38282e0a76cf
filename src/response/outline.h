// The outline for pictures, for other programs and for the comparison of shapes: a closed polygon about the
// center of the particle, counterclockwise. Every point is exact; or the ends of contacts are, and the points on
// arcs lie so much outside, by 1e-4 of the radius where 180 make a turn, that the polygon has the outline's area.

#ifndef DEFORMABLE_OUTLINE_H
#define DEFORMABLE_OUTLINE_H

#include "laws/sector.h"
#include "laws/support.h"

namespace deformable {

struct Outline {
  bool same_area = false;
  std::vector<double> xy = {};    // x0 y0 x1 y1 ...
  void add(double x, double y)
  {
    xy.push_back(x);
    xy.push_back(y);
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
  const double d = 2.0 * PI / points,
               stretch = outline.same_area ? std::sqrt(d / std::sin(d)) : 1.0;
  for (int k = 0; k < points; ++k) {
    const double theta = 2.0 * PI * k / points;
    outline.add(stretch * radius * std::cos(theta), stretch * radius * std::sin(theta));
  }
}

// x(theta) = H n + H' t. At an active contact H' jumps by L: the outline is straight there, and both ends
// of the contact are points of it.
inline void ring_outline(double radius, const Contacts &contacts, const Shape &shape, int *order,
                         int points, Outline &outline)
{
  const auto point = [&](double theta, double slope_correction, double stretch) {
    const Support support = ring_support(radius, contacts, shape, theta);
    const double c = std::cos(theta), s = std::sin(theta);
    const double height = support.height + (stretch - 1.0) * support.curvature_radius;
    const double slope = support.d_height + slope_correction;
    outline.add(height * c - slope * s, height * s + slope * c);
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
    point(from, -shape.contact[i].length, 1.0);
    point(from, 0.0, 1.0);
    const Chords chords = chords_of(to - from, points, outline.same_area);
    for (int m = 1; m < chords.count; ++m)
      point(from + (to - from) * m / chords.count, 0.0, chords.stretch);
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

inline void arc_outline(const Arc &arc, int points, Outline &outline)
{
  const double opening = arc.to - arc.from;
  const Chords chords = chords_of(opening, points, outline.same_area);
  for (int m = 0; m <= chords.count; ++m) {
    const double theta = arc.from + opening * m / chords.count;
    const bool is_end = m == 0 || m == chords.count;
    const double radius = is_end ? arc.radius : chords.stretch * arc.radius;
    outline.add(arc.x + radius * std::cos(theta), arc.y + radius * std::sin(theta));
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
    arc_outline(sector_arc(radius, contacts[i], o, part), points, outline);
  });
}

}    // namespace deformable

#endif
