// The contact line of two circles on their radical axis.

#ifndef DEFORMABLE_CONTACT_H
#define DEFORMABLE_CONTACT_H

#include "laws/trigonometry.h"

namespace deformable {

// A line must lie in front of both centers by this part of the radius; then it does of the larger particle where it does of the smaller
// one. Where two centers, or a center and a thin wall, come nearer, they are about to pass each other, after which no line would be
// behind a center.
constexpr double NEAREST_LINE = 0.05;

// T is double, or a vector of doubles of several particles.
template <class T> struct ContactLine {
  T indentation;      // a_ij = R_i - h_ij, h_ij the distance from the center of i to the line
  T d_indentation;    // da/dd
};

// h_ij = (d^2 + R_i^2 - R_j^2)/2d. The indentation follows from the overlap o = R_i + R_j - d and not from
// R - h, because o keeps its digits for nearly touching particles: a_ij = o (2 R_j - o)/2d.
template <class T>
DEFORMABLE_INLINE ContactLine<T> contact_line(T distance, T per_distance, T radius_i, T radius_j)
{
  const T overlap = radius_i + radius_j - distance;
  const T factor = 0.5 * overlap * per_distance;
  const T skew = 0.5 * (radius_i - radius_j) * (radius_i + radius_j) * per_distance * per_distance;
  return {factor * (2.0 * radius_j - overlap), skew - 0.5};
}

}    // namespace deformable

#endif
