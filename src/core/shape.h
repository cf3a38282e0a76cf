// What goes into a contact law, and what comes out of it, for one particle.

#ifndef DEFORMABLE_SHAPE_H
#define DEFORMABLE_SHAPE_H

#include <cstddef>
#include <vector>

namespace deformable {

// A flat contact that presses on a particle.
struct Contact {
  double angle;          // theta: direction from the centre to the contact line
  double nx, ny;         // (cos theta, sin theta)
  double indentation;    // a = R - h; negative: the line is outside of the circle
};

// All contacts of one particle, a view of an array. Angles lie within one turn: the largest minus the
// smallest is below 2 pi.
struct Contacts {
  int size;
  const Contact *first;
  const Contact &operator[](int c) const { return first[c]; }
};

// The answer of a contact law. A law conserves either the perimeter or the area and lets the other one
// change: the derivatives are those of what changes, the area deficit or the perimeter excess. Buffers
// only ever grow, so that a force loop that keeps one Shape for all particles allocates nothing.
struct Shape {
  double area_deficit = 0.0;        // S = A0 - A
  double perimeter_excess = 0.0;    // P - P0
  double arc_radius = 0.0;          // smallest radius of curvature; negative: beyond the model
  std::vector<double> d_indentation;
  std::vector<double> d_angle;
  std::vector<double> contact_length;

  void clear(int contacts)
  {
    if (static_cast<std::size_t>(contacts) > d_indentation.size()) {
      d_indentation.resize(contacts);
      d_angle.resize(contacts);
      contact_length.resize(contacts);
    }
    area_deficit = perimeter_excess = 0.0;
    for (int c = 0; c < contacts; ++c) d_indentation[c] = d_angle[c] = contact_length[c] = 0.0;
  }
};

}    // namespace deformable

#endif
