// The rules for radius, kA, kP and skin of a species. Each function returns an empty text if its arguments are
// valid, otherwise a phrase with the parameter, its valid range and its value.

#ifndef DEFORMABLE_PARAMETER_RULES_H
#define DEFORMABLE_PARAMETER_RULES_H

#include <cmath>
#include <cstdio>
#include <string>

namespace deformable {

inline std::string shown_number(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

inline std::string invalid_radius(double radius)
{
  if (radius > 0.0 && std::isfinite(radius)) return "";
  return "radius must be positive and finite, not " + shown_number(radius);
}

inline std::string invalid_stiffness(double kA, double kP)
{
  if (!(kA > 0.0)) return "kA must be positive or inf, not " + shown_number(kA);
  if (!(kP > 0.0)) return "kP must be positive or inf, not " + shown_number(kP);
  if (std::isinf(kA) && std::isinf(kP))
    return "kA and kP must not both be inf, as in a rigid disk: give one of them a finite value";
  return "";
}

// An infinite radius stands for one that is not known yet.
inline std::string invalid_skin(double skin, double radius)
{
  if (skin >= 0.0 && skin < radius) return "";
  const std::string range = std::isinf(radius)
                                ? "skin must be 0 or positive and finite"
                                : "skin must be from 0 to below the radius " + shown_number(radius);
  return range + ", not " + shown_number(skin);
}

// For the sector law, besides the rules above: it conserves the perimeter or the area, and has no skin.
inline std::string invalid_for_sectors(double kA, double kP, double skin)
{
  if (std::isinf(kA) == std::isinf(kP))
    return "the sector law needs kP = inf (perimeter conserved) or kA = inf (area conserved), not "
           "kA = " +
           shown_number(kA) + " and kP = " + shown_number(kP);
  if (skin != 0.0) return "the sector law has no skin: it must be 0, not " + shown_number(skin);
  return "";
}

}    // namespace deformable

#endif
