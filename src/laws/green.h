// The Green function of the ring law.

#ifndef DEFORMABLE_GREEN_H
#define DEFORMABLE_GREEN_H

#include "laws/trigonometry.h"

namespace deformable {

// T is double, or a vector of doubles of several particles.

// Green function of -u'' - u on the angular modes n >= 2, for 0 <= t <= 2 pi; even and 2 pi periodic:
//   G(t) = [1/2 + cos t/4 - (pi - t) sin t/2]/pi
template <class T> DEFORMABLE_INLINE T green(T t, T sine, T cosine)
{
  return (0.5 + 0.25 * cosine - 0.5 * (PI - t) * sine) * (1.0 / PI);
}

// dG/dt, 0 < t < 2 pi; odd, with a jump of -1 at t = 0
template <class T> DEFORMABLE_INLINE T d_green(T t, T sine, T cosine)
{
  return (0.25 * sine - 0.5 * (PI - t) * cosine) * (1.0 / PI);
}

// d^2G/dt^2, 0 < t < 2 pi; even
template <class T> DEFORMABLE_INLINE T dd_green(T t, T sine, T cosine)
{
  return (0.75 * cosine + 0.5 * (PI - t) * sine) * (1.0 / PI);
}

constexpr double GREEN_AT_ZERO = 0.75 / PI;

// A quartic in cos t that nowhere exceeds G and is within 0.02 of it for |t| > 0.6. It is cheaper than G and
// sufficient for most contacts outside of the circle, which the outline is far from reaching.
template <class T> DEFORMABLE_INLINE T green_bound(T cosine)
{
  return -0.094792 +
         cosine * (-0.102549 + cosine * (0.106182 + cosine * (0.116296 + cosine * 0.081933)));
}

}    // namespace deformable

#endif
