// The rules for radius, kA, kP, tension and skin of a species, and for adhesion. Each function returns an empty text if its arguments
// are valid, otherwise a phrase with the parameter, its valid range and its value.

#ifndef DEFORMABLE_PARAMETER_RULES_H
#define DEFORMABLE_PARAMETER_RULES_H

#include "laws/droplet_film.h"
#include "laws/stiffness.h"
#include "laws/trigonometry.h"

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

inline std::string invalid_stiffness(const Stiffness &k)
{
  const double kA = k.kA, kP = k.kP, tension = k.tension;
  if (!(kA > 0.0)) return "kA must be positive or inf, not " + shown_number(kA);
  if (tension < 0.0)
    return "tension must not be negative, not " + shown_number(tension) +
           ": the perimeter at rest would be longer than the circle's, and free particles would be "
           "floppy";
  if (!(tension >= 0.0 && std::isfinite(tension)))
    return "tension must be 0 or positive and finite, not " + shown_number(tension);
  if (tension == 0.0 && !(kP > 0.0))
    return "kP must be positive or inf, or 0 beside a positive tension, not " + shown_number(kP);
  if (!(kP >= 0.0)) return "kP must be 0, positive or inf, not " + shown_number(kP);
  if (std::isinf(kA) && std::isinf(kP))
    return "kA and kP must not both be inf, as in a rigid disk: give one of them a finite value";
  if (tension > 0.0 && k.conserves_perimeter())
    return "kP must be finite beside a tension, such as 0, not " + shown_number(kP) +
           ": a perimeter that is conserved bears any tension";
  return "";
}

// A free ring of this radius, without its skin, neither shrinks nor expands by itself:
//   d^2U/dr^2/(4 pi^2) = kP + kA r^2 - gamma/(2 pi r) > 0
inline std::string unstable_radius(double ring_radius, const Stiffness &k)
{
  if (k.tension == 0.0) return "";
  const double least = k.rest_pressure(ring_radius) * (0.5 / PI);
  if (k.kP + k.kA * ring_radius * ring_radius > least) return "";
  return "tension " + shown_number(k.tension) + " makes a free particle of radius " +
         shown_number(ring_radius) +
         " collapse: kP + kA R^2 must be above tension/(2 pi R) = " + shown_number(least) +
         ", not " + shown_number(k.kP + k.kA * ring_radius * ring_radius);
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

// A law has none of the parameters from `first` on, or no skin: these must have their defaults.
inline std::string without(const std::string &law, int first, const Stiffness &k, double skin)
{
  for (int n = first; n < MEMBERS; ++n) {
    const Parameter &p = PARAMETERS[n];
    if (p.name && k.*p.of_ring != Stiffness().*p.of_ring)
      return law + " has no " + p.name + ": it must be " + shown_number(Stiffness().*p.of_ring) +
             ", not " + shown_number(k.*p.of_ring);
  }
  if (skin != 0.0) return law + " has no skin: it must be 0, not " + shown_number(skin);
  return "";
}

// For the sector law, besides the rules above: it conserves the perimeter or the area.
inline std::string invalid_for_sectors(const Stiffness &k, double skin)
{
  if (std::isinf(k.kA) == std::isinf(k.kP))
    return "the sector law needs kP = inf (perimeter conserved) or kA = inf (area conserved), not "
           "kA = " +
           shown_number(k.kA) + " and kP = " + shown_number(k.kP);
  return without("the sector law", FIRST_KEYWORD, k, skin);
}

// For droplets in three dimensions, besides the rules above: they keep their volume under a tension.
inline std::string invalid_for_droplets(const Stiffness &k, double skin)
{
  if (!std::isinf(k.kA))
    return "a droplet in three dimensions keeps its volume: kA must be inf, not " +
           shown_number(k.kA);
  if (k.kP != 0.0)
    return "a droplet in three dimensions has no kP: it must be 0, not " + shown_number(k.kP);
  if (!(k.tension > 0.0))
    return "a droplet in three dimensions needs a positive tension, not " + shown_number(k.tension);
  return without("a droplet in three dimensions", FIRST_KEYWORD + 1, k, skin);
}

inline std::string invalid_adhesion(double adhesion)
{
  if (adhesion >= 0.0 && std::isfinite(adhesion)) return "";
  return "adhesion must be 0 or positive and finite, not " + shown_number(adhesion);
}

// For a particle that gains w for each unit of length of a film, or of its area in space, with a wall or with another particle, which meets the
// same rule. A film has the tension T_i + T_j - w (wall: T_i - w) and meets the free outline at an angle of
//   cos theta = 1 - w/2T (wall: 1 - w/T) between equals,   w < 2T of the weaker one
inline std::string invalid_for_adhesion(double adhesion, const Stiffness &k, double skin)
{
  if (adhesion == 0.0) return "";
  const std::string needs = "adhesion " + shown_number(adhesion) + " needs ";
  if (skin != 0.0)
    return needs + "a skin of 0, not " + shown_number(skin) + ": films lie between the outlines";
  if (k.conserves_perimeter())
    return needs + "a finite kP and a tension, not kP = " + shown_number(k.kP) +
           ": a perimeter that is conserved has no tension at rest, and so no contact angle";
  const double least = 0.5 * adhesion;
  if (k.tension > least) return "";
  return needs + "a tension above half of it, " + shown_number(least) + ", not " +
         shown_number(k.tension) +
         (k.tension == 0.0 ? ": without a tension there is no contact angle at rest"
                           : ": nothing would bound the film, which engulfs a particle");
}

// For droplets in space besides: the outline meets the film at an angle with this 1 - cos (droplet_film.h).
inline std::string invalid_for_droplet_film(double adhesion, double rise)
{
  if (rise <= 1.0 - std::cos(MOST_FILM_ANGLE)) return "";
  return "adhesion " + shown_number(adhesion) + " makes a contact angle of " +
         shown_number(std::acos(1.0 - rise)) + " rad, but the law of droplets in space is for " +
         shown_number(LARGEST_FILM_ANGLE) + ", and goes on to " + shown_number(MOST_FILM_ANGLE) +
         ": use a smaller adhesion or a larger tension";
}

}    // namespace deformable

#endif
