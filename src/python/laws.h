// The contact laws for Python.

#ifndef DEFORMABLE_LAWS_H
#define DEFORMABLE_LAWS_H

#include "python/arguments.h"

#include "laws/sector.h"
#include "laws/shape.h"
#include "laws/stiffness.h"

namespace deformable {

struct Result {
  Shape shape;
  std::size_t contacts;
  bool has_sectors;
  std::vector<double> arc_radii;    // one a sector
};

Result sector_result(Call &call);
Result area_sector_result(Call &call);
Result ring_result(Call &call);

// A sector that keeps its perimeter.
Sector perimeter_part(const Opening &o, double ai, double ak);

// Refuses two contacts in one direction: the area deficit or perimeter excess is then not finite.
void refuse_coincident(double change);

// Refuses a stiffness, a tension or a skin that no ring of this radius has.
void refuse_invalid(double radius, const Stiffness &stiffness, double skin);

void bind_laws(nb::module_ &m);
void bind_soft_rings(nb::module_ &m);
void bind_ring_forces(nb::module_ &m);
void bind_outlines(nb::module_ &m);
void bind_rules(nb::module_ &m);
void bind_walls(nb::module_ &m);
void bind_edge_contacts(nb::module_ &m);
void bind_friction(nb::module_ &m);
void bind_smooth_polygons(nb::module_ &m);
void bind_disk_pairs(nb::module_ &m);
void bind_arithmetic(nb::module_ &m);
void bind_energy_blocks(nb::module_ &m);
void bind_ring_blocks(nb::module_ &m);
void bind_droplets(nb::module_ &m);
void bind_proliferation(nb::module_ &m);

}    // namespace deformable

#endif
