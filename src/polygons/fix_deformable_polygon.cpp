#include "polygons/fix_deformable_polygon.h"

#include "kernels/large_vector.h"
#include "styles/lammps_release.h"
#include "styles/refusals.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>
#include <cstring>

using namespace LAMMPS_NS;
using namespace deformable;
using namespace FixConst;

FixDeformablePolygon::FixDeformablePolygon(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  if (narg < 4) utils::missing_cmd_args(FLERR, "fix deformable/polygon", error);
  kA = utils::numeric(FLERR, arg[3], false, lmp);
  if (!(kA >= 0.0 && std::isfinite(kA)))
    error->all(FLERR_WORD(3),
               "Fix deformable/polygon: kA is '{}': it must be finite and not negative", arg[3]);
  for (int iarg = 4; iarg < narg; iarg += 2) {
    if (std::strcmp(arg[iarg], "rest") != 0)
      error->all(FLERR_WORD(iarg), "Unknown fix deformable/polygon keyword '{}': it must be 'rest'",
                 arg[iarg]);
    if (iarg + 1 >= narg) utils::missing_cmd_args(FLERR, "fix deformable/polygon rest", error);
    given_rest_area = 0.0;
    if (std::strcmp(arg[iarg + 1], "initial") == 0) continue;
    given_rest_area = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
    if (!(given_rest_area > 0.0 && std::isfinite(given_rest_area)))
      error->all(FLERR_WORD(iarg + 1),
                 "Fix deformable/polygon: rest is '{}': it must be initial, or positive and finite",
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

  polygons = find_polygons();
  size_array_rows = static_cast<int>(polygons.size());
  for (Polygon &polygon : polygons) {
    // above the rounding of coordinates, and below the area of any outline
    if (!(std::fabs(polygon.area) > 1e-12 * polygon.perimeter * polygon.perimeter))
      error->all(FLERR, "Fix {} deformable/polygon: the beads of polygon {} enclose no area", id,
                 polygon.molecule);
    polygon.rest_area =
        given_rest_area > 0.0 ? std::copysign(given_rest_area, polygon.area) : polygon.area;
  }
}

std::vector<FixDeformablePolygon::Polygon> FixDeformablePolygon::find_polygons()
{
  std::vector<Polygon> found;
  const BeadSelection members = {fmt::format("Fix {} deformable/polygon", id),
                                 "the group of the fix",
                                 [this](int i) { return (atom->mask[i] & groupbit) != 0; }};
  for (const BeadPolygon &polygon : find_bead_polygons(lmp, members)) found.push_back({polygon});
  if (found.empty()) error->all(FLERR, "Fix {} deformable/polygon: its group has no atoms", id);
  perimeters_known = true;
  return found;
}

int FixDeformablePolygon::setmask()
{
  return POST_FORCE | MIN_POST_FORCE;
}

void FixDeformablePolygon::init()
{
  if (domain->dimension != 2)
    error->all(FLERR, "Fix {} deformable/polygon is two-dimensional: use 'dimension 2'", id);
  refuse_respa(lmp, id, "deformable/polygon");
}

/* ----------------------------------------------------------------------
   Commands between runs may move beads and change the box. Polygons and their
   rest areas remain those of the definition.
------------------------------------------------------------------------- */

void FixDeformablePolygon::setup(int vflag)
{
  std::vector<Polygon> found = find_polygons();
  const auto same = [](const Polygon &a, const Polygon &b) {
    return a.molecule == b.molecule && a.first == b.first && a.beads == b.beads;
  };
  if (!std::equal(polygons.begin(), polygons.end(), found.begin(), found.end(), same))
    error->all(
        FLERR,
        "Fix {} deformable/polygon: its group no longer has the {} polygons of its definition; "
        "define it again",
        id, polygons.size());
  for (std::size_t m = 0; m < polygons.size(); ++m) found[m].rest_area = polygons[m].rest_area;
  polygons = std::move(found);
  links_of_build = -1;
  post_force(vflag);
}

void FixDeformablePolygon::link_beads()
{
  links.clear();
  for (Polygon &polygon : polygons) {
    const tagint last = polygon.first + polygon.beads - 1;
    for (tagint tag = polygon.first; tag <= last; ++tag) {
      const int i = atom->map(tag);
      if (i >= 0 && i < atom->nlocal)
        links.push_back({i, neighbor_of(i, polygon, tag == polygon.first ? last : tag - 1),
                         neighbor_of(i, polygon, tag == last ? polygon.first : tag + 1)});
    }
    polygon.links_end = links.size();
  }
  links_of_build = neighbor->ncalls;
}

/* ----------------------------------------------------------------------
   The image of a bead that is next to bead i. If the ghost cutoff is too
   small, LAMMPS may have another image only.
------------------------------------------------------------------------- */

int FixDeformablePolygon::neighbor_of(int i, const Polygon &polygon, tagint tag) const
{
  const int j = domain->closest_image(i, atom->map(tag));
  const double *const *const x = atom->x;
  if (j < 0 || !is_nearest_image(domain, x[j][0] - x[i][0], x[j][1] - x[i][1]))
    refuse("Fix {} deformable/polygon: atom {} of polygon {} is not found beside atom {}: lost, "
           "or beyond the ghost cutoff (see comm_modify cutoff)",
           id, tag, polygon.molecule, atom->tag[i]);
  return j;
}

void FixDeformablePolygon::from_center(const Polygon &polygon, int i, double &x, double &y) const
{
  const imageint image = atom->image[i];
  const int across = boxes_between(polygon.image_x, image_x(image));
  const int up = boxes_between(polygon.image_y, image_y(image));
  x = atom->x[i][0] - polygon.x + across * domain->xprd;
  y = atom->x[i][1] - polygon.y + up * domain->yprd;
  if (domain->triclinic) x += up * domain->xy;
}

/* ----------------------------------------------------------------------
   A = 1/2 sum_k (x_k - c) x (x_k+1 - x_k), the same for any c
------------------------------------------------------------------------- */

void FixDeformablePolygon::measure_areas()
{
  const double *const *const x = atom->x;
  sums.clear();
  auto link = links.begin();
  for (const Polygon &polygon : polygons) {
    double area = 0.0, sum_x = 0.0, sum_y = 0.0;
    for (const auto end = links.begin() + polygon.links_end; link != end; ++link) {
      const double *here = x[link->bead], *next = x[link->next];
      double px, py;
      from_center(polygon, link->bead, px, py);
      area += 0.5 * (px * (next[1] - here[1]) - py * (next[0] - here[0]));
      sum_x += px;
      sum_y += py;
    }
    sums.insert(sums.end(), {area, sum_x, sum_y});
  }
  if (comm->nprocs > 1)
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM,
                  world);
  const double *sum = sums.data();
  for (Polygon &polygon : polygons) {
    polygon.area = *sum++;
    polygon.x += *sum++ / polygon.beads;
    polygon.y += *sum++ / polygon.beads;
  }
  perimeters_known = false;
}

void FixDeformablePolygon::measure_perimeters()
{
  const double *const *const x = atom->x;
  sums.clear();
  auto link = links.begin();
  for (const Polygon &polygon : polygons) {
    double perimeter = 0.0;
    for (const auto end = links.begin() + polygon.links_end; link != end; ++link) {
      const double *here = x[link->bead], *next = x[link->next];
      perimeter += std::hypot(next[0] - here[0], next[1] - here[1]);
    }
    sums.push_back(perimeter);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM,
                world);
  for (std::size_t m = 0; m < polygons.size(); ++m) polygons[m].perimeter = sums[m];
  perimeters_known = true;
}

/* ----------------------------------------------------------------------
   U = kA/2 sum (A - A0)^2,  dA/dx_k = (y_k+1 - y_k-1)/2,  dA/dy_k = -(x_k+1 - x_k-1)/2
------------------------------------------------------------------------- */

void FixDeformablePolygon::post_force(int vflag)
{
  v_init(vflag);
  if (links_of_build != neighbor->ncalls) Refusals(lmp).check([this] { link_beads(); });
  measure_areas();

  const double *const *const x = atom->x;
  double *const *const f = atom->f;
  auto link = links.begin();
  for (const Polygon &polygon : polygons) {
    const double half = 0.5 * kA * (polygon.rest_area - polygon.area);
    for (const auto end = links.begin() + polygon.links_end; link != end; ++link) {
      const double *previous = x[link->previous], *next = x[link->next];
      const double fx = half * (next[1] - previous[1]), fy = half * (previous[0] - next[0]);
      f[link->bead][0] += fx;
      f[link->bead][1] += fy;
      if (evflag) {
        double px, py;
        from_center(polygon, link->bead, px, py);
        double v[6] = {px * fx, py * fy, 0.0, px * fy, 0.0, 0.0};
        v_tally(link->bead, v);
      }
    }
  }
}

/* ----------------------------------------------------------------------
   Before commands after the run move beads.
------------------------------------------------------------------------- */

void FixDeformablePolygon::post_run()
{
  if (!perimeters_known) measure_perimeters();
}

double FixDeformablePolygon::compute_scalar()
{
  double energy = 0.0;
  for (const Polygon &polygon : polygons) {
    const double excess = polygon.area - polygon.rest_area;
    energy += 0.5 * kA * excess * excess;
  }
  return energy;
}

/* ----------------------------------------------------------------------
   A row for each polygon: area, perimeter, rest area, center (mean of the beads).
------------------------------------------------------------------------- */

double FixDeformablePolygon::compute_array(int m, int column)
{
  if (column == 1 && !perimeters_known) measure_perimeters();
  const Polygon &polygon = polygons[m];
  const int across = polygon.image_x - IMGMAX, up = polygon.image_y - IMGMAX;
  switch (column) {
    case 0: return std::copysign(1.0, polygon.rest_area) * polygon.area;
    case 1: return polygon.perimeter;
    case 2: return std::fabs(polygon.rest_area);
    case 3: return polygon.x + across * domain->xprd + (domain->triclinic ? up * domain->xy : 0.0);
    default: return polygon.y + up * domain->yprd;
  }
}

/* ----------------------------------------------------------------------
   Molecule ID and rest area of every polygon.
------------------------------------------------------------------------- */

void FixDeformablePolygon::write_restart(FILE *fp)
{
  if (comm->me != 0) return;
  std::vector<double> kept;
  kept.push_back(static_cast<double>(polygons.size()));
  for (const Polygon &polygon : polygons) {
    kept.push_back(static_cast<double>(polygon.molecule));
    kept.push_back(polygon.rest_area);
  }
  const int bytes = static_cast<int>(kept.size() * sizeof(double));
  std::fwrite(&bytes, sizeof(int), 1, fp);
  std::fwrite(kept.data(), sizeof(double), kept.size(), fp);
}

void FixDeformablePolygon::restart(char *buffer)
{
  const auto *kept = reinterpret_cast<const double *>(buffer);
  const auto count = static_cast<std::size_t>(*kept++);
  bool same = count == polygons.size();
  for (std::size_t m = 0; same && m < count; ++m) {
    same = static_cast<tagint>(*kept++) == polygons[m].molecule;
    const double rest_area = *kept++;
    polygons[m].rest_area =
        given_rest_area > 0.0 ? std::copysign(given_rest_area, rest_area) : rest_area;
  }
  if (!same)
    error->all(
        FLERR,
        "Fix {} deformable/polygon: the restart file has the rest areas of {} other polygons "
        "under this ID; use another fix ID",
        id, count);
}

double FixDeformablePolygon::memory_usage()
{
  return bytes_of(links, polygons, sums);
}
