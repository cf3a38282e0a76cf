// The outline itself, for pictures and for the comparison of shapes: a closed polygon about the
// particle's centre, counterclockwise, exact at each of its points.

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
    // ring_support sees t = 0 at the contact itself from above: H' is the one after the contact
    point(from, -shape.contact[i].length);
    point(from, 0.0);
    const int inner = std::max(1, static_cast<int>(points * (to - from) / (2.0 * PI)));
    for (int m = 1; m < inner; ++m) point(from + (to - from) * m / inner, 0.0);
  }
}

// Foot of contact i - end of its flat - arc about its centre - end of the flat of contact k. The centre of
// the arc: from the foot l_i along the line, then q inwards.
template <class SectorOf>
void sector_outline(double radius, const Contacts &contacts, int *order, int points,
                    Outline &outline, SectorOf &&sector_of)
{
  if (contacts.size < 2) return circle_outline(radius, points, outline);
  sort_by_angle(contacts, order);
  for_each_sector(contacts, order, [&](int, int i, int k, const Opening &o) {
    const Sector part = sector_of(o, contacts[i].indentation, contacts[k].indentation);
    const double q = radius - part.shrinkage, inward = part.shrinkage - contacts[i].indentation;
    const double nx = contacts[i].nx, ny = contacts[i].ny;
    const double x = inward * nx - part.length_i * ny, y = inward * ny + part.length_i * nx;
    const int inner = std::max(1, static_cast<int>(points * o.angle / (2.0 * PI)));
    for (int m = 0; m <= inner; ++m) {
      const double theta = contacts[i].angle + o.angle * m / inner;
      outline.add(x + q * std::cos(theta), y + q * std::sin(theta));
    }
  });
}

}    // namespace deformable

#endif
