#include "pair_deformable.h"

#include "compute_deformable_contact.h"

#include "trigonometry.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"

#include <cstring>

using namespace LAMMPS_NS;

static const char *const RESULT_NAMES[] = {"area",     "perimeter",  "contacts",
                                           "pressure", "arc_radius", "contact_length"};

/* ---------------------------------------------------------------------- */

PairDeformable::PairDeformable(LAMMPS *lmp, int outputs)
    : Pair(lmp),
      beyond(0),
      bulge_over_reach(0.0)
{
  single_enable = 0;
  restartinfo = 0;
  one_coeff = 1;
  manybody_flag = 1;
  centroidstressflag = CENTROID_NOTAVAIL;
  nextra = outputs;
  pvector = new double[nextra]();
}

/* ---------------------------------------------------------------------- */

PairDeformable::~PairDeformable()
{
  if (copymode) return;
  delete[] pvector;
  for (double *result : results) memory->destroy(result);
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
  }
}

/* ---------------------------------------------------------------------- */

void PairDeformable::allocate()
{
  allocated = 1;
  const int n = atom->ntypes;
  memory->create(setflag, n + 1, n + 1, "pair:setflag");
  memory->create(cutsq, n + 1, n + 1, "pair:cutsq");
  for (int i = 1; i <= n; ++i)
    for (int j = 1; j <= n; ++j) setflag[i][j] = 0;
  map = new int[n + 1];
}

/* ----------------------------------------------------------------------
   pair_coeff * * FILE species1 species2 ...
------------------------------------------------------------------------- */

void PairDeformable::coeff(int narg, char **arg)
{
  if (!allocated) allocate();
  if (narg < 4) utils::missing_cmd_args(FLERR, "pair_coeff", error);
  if (narg != 3 + atom->ntypes)
    error->all(FLERR,
               "pair_coeff of {} names {} species for {} atom types: give one (or NULL) a type",
               force->pair_style, narg - 3, atom->ntypes);
  map_element2type(narg - 3, arg + 3);

  const std::vector<Species> known = read_species(lmp, arg[2]);
  species.assign(atom->ntypes + 1, Species{});
  radius.assign(atom->ntypes + 1, 0.0);
  for (int type = 1; type <= atom->ntypes; ++type) {
    if (map[type] < 0) continue;
    const char *name = arg[2 + type];
    for (const Species &candidate : known)
      if (candidate.name == name) species[type] = candidate;
    if (species[type].name.empty()) {
      std::string names;
      for (const Species &candidate : known) names += " " + shown(candidate.name);
      error->all(FLERR, 2 + type, "Species '{}' is not in the file '{}', which has:{}", name,
                 arg[2], names);
    }
    check_species(species[type]);
    radius[type] = species[type].radius;
  }
}

/* ---------------------------------------------------------------------- */

void PairDeformable::init_style()
{
  if (domain->dimension != 2)
    error->all(FLERR, "Pair style deformable is two-dimensional: use 'dimension 2'");
  if (force->newton_pair == 0)
    error->all(FLERR, "Pair style deformable needs 'newton on': its forces act on ghost atoms");
  if (radius_by_atom && !atom->radius_flag)
    error->all(FLERR,
               "Pair style deformable with 'radius atom' needs atoms that have radii: use "
               "'atom_style sphere', not {}",
               atom->get_style());
  // each pair of this rank's particles once, those with a ghost on either rank
  neighbor->add_request(this, NeighConst::REQ_NEWTON_OFF);

  // a fix pair that is gone leaves nobody to keep results for; extract_peratom hears of new ones
  wanted = !modify->get_fix_by_style("^pair$").empty();

  watched = !modify->get_compute_by_style(ComputeDeformableContact::STYLE).empty();

  walls.clear();
  for (Fix *fix : modify->get_fix_by_style(FixDeformableWall::STYLE))
    walls.push_back(static_cast<FixDeformableWall *>(fix));
}

/* ---------------------------------------------------------------------- */

double PairDeformable::init_one(int i, int j)
{
  if (setflag[i][j] == 0) error->all(FLERR, "All pair coeffs are not set");
  return (1.0 + reach) * (radius[i] + radius[j]);
}

/* ---------------------------------------------------------------------- */

void PairDeformable::begin_call(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  beyond = 0;
  seen.clear();
  if (neighbor->ago == 0) bulge_over_reach = 0.0;
  atom_radius = radius_by_atom ? atom->radius : nullptr;
  if (radius_by_atom) check_radii();
  table.clear(atom->nlocal);
  for (FixDeformableWall *wall : walls) wall->begin_call(this);

  if (!wanted) return;
  if (atom->nmax > maxresults) {
    maxresults = atom->nmax;
    for (double *&result : results) memory->grow(result, maxresults, "pair:results");
  }
  if (list->inum < atom->nlocal)    // particles of other pair styles have none
    for (double *result : results) std::fill_n(result, atom->nlocal, 0.0);
}

/* ----------------------------------------------------------------------
   compute pair sums pvector over ranks; all ranks look together only when
   the neighbour list is new, so that a step costs no communication
------------------------------------------------------------------------- */

void PairDeformable::end_call()
{
  if (vflag_fdotr) virial_fdotr_compute();

  pvector[0] = beyond;
  if (neighbor->ago != 0) return;
  double local[2] = {bulge_over_reach, static_cast<double>(beyond)}, largest[2];
  MPI_Allreduce(local, largest, 2, MPI_DOUBLE, MPI_MAX, world);
  pvector[1] = comm->me == 0 ? largest[0] : 0.0;
  if (largest[1] > 0.0 && !warned) {
    warned = true;
    if (comm->me == 0)
      error->warning(
          FLERR, "Particles are beyond the deformable model: part of their outline has a negative "
                 "radius of curvature (past confluence, or contacts too close to each other); "
                 "'compute ID all pair' counts them");
  }
}

/* ----------------------------------------------------------------------
   pairs of a block of particles
------------------------------------------------------------------------- */

template <bool WITHIN_CUTOFF> void PairDeformable::find_pairs(int begin, int end)
{
  const double *const *const x = atom->x;
  const int *const type = atom->type;
  const double *const by_type = radius.data(), *const by_atom = atom_radius;
  const auto size = [=](int i) { return by_atom ? by_atom[i] : by_type[type[i]]; };
  const double stretch = 1.0 + reach;
  std::size_t most = 0;
  for (int ii = begin; ii < end; ++ii) most += list->numneigh[list->ilist[ii]];
  pairs.reserve(most);
  pairs.size = 0;

  for (int ii = begin; ii < end; ++ii) {
    const int i = list->ilist[ii];
    const double xi = x[i][0], yi = x[i][1], ri = size(i);
    const int *const neighbors = list->firstneigh[i];
    const int count = list->numneigh[i];
    for (int jj = 0; jj < count; ++jj) {
      const int j = neighbors[jj] & NEIGHMASK;
      const double dx = x[j][0] - xi, dy = x[j][1] - yi, rj = size(j);
      const double cutoff = stretch * (ri + rj);
      if (WITHIN_CUTOFF && dx * dx + dy * dy > cutoff * cutoff) continue;
      pairs.add(i, j, dx, dy, ri, rj);
    }
  }
}

template void PairDeformable::find_pairs<true>(int, int);
template void PairDeformable::find_pairs<false>(int, int);

/* ---------------------------------------------------------------------- */

void PairDeformable::enter_pairs()
{
  using deformable::PI;
  // the table's memory, looked up again only when it has moved
  int stride, *row, *count;
  deformable::Contact *contact;
  Partner *partner;
  const auto look_up = [&] {
    stride = table.stride;
    row = table.row.data();
    count = table.count.data();
    contact = table.contact.data();
    partner = table.partner.data();
  };
  const auto place = [&](int i) {
    if (row[i] < 0 || count[row[i]] == stride) {
      table.make_room(i);
      look_up();
    }
    return static_cast<std::size_t>(row[i]) * stride + count[row[i]]++;
  };
  look_up();

  const int nlocal = atom->nlocal;
  for (int k = 0; k < pairs.size; ++k) {
    const int i = pairs.i[k], j = pairs.j[k];
    const double theta = pairs.angle[k], nx = pairs.nx[k], ny = pairs.ny[k];
    const double ai = pairs.indentation_i[k], aj = pairs.indentation_j[k];
    const double per_distance = pairs.per_distance[k];
    if (!(ai < pairs.radius_i[k])) behind_centre(i, j);
    if (!(aj < pairs.radius_j[k])) behind_centre(j, i);

    const std::size_t at_i = place(i);
    contact[at_i] = {theta, nx, ny, ai};
    partner[at_i] = {j, pairs.d_indentation_i[k], per_distance};
    if (j >= nlocal) continue;
    const std::size_t at_j = place(j);
    contact[at_j] = {theta > 0.0 ? theta - PI : theta + PI, -nx, -ny, aj};
    partner[at_j] = {i, pairs.d_indentation_j[k], per_distance};
  }
}

/* ---------------------------------------------------------------------- */

void PairDeformable::enter_walls(int i)
{
  const double ri = radius_of(i);
  for (std::size_t w = 0; w < walls.size(); ++w)
    walls[w]->visit(i, (1.0 + reach) * ri,
                    [&](double nx, double ny, double height, double per_lever) {
                      table.add(i, {deformable::angle_of(nx, ny), nx, ny, ri - height},
                                {-1 - static_cast<int>(w), -1.0, per_lever});
                    });
}

/* ---------------------------------------------------------------------- */

void PairDeformable::behind_centre(int i, int j)
{
  const double dx = atom->x[j][0] - atom->x[i][0], dy = atom->x[j][1] - atom->x[i][1];
  error->one(
      FLERR,
      "The contact line of atoms {} and {} does not lie in front of the centre of atom {}: their "
      "distance is {:.6g}, their radii are {:.6g} and {:.6g}. Part particles that overlap first, "
      "start from a less compressed state, or take smaller steps or a smaller timestep",
      atom->tag[i], atom->tag[j], atom->tag[i], std::hypot(dx, dy), radius_of(i), radius_of(j));
}

/* ----------------------------------------------------------------------
   contacts without length and force only bound the outline from afar
------------------------------------------------------------------------- */

void PairDeformable::see(int i, int partner, const deformable::Contact &contact, double length,
                         double force, double distance)
{
  if (!watched || (length == 0.0 && force == 0.0)) return;
  const double height = radius_of(i) - contact.indentation;
  const double *x = atom->x[i];
  seen.push_back({i, partner < 0 ? 0 : atom->tag[partner], contact.indentation, length, force,
                  x[0] + height * contact.nx, x[1] + height * contact.ny, contact.angle, distance});
}

/* ----------------------------------------------------------------------
   per-atom results, kept from the moment that somebody (fix pair) asks
------------------------------------------------------------------------- */

void *PairDeformable::extract_peratom(const char *name, int &ncol)
{
  ncol = 0;
  for (int k = 0; k < NRESULTS; ++k)
    if (std::strcmp(name, RESULT_NAMES[k]) == 0) {
      wanted = true;
      return results[k];
    }
  return nullptr;
}

void PairDeformable::store_shape(int i, const deformable::Contacts &contacts, double pressure)
{
  if (!wanted) return;
  const double r = ring_radius_of(i);
  int touching = 0;
  double length = 0.0;
  for (int c = 0; c < contacts.size; ++c) {
    touching += shape.contact[c].length != 0.0;
    length += shape.contact[c].length;
  }
  results[AREA][i] = deformable::PI * r * r - shape.area_deficit;
  results[PERIMETER][i] = 2.0 * deformable::PI * r + shape.perimeter_excess;
  results[CONTACTS][i] = touching;
  results[PRESSURE][i] = pressure;
  results[ARC_RADIUS][i] = shape.arc_radius;
  results[CONTACT_LENGTH][i] = length;
}

void PairDeformable::store_circle(int i)
{
  if (!wanted) return;
  const double r = ring_radius_of(i);
  results[AREA][i] = deformable::PI * r * r;
  results[PERIMETER][i] = 2.0 * deformable::PI * r;
  results[CONTACTS][i] = results[PRESSURE][i] = results[CONTACT_LENGTH][i] = 0.0;
  results[ARC_RADIUS][i] = r;
}

/* ---------------------------------------------------------------------- */

double PairDeformable::memory_usage()
{
  return Pair::memory_usage() + table.bytes() + bytes_of(seen) +
         static_cast<double>(NRESULTS) * maxresults * sizeof(double);
}
