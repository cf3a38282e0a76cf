// Input and output of a contact law for one particle.

#ifndef DEFORMABLE_SHAPE_H
#define DEFORMABLE_SHAPE_H

#include <cstddef>
#include <vector>

namespace deformable {

// A flat contact of a particle.
struct Contact {
  double angle;          // theta: direction from the center to the contact line
  double nx, ny;         // (cos theta, sin theta)
  double indentation;    // a = R - h; negative: the line is outside of the circle
};

// All contacts of one particle, a view of an array. Angles lie within one turn: the largest minus the
// smallest is 2 pi at most.
struct Contacts {
  int size;
  const Contact *first;
  const Contact &operator[](int c) const { return first[c]; }
};

// Length of one contact, and the derivatives of the quantity that the law lets change: of the area deficit
// where it conserves the perimeter, of the perimeter excess where it conserves the area.
struct Response {
  double length;
  double d_indentation, d_angle;
};

// The result of a contact law for one particle; contacts are in the order of the input. The memory only grows,
// so that a force loop with one Shape for all particles allocates nothing.
struct Shape {
  double area_deficit = 0.0;        // S = A0 - A
  double perimeter_excess = 0.0;    // P - P0
  double arc_radius = 0.0;          // smallest radius of curvature; negative: beyond the model
  std::vector<Response> contact;

  // Memory for the contacts, which the law fills in.
  void reset(int contacts, double radius)
  {
    if (static_cast<std::size_t>(contacts) > contact.size()) contact.resize(contacts);
    area_deficit = perimeter_excess = 0.0;
    arc_radius = radius;
  }

  // A circle without deformation.
  void circle(int contacts, double radius)
  {
    reset(contacts, radius);
    for (int c = 0; c < contacts; ++c) contact[c] = {0.0, 0.0, 0.0};
  }
};

}    // namespace deformable

#endif
