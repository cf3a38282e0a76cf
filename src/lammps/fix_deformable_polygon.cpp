#include "fix_deformable_polygon.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace FixConst;

namespace {

// What one bead tells all ranks when rings are looked for.
struct Bead {
  double tag, molecule, x, y;
};

// A molecule ID this far beyond the lowest one would make the table of rings larger than the beads.
constexpr tagint WIDEST_RANGE = 100000000;

}    // namespace

/* ---------------------------------------------------------------------- */

FixDeformablePolygon::FixDeformablePolygon(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  if (narg < 4) utils::missing_cmd_args(FLERR, "fix deformable/polygon", error);
  kA = utils::numeric(FLERR, arg[3], false, lmp);
  if (!(std::isfinite(kA) && kA >= 0.0))
    error->all(FLERR, 3, "Stiffness kA of fix deformable/polygon must not be negative, but is {}",
               arg[3]);
  for (int iarg = 4; iarg < narg; iarg += 2) {
    if (std::strcmp(arg[iarg], "rest") != 0)
      error->all(FLERR, iarg, "Unknown fix deformable/polygon keyword '{}'", arg[iarg]);
    if (iarg + 1 >= narg) utils::missing_cmd_args(FLERR, "fix deformable/polygon rest", error);
    given_rest_area = -1.0;
    if (std::strcmp(arg[iarg + 1], "initial") == 0) continue;
    given_rest_area = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
    if (!(std::isfinite(given_rest_area) && given_rest_area > 0.0))
      error->all(FLERR, iarg + 1,
                 "Rest area of fix deformable/polygon must be initial or positive, but is {}",
                 arg[iarg + 1]);
  }
  if (!atom->molecule_flag)
    error->all(FLERR, "Fix {} deformable/polygon needs molecule IDs: use atom_style bond", id);
  if (!atom->tag_enable || atom->map_style == Atom::MAP_NONE)
    error->all(FLERR, "Fix {} deformable/polygon needs an atom map: use atom_modify map yes", id);

  delete[] style;
  style = utils::strdup(STYLE);

  scalar_flag = 1;
  extscalar = 1;
  array_flag = 1;
  extarray = 0;
  size_array_cols = 5;
  global_freq = 1;
  energy_global_flag = thermo_energy = 1;
  virial_global_flag = virial_peratom_flag = thermo_virial = 1;
  restart_global = 1;

  adopt(find_rings());
  size_array_rows = static_cast<int>(rings.size());
}

/* ---------------------------------------------------------------------- */

int FixDeformablePolygon::setmask()
{
  return POST_FORCE | MIN_POST_FORCE;
}

void FixDeformablePolygon::init()
{
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "Fix {} deformable/polygon cannot be used with run_style respa", id);
}

void FixDeformablePolygon::setup(int vflag)
{
  adopt(find_rings());
  links_of_build = -1;
  post_force(vflag);
}

void FixDeformablePolygon::min_setup(int vflag)
{
  setup(vflag);
}

/* ----------------------------------------------------------------------
   The rings of the group, by rising molecule ID, as the beads are now.
------------------------------------------------------------------------- */

std::vector<FixDeformablePolygon::Ring> FixDeformablePolygon::find_rings()
{
  std::vector<Bead> mine;
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    Bead bead{static_cast<double>(atom->tag[i]), static_cast<double>(atom->molecule[i]), 0.0, 0.0};
    unwrapped(i, bead.x, bead.y);
    mine.push_back(bead);
  }
  constexpr int PER_BEAD = sizeof(Bead) / sizeof(double);
  const int length = PER_BEAD * static_cast<int>(mine.size());
  std::vector<int> lengths(comm->nprocs), offsets(comm->nprocs);
  MPI_Allgather(&length, 1, MPI_INT, lengths.data(), 1, MPI_INT, world);
  int total = 0;
  for (int rank = 0; rank < comm->nprocs; ++rank) {
    offsets[rank] = total;
    total += lengths[rank];
  }
  std::vector<Bead> beads(total / PER_BEAD);
  MPI_Allgatherv(mine.data(), length, MPI_DOUBLE, beads.data(), lengths.data(), offsets.data(),
                 MPI_DOUBLE, world);
  if (beads.empty()) error->all(FLERR, "Fix {} deformable/polygon: its group has no atoms", id);
  std::sort(beads.begin(), beads.end(), [](const Bead &a, const Bead &b) {
    return a.molecule != b.molecule ? a.molecule < b.molecule : a.tag < b.tag;
  });

  std::vector<Ring> found;
  centre.clear();
  for (std::size_t begin = 0, end; begin < beads.size(); begin = end) {
    const double molecule = beads[begin].molecule, first = beads[begin].tag;
    for (end = begin; end < beads.size() && beads[end].molecule == molecule; ++end)
      if (beads[end].tag != first + static_cast<double>(end - begin))
        error->all(
            FLERR,
            "Fix {} deformable/polygon: the beads of ring {:.0f} are not consecutive, atom {:.0f} "
            "follows {:.0f}; number them around the ring",
            id, molecule, beads[end].tag, beads[end - 1].tag);
    if (molecule <= 0.0)
      error->all(FLERR, "Fix {} deformable/polygon: atom {:.0f} belongs to no molecule", id, first);
    if (end - begin < 3)
      error->all(FLERR,
                 "Fix {} deformable/polygon: ring {:.0f} has {} beads, at least 3 are needed", id,
                 molecule, end - begin);
    double twice_area = 0.0, x = 0.0, y = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      const Bead &bead = beads[k], &next = beads[k + 1 < end ? k + 1 : begin];
      const double dx = next.x - bead.x, dy = next.y - bead.y;
      double nearest_x = dx, nearest_y = dy, nearest_z = 0.0;
      domain->minimum_image_big(FLERR, nearest_x, nearest_y, nearest_z);
      const double step = std::hypot(dx, dy);
      if (std::hypot(dx - nearest_x, dy - nearest_y) > 1e-6 * step)
        error->all(
            FLERR,
            "Fix {} deformable/polygon: by their image flags atoms {:.0f} and {:.0f} of ring "
            "{:.0f} are {:.6g} apart; make the ring whole with reset_atoms image",
            id, bead.tag, next.tag, molecule, step);
      twice_area += (bead.x - beads[begin].x) * dy - (bead.y - beads[begin].y) * dx;
      x += bead.x;
      y += bead.y;
    }
    centre.push_back(x / static_cast<double>(end - begin));
    centre.push_back(y / static_cast<double>(end - begin));
    found.push_back({static_cast<tagint>(molecule), static_cast<tagint>(first),
                     static_cast<int>(end - begin), twice_area < 0.0 ? -1.0 : 1.0,
                     given_rest_area >= 0.0 ? given_rest_area : 0.5 * std::fabs(twice_area)});
  }
  return found;
}

/* ----------------------------------------------------------------------
   The rings stay those of the definition, with their rest areas; what may
   change is the sense in which a ring runs.
------------------------------------------------------------------------- */

void FixDeformablePolygon::adopt(std::vector<Ring> &&found)
{
  const auto same = [](const Ring &a, const Ring &b) {
    return a.molecule == b.molecule && a.first == b.first && a.beads == b.beads;
  };
  if (!rings.empty() && !std::equal(rings.begin(), rings.end(), found.begin(), found.end(), same))
    error->all(
        FLERR,
        "Fix {} deformable/polygon: its group no longer holds the {} rings that it was defined "
        "for; define it anew",
        id, rings.size());
  for (std::size_t m = 0; m < rings.size(); ++m) found[m].rest_area = rings[m].rest_area;
  rings = std::move(found);

  lowest_molecule = rings.front().molecule;
  const tagint range = rings.back().molecule - lowest_molecule + 1;
  if (range > WIDEST_RANGE)
    error->all(
        FLERR,
        "Fix {} deformable/polygon: molecule IDs from {} to {} are too far apart; renumber them "
        "with reset_atoms mol",
        id, lowest_molecule, rings.back().molecule);
  ring_of_molecule.assign(range, -1);
  for (std::size_t m = 0; m < rings.size(); ++m)
    ring_of_molecule[rings[m].molecule - lowest_molecule] = static_cast<int>(m);

  sums.assign(rings.size(), Sums{});
  perimeter.assign(rings.size(), 0.0);
}

/* ---------------------------------------------------------------------- */

void FixDeformablePolygon::link_beads()
{
  const auto neighbour = [&](int i, const Ring &ring, tagint tag) {
    const int j = domain->closest_image(i, atom->map(tag));
    if (j < 0)
      error->one(
          FLERR,
          "Fix {} deformable/polygon: atom {} of ring {} is not found beside atom {}: lost, or "
          "beyond the ghost cutoff (see comm_modify cutoff)",
          id, tag, ring.molecule, atom->tag[i]);
    return j;
  };
  links.resize(atom->nlocal);
  for (int i = 0; i < atom->nlocal; ++i) {
    links[i].ring = -1;
    const tagint at = atom->molecule[i] - lowest_molecule;
    if (at < 0 || at >= static_cast<tagint>(ring_of_molecule.size())) continue;
    const int m = ring_of_molecule[at];
    if (m < 0) continue;
    const Ring &ring = rings[m];
    if (!(atom->mask[i] & groupbit))
      error->one(
          FLERR,
          "Fix {} deformable/polygon: atom {} belongs to ring {} but not to the group of the "
          "fix",
          id, atom->tag[i], ring.molecule);
    const tagint place = atom->tag[i] - ring.first, last = ring.beads - 1;
    links[i] = {m, neighbour(i, ring, ring.first + (place == 0 ? last : place - 1)),
                neighbour(i, ring, ring.first + (place == last ? 0 : place + 1))};
  }
  links_of_build = neighbor->ncalls;
}

/* ---------------------------------------------------------------------- */

void FixDeformablePolygon::unwrapped(int i, double &x, double &y) const
{
  const imageint image = atom->image[i];
  const double across = static_cast<double>((image & IMGMASK) - IMGMAX);
  const double up = static_cast<double>((image >> IMGBITS & IMGMASK) - IMGMAX);
  x = atom->x[i][0] + across * domain->xprd + (domain->triclinic ? up * domain->xy : 0.0);
  y = atom->x[i][1] + up * domain->yprd;
}

/* ----------------------------------------------------------------------
   A = 1/2 sum_k (x_k - c) x (x_k+1 - x_k), the same for any c
------------------------------------------------------------------------- */

void FixDeformablePolygon::measure_areas()
{
  const double *const *const x = atom->x;
  std::fill(sums.begin(), sums.end(), Sums{});
  for (int i = 0; i < static_cast<int>(links.size()); ++i) {
    const Link &link = links[i];
    if (link.ring < 0) continue;
    double px, py;
    unwrapped(i, px, py);
    px -= centre[2 * link.ring];
    py -= centre[2 * link.ring + 1];
    Sums &sum = sums[link.ring];
    sum.area += 0.5 * (px * (x[link.next][1] - x[i][1]) - py * (x[link.next][0] - x[i][0]));
    sum.x += px;
    sum.y += py;
  }
  if (comm->nprocs > 1)
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(3 * sums.size()), MPI_DOUBLE, MPI_SUM,
                  world);
  for (std::size_t m = 0; m < rings.size(); ++m) {
    sums[m].area *= rings[m].orientation;
    centre[2 * m] += sums[m].x / rings[m].beads;
    centre[2 * m + 1] += sums[m].y / rings[m].beads;
  }
}

double FixDeformablePolygon::pressure(int ring) const
{
  return kA * (rings[ring].rest_area - sums[ring].area);
}

/* ----------------------------------------------------------------------
   U = kA/2 sum (A - A0)^2,  dA/dx_k = (y_k+1 - y_k-1)/2,  dA/dy_k = -(x_k+1 - x_k-1)/2
------------------------------------------------------------------------- */

void FixDeformablePolygon::post_force(int vflag)
{
  v_init(vflag);
  if (links_of_build != neighbor->ncalls) link_beads();
  measure_areas();
  perimeters_known = false;

  const double *const *const x = atom->x;
  double *const *const f = atom->f;
  for (int i = 0; i < static_cast<int>(links.size()); ++i) {
    const Link &link = links[i];
    if (link.ring < 0) continue;
    const double half = 0.5 * pressure(link.ring) * rings[link.ring].orientation;
    const double fx = half * (x[link.next][1] - x[link.previous][1]);
    const double fy = -half * (x[link.next][0] - x[link.previous][0]);
    f[i][0] += fx;
    f[i][1] += fy;
    if (evflag) {
      double px, py;
      unwrapped(i, px, py);
      px -= centre[2 * link.ring];
      py -= centre[2 * link.ring + 1];
      double v[6] = {px * fx, py * fy, 0.0, 0.5 * (px * fy + py * fx), 0.0, 0.0};
      v_tally(i, v);
    }
  }
}

void FixDeformablePolygon::min_post_force(int vflag)
{
  post_force(vflag);
}

/* ---------------------------------------------------------------------- */

double FixDeformablePolygon::compute_scalar()
{
  double energy = 0.0;
  for (std::size_t m = 0; m < rings.size(); ++m) {
    const double excess = sums[m].area - rings[m].rest_area;
    energy += 0.5 * kA * excess * excess;
  }
  return energy;
}

/* ----------------------------------------------------------------------
   a row for each ring: area, perimeter, rest area, centre (mean of the beads)
------------------------------------------------------------------------- */

double FixDeformablePolygon::compute_array(int m, int column)
{
  switch (column) {
    case 0: return sums[m].area;
    case 1:
      if (!perimeters_known) measure_perimeters();
      return perimeter[m];
    case 2: return rings[m].rest_area;
    default: return centre[2 * m + column - 3];
  }
}

void FixDeformablePolygon::measure_perimeters()
{
  const double *const *const x = atom->x;
  std::fill(perimeter.begin(), perimeter.end(), 0.0);
  for (int i = 0; i < static_cast<int>(links.size()); ++i) {
    const Link &link = links[i];
    if (link.ring >= 0)
      perimeter[link.ring] += std::hypot(x[link.next][0] - x[i][0], x[link.next][1] - x[i][1]);
  }
  MPI_Allreduce(MPI_IN_PLACE, perimeter.data(), static_cast<int>(perimeter.size()), MPI_DOUBLE,
                MPI_SUM, world);
  perimeters_known = true;
}

/* ----------------------------------------------------------------------
   molecule ID and rest area of every ring
------------------------------------------------------------------------- */

void FixDeformablePolygon::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  std::vector<double> kept;
  kept.push_back(static_cast<double>(rings.size()));
  for (const Ring &ring : rings) {
    kept.push_back(static_cast<double>(ring.molecule));
    kept.push_back(ring.rest_area);
  }
  const int bytes = static_cast<int>(kept.size() * sizeof(double));
  std::fwrite(&bytes, sizeof(int), 1, fp);
  std::fwrite(kept.data(), sizeof(double), kept.size(), fp);
}

void FixDeformablePolygon::restart(char *buffer)
{
  if (given_rest_area >= 0.0) return;    // said anew
  const auto *kept = reinterpret_cast<const double *>(buffer);
  const auto count = static_cast<std::size_t>(*kept++);
  bool same = count == rings.size();
  for (std::size_t m = 0; same && m < count; ++m) {
    same = static_cast<tagint>(*kept++) == rings[m].molecule;
    rings[m].rest_area = *kept++;
  }
  if (!same)
    error->all(
        FLERR,
        "Fix {} deformable/polygon: the restart file keeps the rest areas of {} other rings; use "
        "another fix ID, or rest AREA",
        id, count);
}

/* ---------------------------------------------------------------------- */

double FixDeformablePolygon::memory_usage()
{
  return static_cast<double>(links.capacity() * sizeof(Link) + rings.capacity() * sizeof(Ring) +
                             ring_of_molecule.capacity() * sizeof(int));
}
