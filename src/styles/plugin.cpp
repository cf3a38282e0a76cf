// The entry point of the plugin: registers the styles, or says why it does not.

#include "styles/host_check.h"
#include "styles/plugin_abi.h"

#include "polygons/fix_deformable_polygon.h"
#include "polygons/fix_deformable_stick.h"
#include "polygons/pair_deformable_edge.h"
#include "styles/friction/fix_deformable_friction.h"
#include "styles/memory/fix_deformable_films.h"
#include "styles/memory/fix_deformable_restart.h"
#include "styles/minimize/min_deformable_lbfgs.h"
#include "styles/motion/fix_deformable_propel.h"
#include "styles/pair/compute_deformable_contact.h"
#include "styles/pair/pair_deformable_droplet.h"
#include "styles/pair/pair_deformable_ring.h"
#include "styles/pair/pair_deformable_sector.h"
#include "styles/walls/fix_deformable_wall.h"

#include "lammps.h"

#include <cstdio>

using namespace LAMMPS_NS;

namespace {

template <class Style> void *pair_creator(void *lmp)
{
  return new Style(static_cast<LAMMPS *>(lmp));
}

template <class Style> void *creator_of(void *lmp, int narg, char **arg)
{
  return new Style(static_cast<LAMMPS *>(lmp), narg, arg);
}

void warn(const std::string &message)
{
  int me = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &me);    // the LAMMPS object itself cannot be trusted here
  if (me == 0) std::fprintf(stderr, "WARNING: %s\n", message.c_str());
}

}    // namespace

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle,
                                                                         void *regfunc)
{
  const std::string misfit = unfit_host(lmp);
  if (!misfit.empty()) return warn(misfit);

  const auto register_style = reinterpret_cast<lammpsplugin_regfunc>(regfunc);
  lammpsplugin_t plugin;
  plugin.version = static_cast<LAMMPS *>(lmp)->version;
  plugin.author = "the lammps-deformable developers, version " DEFORMABLE_VERSION;
  plugin.handle = handle;

  // Read again, the headers name their styles, as they do for a LAMMPS that they are compiled into.
#define PAIR_CLASS
#define PairStyle(key, Style)                                                                      \
  plugin.style = "pair";                                                                           \
  plugin.name = #key;                                                                              \
  plugin.info = "pair_style " #key;                                                                \
  plugin.creator.v1 = &pair_creator<Style>;                                                        \
  register_style(&plugin, lmp)
#include "polygons/pair_deformable_edge.h"
#include "styles/pair/pair_deformable_droplet.h"
#include "styles/pair/pair_deformable_ring.h"
#include "styles/pair/pair_deformable_sector.h"

#define FIX_CLASS
#define FixStyle(key, Style)                                                                       \
  plugin.style = "fix";                                                                            \
  plugin.name = #key;                                                                              \
  plugin.info = "fix " #key;                                                                       \
  plugin.creator.v2 = &creator_of<Style>;                                                          \
  register_style(&plugin, lmp)
#include "polygons/fix_deformable_polygon.h"
#include "polygons/fix_deformable_stick.h"
#include "styles/friction/fix_deformable_friction.h"
#include "styles/memory/fix_deformable_films.h"
#include "styles/memory/fix_deformable_restart.h"
#include "styles/motion/fix_deformable_propel.h"
#include "styles/walls/fix_deformable_wall.h"

#define COMPUTE_CLASS
#define ComputeStyle(key, Style)                                                                   \
  plugin.style = "compute";                                                                        \
  plugin.name = #key;                                                                              \
  plugin.info = "compute " #key;                                                                   \
  plugin.creator.v2 = &creator_of<Style>;                                                          \
  register_style(&plugin, lmp)
#include "styles/pair/compute_deformable_contact.h"

  // Before 22Jul2025 plugins have no minimizers.
#if defined(DEFORMABLE_HAS_MIN) && DEFORMABLE_LAMMPS_RELEASE >= 20250722
  if (!MinDeformableLbfgs::fits(static_cast<LAMMPS *>(lmp)))
    return warn("this LAMMPS has other minimizers than lammps-deformable " DEFORMABLE_VERSION
                " was built for: min_style deformable/lbfgs is not available");
#define MINIMIZE_CLASS
#define MinimizeStyle(key, Style)                                                                  \
  plugin.style = "min";                                                                            \
  plugin.name = #key;                                                                              \
  plugin.info = "min_style " #key;                                                                 \
  plugin.creator.v1 = &pair_creator<Style>;                                                        \
  register_style(&plugin, lmp)
#include "styles/minimize/min_deformable_lbfgs.h"
#endif
}
