// The outline for pictures and for the comparison of shapes: a closed polygon about the center of the
// particle, counterclockwise, with every point exact.

#ifndef DEFORMABLE_OUTLINE_H
#define DEFORMABLE_OUTLINE_H

#include "sector.h"
#include "support.h"

namespace deformable {

struct Outline {
  std::vector<double> xy;    // x0 y0 x1 y1 ...
  void add(double x, double y)
  {
    xy.push_back(x);
    xy.push_back(y);
  }
};

inline void circle_outline(double radius, int points, Outline &outline)
{
  for (int k = 0; k < points; ++k) {
    const double theta = 2.0 * PI * k / points;
    outline.add(radius * std::cos(theta), radius * std::sin(theta));
  }
}

// x(theta) = H n + H' t. At an active contact H' jumps by L: the outline is straight there, and both ends
// of the contact are points of it.
inline void ring_outline(double radius, const Contacts &contacts, const Shape &shape, int *order,
                         int points, Outline &outline)
{
  const auto point = [&](double theta, double slope_correction) {
    const Support support = ring_support(radius, contacts, shape, theta);
    const double c = std::cos(theta), s = std::sin(theta);
    const double slope = support.d_height + slope_correction;
    outline.add(support.height * c - slope * s, support.height * s + slope * c);
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
    point(from, -shape.contact[i].length);
    point(from, 0.0);
    const int inner = std::max(1, static_cast<int>(points * (to - from) / (2.0 * PI)));
    for (int m = 1; m < inner; ++m) point(from + (to - from) * m / inner, 0.0);
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
  const int inner = std::max(1, static_cast<int>(points * opening / (2.0 * PI)));
  for (int m = 0; m <= inner; ++m) {
    const double theta = arc.from + opening * m / inner;
    outline.add(arc.x + arc.radius * std::cos(theta), arc.y + arc.radius * std::sin(theta));
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
