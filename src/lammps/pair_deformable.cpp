#include "pair_deformable.h"

#include "compute_deformable_contact.h"
#include "input_checks.h"

#include "trigonometry.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <limits>

using namespace LAMMPS_NS;

/* ---------------------------------------------------------------------- */

PairDeformable::PairDeformable(LAMMPS *lmp, int outputs)
    : Pair(lmp),
      beyond_model(0),
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
  // each pair of this rank's particles once, pairs with a ghost on both ranks
  neighbor->add_request(this, NeighConst::REQ_NEWTON_OFF);

  // false again after unfix; extract_peratom sets it for a new fix pair
  results.requested = !modify->get_fix_by_style("^pair$").empty();

  recording = !modify->get_compute_by_style(ComputeDeformableContact::STYLE).empty();

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
  beyond_model = 0;
  recorded.clear();
  if (neighbor->ago == 0) {
    check_contacts(lmp, *list, species);
    if (atom->radius_flag && !radius_by_atom && !warned_unused_radii)
      warned_unused_radii = warn_unused_radii(lmp, *list, species);
    bulge_over_reach = 0.0;
  }
  atom_radius = radius_by_atom ? atom->radius : nullptr;
  if (radius_by_atom) check_radii();
  table.clear(atom->nlocal);
  for (FixDeformableWall *wall : walls) wall->begin_call(this);

  if (!results.requested) return;
  results.resize(atom->nmax);
  if (list->inum < atom->nlocal) results.clear(atom->nlocal);    // particles of other pair styles
}

/* ----------------------------------------------------------------------
   Compute pair sums pvector over ranks. Ranks compare their values only when
   the neighbor list is new, so that other steps need no communication.
------------------------------------------------------------------------- */

void PairDeformable::end_call()
{
  if (vflag_fdotr) virial_fdotr_compute();

  // also at the end of each run, after which particles may be written to a file
  const bool output = eflag_global && update->whichflag == 1;
  if (!warned_out_of_plane && (neighbor->ago == 0 || output))
    warned_out_of_plane = warn_out_of_plane(lmp, *list);

  pvector[0] = beyond_model;
  if (neighbor->ago != 0) return;
  double local[2] = {bulge_over_reach, static_cast<double>(beyond_model)}, largest[2];
  MPI_Allreduce(local, largest, 2, MPI_DOUBLE, MPI_MAX, world);
  pvector[1] = comm->me == 0 ? largest[0] : 0.0;
  if (largest[1] > 0.0 && !warned_beyond_model) {
    warned_beyond_model = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     "Particles are beyond the model: part of their outline has a negative "
                     "radius of curvature (past confluence, or contacts too close to each other). "
                     "'compute ID all pair' counts them");
  }
}

/* ---------------------------------------------------------------------- */

template <bool WITHIN_CUTOFF> void PairDeformable::insert_pairs_of(int begin, int end)
{
  const double *const *const x = atom->x;
  const int *const type = atom->type;
  const double *const by_type = radius.data(), *const by_atom = atom_radius;
  const auto radius_at = [=](int i) { return by_atom ? by_atom[i] : by_type[type[i]]; };
  const double stretch = 1.0 + reach;
  std::size_t most = 0;
  for (int ii = begin; ii < end; ++ii) most += list->numneigh[list->ilist[ii]];
  pairs.reserve(most);
  pairs.size = 0;

  for (int ii = begin; ii < end; ++ii) {
    const int i = list->ilist[ii];
    const double xi = x[i][0], yi = x[i][1], ri = radius_at(i);
    const int *const neighbors = list->firstneigh[i];
    const int count = list->numneigh[i];
    for (int jj = 0; jj < count; ++jj) {
      const int j = neighbors[jj] & NEIGHMASK;
      const double dx = x[j][0] - xi, dy = x[j][1] - yi, rj = radius_at(j);
      const double cutoff = stretch * (ri + rj);
      if (WITHIN_CUTOFF && dx * dx + dy * dy > cutoff * cutoff) continue;
      pairs.add(i, j, dx, dy, ri, rj);
    }
  }
  compute_contact_lines(pairs);
  const int bad_pair = insert_pairs(pairs, atom->nlocal, table);
  if (bad_pair >= 0) refuse_behind_center(pairs.i[bad_pair], pairs.j[bad_pair]);
}

template void PairDeformable::insert_pairs_of<true>(int, int);
template void PairDeformable::insert_pairs_of<false>(int, int);

/* ---------------------------------------------------------------------- */

void PairDeformable::insert_walls(int i)
{
  const double ri = radius_of(i);
  const int count = static_cast<int>(walls.size());
  for (int w = 0; w < count; ++w)
    walls[w]->visit(i, (1.0 + reach) * ri, [&](const deformable::NearestPoint &point) {
      table.add(i,
                {deformable::angle_of(point.nx, point.ny), point.nx, point.ny, ri - point.height},
                {-1 - (w + count * point.feature), -1.0, point.per_lever});
    });
}

/* ---------------------------------------------------------------------- */

void PairDeformable::refuse_behind_center(int i, int j)
{
  const double *const *const x = atom->x;
  if (radius_of(i) > radius_of(j)) std::swap(i, j);    // the line lies behind the smaller one
  error->one(
      FLERR,
      "The contact line of atoms {} and {} does not lie in front of the center of atom {}: their "
      "distance is {:.6g}, their radii are {:.6g} and {:.6g}. Separate particles that overlap "
      "first, start from a less compressed state, or take smaller steps or a smaller timestep",
      atom->tag[i], atom->tag[j], atom->tag[i], std::hypot(x[j][0] - x[i][0], x[j][1] - x[i][1]),
      radius_of(i), radius_of(j));
}

/* ---------------------------------------------------------------------- */

void PairDeformable::refuse_own_images(int i)
{
  error->one(FLERR,
             "Atom {} of radius {:.6g} has no area left between its own images: the box, {:.6g} "
             "x {:.6g}, is too small for it",
             atom->tag[i], radius_of(i), domain->xprd, domain->yprd);
}

/* ----------------------------------------------------------------------
   Contacts without length and force, which the outline does not touch, are
   left out.
------------------------------------------------------------------------- */

void PairDeformable::record(int i, int partner, const deformable::Contact &contact, double length,
                            double force, double distance)
{
  if (!recording || (length == 0.0 && force == 0.0)) return;
  const double height = radius_of(i) - contact.indentation;
  const double *x = atom->x[i];
  recorded.push_back({i, partner < 0 ? 0 : atom->tag[partner], contact.indentation, length, force,
                      x[0] + height * contact.nx, x[1] + height * contact.ny, contact.angle,
                      distance});
}

/* ---------------------------------------------------------------------- */

void *PairDeformable::extract_peratom(const char *name, int &ncol)
{
  ncol = 0;
  return results.extract(name);
}

/* ---------------------------------------------------------------------- */

void PairDeformable::set_radius(int iarg, char **arg)
{
  const std::string choice = arg[iarg];
  if (choice != "type" && choice != "atom")
    error->all(FLERR, iarg, "Radius '{}' of a deformable pair style is neither 'type' nor 'atom'",
               choice);
  radius_by_atom = choice == "atom";
}

/* ----------------------------------------------------------------------
   Radii may change between runs and in a run, but must not exceed the radius
   of the species, which sets the cutoff. Data files round them to 16 digits.
------------------------------------------------------------------------- */

void PairDeformable::check_radii()
{
  constexpr double ROUNDING = 1.0 + 1e-12;
  int largest = -1;    // of the atoms whose radius is too large
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    const double r = atom_radius[i];
    const Species &s = species[atom->type[i]];
    if (r > s.skin && r <= s.radius * ROUNDING) continue;
    if (!(r > 0.0))
      error->one(FLERR, "Atom {} has a radius of {:.6g}: it must be positive", atom->tag[i], r);
    if (r <= s.skin)
      error->one(FLERR,
                 "Atom {} has a radius of {:.6g}: it must be larger than the skin of species {}, "
                 "which is {}",
                 atom->tag[i], r, s.name, s.skin);
    if (largest < 0 || r > atom_radius[largest]) largest = i;
  }
  if (largest < 0) return;
  const Species &s = species[atom->type[largest]];
  error->one(FLERR,
             "Atom {} has a radius of {:.6g}, but species {} allows {} at most: set the radius in "
             "the species file to the largest one of its atoms",
             atom->tag[largest], atom_radius[largest], s.name, s.radius);
}

/* ---------------------------------------------------------------------- */

double PairDeformable::smallest_radius() const
{
  double here = std::numeric_limits<double>::infinity(), smallest;
  for (int ii = 0; ii < list->inum; ++ii) here = std::min(here, radius_of(list->ilist[ii]));
  MPI_Allreduce(&here, &smallest, 1, MPI_DOUBLE, MPI_MIN, world);
  return smallest;
}

/* ---------------------------------------------------------------------- */

double PairDeformable::memory_usage()
{
  return Pair::memory_usage() + table.bytes() + bytes_of(recorded) + results.bytes();
}
