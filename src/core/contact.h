// Where two circles meet: the contact line lies on their radical axis.

#ifndef DEFORMABLE_CONTACT_H
#define DEFORMABLE_CONTACT_H

namespace deformable {

struct ContactLine {
  double height;         // h: from the particle's centre to the line; negative: the line is behind it
  double indentation;    // a = R_i - h
  double d_indentation;  // da/dd
};

// h = (d^2 + R_i^2 - R_j^2)/2d. The indentation is taken from the overlap o = R_i + R_j - d and not from
// R_i - h, because o keeps its digits for nearly touching particles: a = o (2 R_j - o)/2d.
inline ContactLine contact_line(double distance, double per_distance, double radius_i, double radius_j)
{
  const double overlap = radius_i + radius_j - distance;
  const double indentation = 0.5 * overlap * (2.0 * radius_j - overlap) * per_distance;
  return {radius_i - indentation, indentation,
          -0.5 + 0.5 * (radius_i - radius_j) * (radius_i + radius_j) * per_distance * per_distance};
}

}    // namespace deformable

#endif
