// The contact line of two circles on their radical axis.

#ifndef DEFORMABLE_CONTACT_H
#define DEFORMABLE_CONTACT_H

namespace deformable {

// Indentation of both particles by the line.
struct ContactLine {
  double indentation_i, indentation_j;    // a = R - h, h the distance from the center to the line
  double d_indentation_i, d_indentation_j;    // da/dd
};

// h_ij = (d^2 + R_i^2 - R_j^2)/2d. The indentations follow from the overlap o = R_i + R_j - d and not from
// R - h, because o keeps its digits for nearly touching particles: a_ij = o (2 R_j - o)/2d.
inline ContactLine contact_line(double distance, double per_distance, double radius_i,
                                double radius_j)
{
  const double overlap = radius_i + radius_j - distance;
  const double factor = 0.5 * overlap * per_distance;
  const double skew =
      0.5 * (radius_i - radius_j) * (radius_i + radius_j) * per_distance * per_distance;
  return {factor * (2.0 * radius_j - overlap), factor * (2.0 * radius_i - overlap), skew - 0.5,
          -skew - 0.5};
}

}    // namespace deformable

#endif
