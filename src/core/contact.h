// Where two circles meet: the contact line lies on their radical axis.

#ifndef DEFORMABLE_CONTACT_H
#define DEFORMABLE_CONTACT_H

namespace deformable {

struct ContactLine {
  double height;         // h: from the particle's centre to the line; negative: the line is behind it
  double indentation;    // a = R_i - h
  double d_indentation;  // da/dd
};

// h = (d^2 + R_i^2 - R_j^2) / 2d. The indentation is taken from the overlap o = R_i + R_j - d and not
// from R_i - h, because o is exact for nearly touching particles: a = o (o - 2 R_j) / (-2 d).
inline ContactLine contact_line(double distance, double radius_i, double radius_j)
{
  const double overlap = radius_i + radius_j - distance;
  const double half_per_distance = 0.5 / distance;
  const double indentation = overlap * (2.0 * radius_j - overlap) * half_per_distance;
  return {radius_i - indentation, indentation,
          -(distance * distance - (radius_i - radius_j) * (radius_i + radius_j)) *
              (half_per_distance / distance)};
}

}    // namespace deformable

#endif
