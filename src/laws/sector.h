// The sector law: contacts stick, so that each sector between two contacts keeps its own share of the
// conserved perimeter or area.
//
// R. Maharana, "Efficient Simulation of Deformable Particles"; docs/theory/sector.md has the formulas below, docs/theory.md the
// corrections of those of the paper.

#ifndef DEFORMABLE_SECTOR_H
#define DEFORMABLE_SECTOR_H

#include "laws/shape.h"
#include "laws/trigonometry.h"

namespace deformable {

// The angle between two neighboring contacts, and its complement to a full turn. The formulas are singular at
// both ends, where 2 pi - phi would lose digits.
struct Opening {
  double angle;         // phi, in (0, 2 pi)
  double complement;    // 2 pi - phi
  double sine, cosine;
};

// Sorts `order`, a permutation of the contacts' indices, by rising angle. Insertion is fast here: a particle
// has few contacts, and the order of the previous step is a good guess.
inline void sort_by_angle(const Contacts &contacts, int *order)
{
  for (int k = 1; k < contacts.size; ++k) {
    const int c = order[k];
    int at = k;
    for (; at > 0 && contacts[order[at - 1]].angle > contacts[c].angle; --at)
      order[at] = order[at - 1];
    order[at] = c;
  }
}

// Calls visit(s, i, k, opening) for the sector from the s-th contact i by angle to the next one k, with
// `order` as sort_by_angle leaves it.
template <class Visitor>
void for_each_sector(const Contacts &contacts, const int *order, Visitor &&visit)
{
  for (int s = 0; s < contacts.size; ++s) {
    const bool last = s + 1 == contacts.size;
    const int i = order[s], k = order[last ? 0 : s + 1];
    const double difference = contacts[k].angle - contacts[i].angle;
    const double angle = last ? 2.0 * PI + difference : difference;
    const double complement = last ? -difference : 2.0 * PI - difference;
    visit(s, i, k,
          Opening{angle, complement,
                  contacts[i].nx * contacts[k].ny - contacts[i].ny * contacts[k].nx,
                  contacts[i].nx * contacts[k].nx + contacts[i].ny * contacts[k].ny});
  }
}

// With D = 2 - 2 cos phi - phi sin phi:
//   alpha = (sin phi - phi cos phi)/D,  beta = (phi - sin phi)/D,  gamma = (1 - cos phi)/D
template <class T> struct SectorCoefficients {
  T alpha, beta, gamma;
};

inline SectorCoefficients<double> sector_coefficients(const Opening &o)
{
  const double phi = o.angle;
  if (phi < 0.5) {    // D ~ phi^4/12 loses digits: the powers of phi are taken out of every term
    const double x2 = phi * phi, per_phi = 1.0 / phi;
    const double per_d = per_phi / taylor::TWO_VERSINES_MINUS_X_SINE(x2);
    return {taylor::SINE_MINUS_X_COSINE(x2) * per_d, taylor::X_MINUS_SINE(x2) * per_d,
            taylor::VERSINE(x2) * per_d * per_phi};
  }
  double sine = o.sine, cosine = o.cosine, versine = 1.0 - cosine;
  // D ~ 2 pi e with the complement e: sin e must be accurate relative to e
  if (o.complement < 1.0) {
    sine = -std::sin(o.complement);
    cosine = std::cos(o.complement);
    versine = sine * sine / (1.0 + cosine);
  }
  const double per_d = 1.0 / (2.0 * versine - phi * sine);
  return {(sine - phi * cosine) * per_d, (phi - sine) * per_d, versine * per_d};
}

// One sector, between contacts i and k.
template <class T> struct SectorPart {
  T length_i, length_k;    // the parts of the two contacts on this side of their feet
  T shrinkage;             // R - q, q the radius of the arc
};
using Sector = SectorPart<double>;

template <class T>
DEFORMABLE_INLINE SectorPart<T> sector(const SectorCoefficients<T> &w, T ai, T ak)
{
  return {w.alpha * ai + w.beta * ak, w.beta * ai + w.alpha * ak, (ai + ak) * w.gamma};
}

// Each sector keeps its perimeter R phi (kP >> kA):
//   l_i = alpha a_i + beta a_k,  R - q = (a_i + a_k) gamma
//   S = 1/2 sum a l,  dS/da_i = l_i,  dS/dphi = 1/2 [a_i (2 (R - q) - a_i) - l_i^2], the same with a_k, l_k
// Two contacts in one direction leave no shape: the area deficit is then not finite.
inline void sector_shape(double radius, const Contacts &contacts, int *order, Shape &shape)
{
  if (contacts.size < 2) return shape.circle(contacts.size, radius);    // no sector
  shape.reset(contacts.size, radius);
  sort_by_angle(contacts, order);
  // The contribution of a sector to its second contact waits for that of the next sector.
  double length_before = 0.0, d_before = 0.0, twice_deficit = 0.0, shrinkage = 0.0;
  for_each_sector(contacts, order, [&](int, int i, int k, const Opening &o) {
    const double ai = contacts[i].indentation;
    const Sector part = sector(sector_coefficients(o), ai, contacts[k].indentation);
    const double d_opening =
        0.5 * (ai * (2.0 * part.shrinkage - ai) - part.length_i * part.length_i);
    const double length = length_before + part.length_i;
    shape.contact[i] = {length, length, d_before - d_opening};
    twice_deficit += ai * length;
    shrinkage = std::max(shrinkage, part.shrinkage);
    length_before = part.length_k;
    d_before = d_opening;
  });
  Response &first = shape.contact[order[0]];
  first = {first.length + length_before, first.length + length_before, first.d_angle + d_before};
  shape.area_deficit = 0.5 * (twice_deficit + contacts[order[0]].indentation * length_before);
  shape.arc_radius = radius - shrinkage;
}

// The tangent arc of a sector that keeps its area R^2 phi/2, and the excess of its perimeter. With
// s, c = sin, cos of phi/2, T = s - c phi/2, m the mean and delta half the difference of the heights h,
// b the mean indentation:
//   q^2 T = m^2 s - delta^2 c^2/s - R^2 c phi/2
//   mu = (m - q)/c = [delta^2 c/s + phi b (2 R - b)/2] / (T (m + q))       (finite at phi = pi)
//   l_i = s mu + delta c/s,  l_k = s mu - delta c/s
//   P - R phi = [2 delta^2 c/s + phi b (b + c mu)] / (m + q)
struct AreaSector {
  Sector part;
  double perimeter_excess;
  bool exists;    // q^2 > 0
};

inline AreaSector area_sector(double radius, const Opening &o, double ai, double ak)
{
  const bool reflex = o.angle > PI;
  const double half = 0.5 * o.angle, smaller_half = reflex ? 0.5 * o.complement : half;
  const double s = std::sin(smaller_half);
  const double c = reflex ? -std::cos(smaller_half) : std::cos(smaller_half);
  const double t = sine_minus_x_cosine(half, s, c);
  const double b = 0.5 * (ai + ak), m = radius - b, delta = 0.5 * (ai - ak);
  const double slant = delta * c / s;    // = (h_k - h_i)/2 cot(phi/2)

  const double q2 = (m * m * s - slant * slant * s - radius * radius * c * half) / t;
  if (!(q2 > 0.0)) return {{0.0, 0.0, 0.0}, 0.0, false};
  const double q = std::sqrt(q2);
  const double mu = (delta * slant + half * b * (2.0 * radius - b)) / (t * (m + q));
  const double shrinkage = b + c * mu;
  return {{s * mu + slant, s * mu - slant, shrinkage},
          (2.0 * delta * slant + o.angle * b * shrinkage) / (m + q),
          true};
}

// Each sector keeps its area (kA >> kP); the perimeter changes:
//   dP/da_i = l_i/q,  dP/dphi = R + [a_i (2 (R - q) - a_i) - l_i^2]/2q
// Returns false where such a sector does not exist; the shape is then unspecified.
inline bool area_sector_shape(double radius, const Contacts &contacts, int *order, Shape &shape)
{
  shape.circle(contacts.size, radius);
  if (contacts.size < 2) return true;
  sort_by_angle(contacts, order);
  bool exists = true;
  for_each_sector(contacts, order, [&](int, int i, int k, const Opening &o) {
    const double ai = contacts[i].indentation;
    const AreaSector a = area_sector(radius, o, ai, contacts[k].indentation);
    exists = exists && a.exists;
    if (!a.exists) return;
    const double q = radius - a.part.shrinkage, li = a.part.length_i, lk = a.part.length_k;
    // without the R of dP/dphi, which cancels between the two sectors of a contact
    const double d_opening = (ai * (2.0 * a.part.shrinkage - ai) - li * li) / (2.0 * q);

    Response &at_i = shape.contact[i], &at_k = shape.contact[k];
    at_i.length += li;
    at_i.d_indentation += li / q;
    at_i.d_angle -= d_opening;
    at_k.length += lk;
    at_k.d_indentation += lk / q;
    at_k.d_angle += d_opening;
    shape.perimeter_excess += a.perimeter_excess;
    shape.arc_radius = std::min(shape.arc_radius, q);
  });
  return exists;
}

}    // namespace deformable

#endif
