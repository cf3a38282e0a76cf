// What changed in LAMMPS since 29Aug2024, the oldest release that the styles compile with. DEFORMABLE_LAMMPS_RELEASE is
// the date of the release at hand as a number, 20250722 for 22Jul2025; CMake finds it.

#ifndef DEFORMABLE_LAMMPS_RELEASE_H
#define DEFORMABLE_LAMMPS_RELEASE_H

#include "styles/lammps_names.h"

#include "domain.h"
#include "error.h"

// No wheel has this header.
#if __has_include("neigh_request.h")
#include "neigh_request.h"
#else
namespace LAMMPS_NS {
class NeighRequest {
 public:
  void set_cutoff(double);
};
}    // namespace LAMMPS_NS
#endif

#if DEFORMABLE_LAMMPS_RELEASE < 20240829
#error "lammps-deformable needs LAMMPS 29Aug2024 or newer"
#endif

// Place of an error in the source and in the input: since 4Feb2025 LAMMPS underlines the word with this index.
#if DEFORMABLE_LAMMPS_RELEASE < 20250204
#define FLERR_WORD(index) FLERR
#else
#define FLERR_WORD(index) FLERR, index
#endif

namespace deformable {

// What Fix::image calls a line. Since 11Feb2026 numbers begin with an object that is not drawn.
constexpr int IMAGE_LINE = DEFORMABLE_LAMMPS_RELEASE < 20260211 ? 1 : 2;
// The number with which Fix::image gets the color of a type. Those of 2025 draw the color of the next one, the first after the last.
constexpr bool IMAGE_COLOR_IS_NEXT =
    DEFORMABLE_LAMMPS_RELEASE >= 20250722 && DEFORMABLE_LAMMPS_RELEASE < 20260211;
inline double image_color(double type)
{
  return IMAGE_COLOR_IS_NEXT ? type - 1.0 : type;
}

// Since 12Jun2025 an error of these functions names their caller.
inline void minimum_image(const Domain *domain, double *delta)
{
#if DEFORMABLE_LAMMPS_RELEASE < 20250612
  domain->minimum_image(delta);
#else
  domain->minimum_image(FLERR, delta);
#endif
}

inline void minimum_image_big(const Domain *domain, double *delta)
{
#if DEFORMABLE_LAMMPS_RELEASE < 20250612
  domain->minimum_image_big(delta);
#else
  domain->minimum_image_big(FLERR, delta);
#endif
}

}    // namespace deformable

#endif
