// What fix deformable/friction remembers of a contact.
//
// Of two particles the one with the smaller ID remembers. A contact is the same from both sides but for its directions: the
// spring keeps its sign.

#ifndef LMP_REMEMBERED_CONTACT_H
#define LMP_REMEMBERED_CONTACT_H

#include <algorithm>
#include <vector>

namespace LAMMPS_NS {

// A contact as the particle that remembers sees it.
struct ContactPlace {
  double x, y;      // center of the partner, from that of the particle; 0 for a wall
  double bx, by;    // middle of the contact
  double nx, ny;    // towards the partner

  ContactPlace from_partner() const { return {-x, -y, bx - x, by - y, -nx, -ny}; }
};

struct RememberedContact {
  double partner;    // ID, or the code < 0 of a wall
  double kt;
  ContactPlace place;
  double xi, force, damping;
  double one_side;    // the partner remembers a contact of its own
  double is_here;     // in this step
};

// The contact with this partner whose place is the nearest one, as a small box has several images of it; or null. Between a
// particle and its own image both directions are one.
inline RememberedContact *find_contact(std::vector<RememberedContact> &contacts, double partner,
                                       const ContactPlace &place, bool own_image)
{
  const auto square = [](double x, double y) { return x * x + y * y; };
  double nearest = square(place.x, place.y);
  RememberedContact *found = nullptr;
  for (RememberedContact &c : contacts) {
    if (c.partner != partner) continue;
    double distance = square(c.place.x - place.x, c.place.y - place.y);
    if (own_image) distance = std::min(distance, square(c.place.x + place.x, c.place.y + place.y));
    if (distance > nearest) continue;
    nearest = distance;
    found = &c;
  }
  return found;
}

}    // namespace LAMMPS_NS

#endif
