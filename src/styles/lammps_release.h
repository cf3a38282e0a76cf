// What changed in LAMMPS since 29Aug2024, the oldest release that the styles compile with. DEFORMABLE_LAMMPS_RELEASE is
// the date of the release at hand as a number, 20250722 for 22Jul2025; CMake finds it.

#ifndef DEFORMABLE_LAMMPS_RELEASE_H
#define DEFORMABLE_LAMMPS_RELEASE_H

#include "domain.h"
#include "error.h"

#if DEFORMABLE_LAMMPS_RELEASE < 20240829
#error "lammps-deformable needs LAMMPS 29Aug2024 or newer"
#endif

// Place of an error in the source and in the input: since 4Feb2025 LAMMPS underlines the word with this index.
#if DEFORMABLE_LAMMPS_RELEASE < 20250204
#define FLERR_WORD(index) FLERR
#else
#define FLERR_WORD(index) FLERR, index
#endif

namespace LAMMPS_NS {

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

}    // namespace LAMMPS_NS

#endif
