// The contacts of particles side by side.

#ifndef DEFORMABLE_LANE_GEOMETRY_H
#define DEFORMABLE_LANE_GEOMETRY_H

#include "kernels/batch_kernels.h"
#include "kernels/lanes.h"
#include "laws/contact.h"
#include "laws/trigonometry.h"

namespace deformable::DEFORMABLE_LEVEL {

// A number of each particle, or of its m-th place.
DEFORMABLE_LANE_FUNCTION Lanes of_particles(BlockParticle *const *p, double BlockParticle::*member)
{
  return each_lane([&](int w) DEFORMABLE_LANE_LAMBDA { return p[w]->*member; });
}

DEFORMABLE_LANE_FUNCTION Lanes of_particles(BlockParticle *const *p, double Stiffness::*member)
{
  return each_lane([&](int w) DEFORMABLE_LANE_LAMBDA { return p[w]->stiffness.*member; });
}

DEFORMABLE_LANE_FUNCTION Lanes of_places(Place *const *at, int m, double Place::*member)
{
  return each_lane([&](int w) DEFORMABLE_LANE_LAMBDA { return at[w][m].*member; });
}

DEFORMABLE_LANE_FUNCTION void to_particles(BlockParticle *const *p, double BlockParticle::*member,
                                           Lanes x)
{
  for_each_lane([&](int w) DEFORMABLE_LANE_LAMBDA { p[w]->*member = x[w]; });
}

DEFORMABLE_LANE_FUNCTION void to_places(Place *const *at, int m, double Place::*member, Lanes x)
{
  for_each_lane([&](int w) DEFORMABLE_LANE_LAMBDA { at[w][m].*member = x[w]; });
}

struct DirectionLanes {
  Lanes nx, ny;
};

// Angles between two contacts of each particle: |t|, sin |t|, cos |t| and where t < 0.
struct AngleLanes {
  Mask negative;
  Lanes magnitude, sine, cosine;
};

DEFORMABLE_LANE_FUNCTION AngleLanes angles_between(Lanes from, const DirectionLanes &a, Lanes to,
                                                   const DirectionLanes &b)
{
  const Lanes difference = to - from, cross = a.nx * b.ny - a.ny * b.nx;
  const Mask negative = difference < 0.0;
  return {negative, magnitude(difference), select(negative, -cross, cross),
          a.nx * b.nx + a.ny * b.ny};
}

// A contact of each particle: its direction, and the indentation by the line on the radical axis.
struct LineLanes : DirectionLanes {
  Lanes per_distance, indentation, d_indentation;
};

DEFORMABLE_LANE_FUNCTION LineLanes contact_lines(Lanes dx, Lanes dy, Lanes radius,
                                                 Lanes partner_radius)
{
  const Lanes distance = root(dx * dx + dy * dy), per_distance = 1.0 / distance;
  const ContactLine<Lanes> line = contact_line(distance, per_distance, radius, partner_radius);
  return {
      {dx * per_distance, dy * per_distance}, per_distance, line.indentation, line.d_indentation};
}

// The force of a contact on the particle, from the derivatives of the energy by indentation and angle.
struct ForceLanes {
  Lanes x, y;
};

DEFORMABLE_LANE_FUNCTION ForceLanes force_of(const LineLanes &line, Lanes by_indentation,
                                             Lanes by_angle)
{
  const Lanes along = by_indentation * line.d_indentation, across = by_angle * line.per_distance;
  return {along * line.nx - across * line.ny, along * line.ny + across * line.nx};
}

DEFORMABLE_LANE_FUNCTION void set_outcome(BlockParticle *const *p, Mask which, Outcome outcome)
{
  if (!any(which)) return;
  for (int w = 0; w < W; ++w)
    if (which[w]) p[w]->outcome = outcome;
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
