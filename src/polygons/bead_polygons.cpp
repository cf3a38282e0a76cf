#include "polygons/bead_polygons.h"

#include "styles/lammps_release.h"
#include "styles/refusals.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "lammps.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

namespace {

// A bead as all ranks get it.
struct Bead {
  double tag, molecule, image_x, image_y, x, y;
};

std::vector<Bead> gather_beads(LAMMPS *lmp, const BeadSelection &selection)
{
  const Atom *atom = lmp->atom;
  std::vector<Bead> mine;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!selection.has(i)) continue;
    const imageint image = atom->image[i];
    mine.push_back({static_cast<double>(atom->tag[i]), static_cast<double>(atom->molecule[i]),
                    static_cast<double>(image_x(image)), static_cast<double>(image_y(image)),
                    atom->x[i][0], atom->x[i][1]});
  }
  constexpr int PER_BEAD = sizeof(Bead) / sizeof(double);
  int length = PER_BEAD * static_cast<int>(mine.size());
  std::vector<int> lengths(lmp->comm->nprocs), offsets(lmp->comm->nprocs);
  MPI_Allgather(&length, 1, MPI_INT, lengths.data(), 1, MPI_INT, lmp->world);
  int total = 0;
  for (int rank = 0; rank < lmp->comm->nprocs; ++rank) {
    offsets[rank] = total;
    total += lengths[rank];
  }
  std::vector<Bead> beads(total / PER_BEAD);
  MPI_Allgatherv(mine.data(), length, MPI_DOUBLE, beads.data(), lengths.data(), offsets.data(),
                 MPI_DOUBLE, lmp->world);
  std::sort(beads.begin(), beads.end(), [](const Bead &a, const Bead &b) {
    return a.molecule != b.molecule ? a.molecule < b.molecule : a.tag < b.tag;
  });
  return beads;
}

// From bead a to bead b, with their image flags.
void from_to(const Domain *domain, const Bead &a, const Bead &b, double &dx, double &dy)
{
  const int across = boxes_between(static_cast<int>(a.image_x), static_cast<int>(b.image_x));
  const int up = boxes_between(static_cast<int>(a.image_y), static_cast<int>(b.image_y));
  dx = b.x - a.x + across * domain->xprd + (domain->triclinic ? up * domain->xy : 0.0);
  dy = b.y - a.y + up * domain->yprd;
}

}    // namespace

/* ---------------------------------------------------------------------- */

bool LAMMPS_NS::is_nearest_image(const Domain *domain, double dx, double dy)
{
  double nearest[3] = {dx, dy, 0.0};
  minimum_image_big(domain, nearest);
  return nearest[0] == dx && nearest[1] == dy;
}

/* ---------------------------------------------------------------------- */

std::vector<BeadPolygon> LAMMPS_NS::find_bead_polygons(LAMMPS *lmp, const BeadSelection &selection)
{
  const Atom *atom = lmp->atom;
  const Domain *domain = lmp->domain;
  Error *error = lmp->error;
  const std::vector<Bead> beads = gather_beads(lmp, selection);
  const std::string &style = selection.style;

  std::vector<BeadPolygon> found;
  for (std::size_t begin = 0, end; begin < beads.size(); begin = end) {
    const Bead &first = beads[begin];
    if (first.molecule <= 0.0)
      error->all(FLERR, "{}: atom {:.0f} belongs to no molecule", style, first.tag);
    for (end = begin; end < beads.size() && beads[end].molecule == first.molecule; ++end)
      if (beads[end].tag != first.tag + static_cast<double>(end - begin))
        error->all(FLERR,
                   "{}: the beads of polygon {:.0f} are not consecutive, atom "
                   "{:.0f} follows {:.0f}; number them around the polygon",
                   style, first.molecule, beads[end].tag, beads[end - 1].tag);
    const int count = static_cast<int>(end - begin);
    if (count < 3)
      error->all(FLERR, "{}: polygon {:.0f} has {} beads, at least 3 are needed", style,
                 first.molecule, count);
    double area = 0.0, perimeter = 0.0, sum_x = 0.0, sum_y = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      const Bead &bead = beads[k], &next = k + 1 < end ? beads[k + 1] : first;
      double x, y, dx, dy;
      from_to(domain, first, bead, x, y);
      from_to(domain, bead, next, dx, dy);
      if (!is_nearest_image(domain, dx, dy))
        error->all(
            FLERR,
            "{}: by their image flags atoms {:.0f} and {:.0f} of "
            "polygon {:.0f} are {:.6g} apart, more than half the box; set flags that make the "
            "polygon whole (set image, or read_data)",
            style, bead.tag, next.tag, first.molecule, std::hypot(dx, dy));
      area += 0.5 * (x * dy - y * dx);
      perimeter += std::hypot(dx, dy);
      sum_x += x;
      sum_y += y;
    }
    found.push_back({static_cast<tagint>(first.molecule), static_cast<tagint>(first.tag), count,
                     area, perimeter, static_cast<int>(first.image_x),
                     static_cast<int>(first.image_y), first.x + sum_x / count,
                     first.y + sum_y / count});
  }

  Refusals(lmp).check([&] {
    for (int i = 0; i < atom->nlocal; ++i) {
      if (selection.has(i)) continue;
      const tagint molecule = atom->molecule[i];
      const auto polygon =
          std::lower_bound(found.begin(), found.end(), molecule,
                           [](const BeadPolygon &a, tagint sought) { return a.molecule < sought; });
      if (polygon != found.end() && polygon->molecule == molecule)
        refuse("{}: atom {} belongs to polygon {} but not to {}", style, atom->tag[i], molecule,
               selection.name);
    }
  });
  return found;
}
