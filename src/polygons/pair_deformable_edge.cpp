#include "polygons/pair_deformable_edge.h"

#include "kernels/large_vector.h"
#include "styles/lammps_release.h"
#include "styles/refusals.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "memory.h"
#include "neigh_list.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace deformable;

namespace {

const char STYLE[] = "Pair style deformable/edge";

}    // namespace

PairDeformableEdge::PairDeformableEdge(LAMMPS *lmp)
    : Pair(lmp),
      longest(0.0),
      kr(nullptr),
      c(nullptr),
      greatest_c(0.0),
      edges(lmp, STYLE),
      refusals(lmp)
{
  single_enable = 0;    // the energy of a pair needs the successors of both
  writedata = 1;
  centroidstressflag = CENTROID_NOTAVAIL;
}

PairDeformableEdge::~PairDeformableEdge()
{
  if (copymode || !allocated) return;
  memory->destroy(setflag);
  memory->destroy(cutsq);
  memory->destroy(kr);
  memory->destroy(c);
}

void PairDeformableEdge::allocate()
{
  allocated = 1;
  const int n = atom->ntypes + 1;
  memory->create(setflag, n, n, "pair:setflag");
  memory->create(cutsq, n, n, "pair:cutsq");
  memory->create(kr, n, n, "pair:kr");
  memory->create(c, n, n, "pair:c");
  for (int i = 1; i < n; ++i)
    for (int j = 1; j < n; ++j) {
      setflag[i][j] = 0;
      kr[i][j] = c[i][j] = 0.0;
    }
}

/* ----------------------------------------------------------------------
   pair_style deformable/edge l
------------------------------------------------------------------------- */

void PairDeformableEdge::settings(int narg, char **arg)
{
  if (narg != 1)
    error->all(FLERR,
               "pair_style deformable/edge has {} arguments: it needs one, l, the longest edge "
               "allowed",
               narg);
  const double given = utils::numeric(FLERR, arg[0], false, lmp);
  if (!(given > 0.0 && std::isfinite(given)))
    error->all(FLERR_WORD(Error::ARGZERO), "{}: l is '{}': it must be positive and finite", STYLE,
               arg[0]);
  longest = given;
}

/* ----------------------------------------------------------------------
   pair_coeff I J kr c
------------------------------------------------------------------------- */

void PairDeformableEdge::coeff(int narg, char **arg)
{
  if (narg != 4)
    error->all(FLERR, "pair_coeff of deformable/edge has {} arguments: it needs I J kr c", narg);
  if (!allocated) allocate();
  int ilo, ihi, jlo, jhi;
  utils::bounds(FLERR, arg[0], 1, atom->ntypes, ilo, ihi, error);
  utils::bounds(FLERR, arg[1], 1, atom->ntypes, jlo, jhi, error);
  const double stiffness = utils::numeric(FLERR, arg[2], false, lmp);
  if (!(stiffness >= 0.0 && std::isfinite(stiffness)))
    error->all(FLERR_WORD(2), "{}: kr is '{}': it must be finite and not negative", STYLE, arg[2]);
  const double range = utils::numeric(FLERR, arg[3], false, lmp);
  if (!(range > 0.0 && std::isfinite(range)))
    error->all(FLERR_WORD(3), "{}: c is '{}': it must be positive and finite", STYLE, arg[3]);

  int count = 0;
  for (int i = ilo; i <= ihi; ++i)
    for (int j = std::max(jlo, i); j <= jhi; ++j, ++count) {
      kr[i][j] = stiffness;
      c[i][j] = range;
      setflag[i][j] = 1;
    }
  if (count == 0)
    error->all(FLERR, "pair_coeff {} {} of deformable/edge has no pair of types I <= J", arg[0],
               arg[1]);
}

void PairDeformableEdge::init_style()
{
  refusals.forget();
  if (domain->dimension != 2) error->all(FLERR, "{} is two-dimensional: use 'dimension 2'", STYLE);
  if (!atom->molecule_flag)
    error->all(FLERR, "{} needs molecule IDs, one for each polygon: use atom_style bond", STYLE);
  if (!atom->tag_enable || atom->map_style == Atom::MAP_NONE)
    error->all(FLERR, "{} needs an atom map: use atom_modify map yes", STYLE);
  if (force->newton_pair == 0)
    error->all(FLERR, "{} needs 'newton on': its forces act on ghost atoms", STYLE);
  neighbor->add_request(this);
  set_ghost_cutoff();
  polygons_unknown = true;
}

/* ----------------------------------------------------------------------
   Ghosts in the neighbor list need their successors.
------------------------------------------------------------------------- */

void PairDeformableEdge::set_ghost_cutoff()
{
  greatest_c = 0.0;
  for (int i = 1; i <= atom->ntypes; ++i)
    for (int j = i; j <= atom->ntypes; ++j)
      if (setflag[i][j]) greatest_c = std::max(greatest_c, c[i][j]);
  edges.refuse_small_box(longest, greatest_c + neighbor->skin);
  const double needed = greatest_c + 2.0 * longest + neighbor->skin;
  if (comm->mode != Comm::SINGLE)
    error->all(FLERR, "{} needs ghosts up to {:.6g} of all atoms: use 'comm_modify mode single'",
               STYLE, needed);
  if (comm->cutghostuser >= needed) return;
  comm->cutghostuser = needed;
  if (comm->me == 0)
    utils::logmesg(lmp, "{}: ghost cutoff set to {:.6g}, c + 2 l + skin\n", STYLE, needed);
}

double PairDeformableEdge::init_one(int i, int j)
{
  if (setflag[i][j] == 0)
    error->all(FLERR, "{}: types {} and {} have no pair_coeff, kr and c are not mixed", STYLE, i,
               j);
  kr[j][i] = kr[i][j];
  c[j][i] = c[i][j];
  return c[i][j] + longest;
}

/* ----------------------------------------------------------------------
   Atoms whose types have coefficients are vertices of polygons: all atoms,
   except with pair_style hybrid.
------------------------------------------------------------------------- */

void PairDeformableEdge::take_list()
{
  const bool new_polygons = polygons_unknown || atom->natoms != atoms_known;
  if (new_polygons) {
    refusals.check([this] { check_ghosts(lmp, *list); });
    const auto has = [this](int i) {
      const int type = atom->type[i];
      for (int other = 1; other <= atom->ntypes; ++other)
        if (setflag[std::min(type, other)][std::max(type, other)]) return true;
      return false;
    };
    edges.find({STYLE, "the atom types of this style", has});
  }
  edges.link(longest, greatest_c + neighbor->skin);
  refusals.check([&] {
    if (new_polygons) check_removed_contacts(lmp, edges, STYLE);
    list_edge_contacts(lmp, *list, edges, c, longest, STYLE, contacts);
  });
  polygons_unknown = false;
  atoms_known = atom->natoms;
  builds_known = neighbor->ncalls;
  build_step = neighbor->lastcall;
  if (!warned_out_of_plane) warned_out_of_plane = warn_out_of_plane(lmp, *list);
}

void PairDeformableEdge::compute(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  if (polygons_unknown || neighbor->ncalls != builds_known || neighbor->lastcall != build_step)
    take_list();

  const int n = atom->ntypes + 1;
  repulsion.resize(n * n);
  for (int i = 1; i < n; ++i)
    for (int j = 1; j < n; ++j) repulsion[i * n + j] = {kr[i][j], c[i][j]};

  if (eflag_atom || vflag_atom || (vflag_global && !vflag_fdotr))
    add_contacts<true>();
  else
    add_contacts<false>();
  if (vflag_fdotr) virial_fdotr_compute();
}

template <bool TALLY> void PairDeformableEdge::add_contacts()
{
  const double *const *const x = atom->x;
  double *const *const f = atom->f;
  const Repulsion *const phi = repulsion.data();
  double energy = 0.0;
  EdgeContact contact;
  for (const VertexAndEdge &at : contacts) {
    const double *v = x[at.begin];
    const double px = x[at.vertex][0] - v[0], py = x[at.vertex][1] - v[1];
    const double ex = x[at.end][0] - v[0], ey = x[at.end][1] - v[1];
    if (!edge_contact(px, py, ex, ey, phi[at.types], contact)) continue;
    energy += contact.energy;
    f[at.vertex][0] += contact.vertex_x;
    f[at.vertex][1] += contact.vertex_y;
    f[at.begin][0] -= contact.vertex_x + contact.end_x;
    f[at.begin][1] -= contact.vertex_y + contact.end_y;
    f[at.end][0] += contact.end_x;
    f[at.end][1] += contact.end_y;
    if (TALLY) tally(at, px, py, ex, ey, contact);
  }
  if (!std::isfinite(energy))
    refusals.collect(
        [] { refuse("{}: the energy of the contacts is not finite: use a smaller kr", STYLE); });
  if (!eflag_global) return;    // ranks agree with the next list
  refusals.agree();
  eng_vdwl += energy;
}

/* ----------------------------------------------------------------------
   Half of energy and virial for the vertex, half for the first vertex of the
   edge. With positions relative to the first one the virial is p f_vertex + e f_end.
------------------------------------------------------------------------- */

void PairDeformableEdge::tally(const VertexAndEdge &at, double px, double py, double ex, double ey,
                               const EdgeContact &contact)
{
  const double v[6] = {px * contact.vertex_x + ex * contact.end_x,
                       py * contact.vertex_y + ey * contact.end_y,
                       0.0,
                       px * contact.vertex_y + ex * contact.end_y,
                       0.0,
                       0.0};
  for (const int i : {at.vertex, at.begin}) {
    if (eflag_atom) eatom[i] += 0.5 * contact.energy;
    for (int k = 0; vflag_atom && k < 6; ++k) vatom[i][k] += 0.5 * v[k];
  }
  for (int k = 0; vflag_global && !vflag_fdotr && k < 6; ++k) virial[k] += v[k];
}

void PairDeformableEdge::write_restart_settings(FILE *fp)
{
  std::fwrite(&longest, sizeof(double), 1, fp);
}

void PairDeformableEdge::read_restart_settings(FILE *fp)
{
  if (comm->me == 0) utils::sfread(FLERR, &longest, sizeof(double), 1, fp, nullptr, error);
  MPI_Bcast(&longest, 1, MPI_DOUBLE, 0, world);
}

void PairDeformableEdge::write_restart(FILE *fp)
{
  write_restart_settings(fp);
  for (int i = 1; i <= atom->ntypes; ++i)
    for (int j = i; j <= atom->ntypes; ++j) {
      const double values[3] = {static_cast<double>(setflag[i][j]), kr[i][j], c[i][j]};
      std::fwrite(values, sizeof(double), 3, fp);
    }
}

void PairDeformableEdge::read_restart(FILE *fp)
{
  read_restart_settings(fp);
  allocate();
  for (int i = 1; i <= atom->ntypes; ++i)
    for (int j = i; j <= atom->ntypes; ++j) {
      double values[3];
      if (comm->me == 0) utils::sfread(FLERR, values, sizeof(double), 3, fp, nullptr, error);
      MPI_Bcast(values, 3, MPI_DOUBLE, 0, world);
      setflag[i][j] = values[0] > 0.0;
      kr[i][j] = values[1];
      c[i][j] = values[2];
    }
}

void PairDeformableEdge::write_data(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; ++i)
    fmt::print(fp, "{} {:.16g} {:.16g}\n", i, kr[i][i], c[i][i]);
}

void PairDeformableEdge::write_data_all(FILE *fp)
{
  for (int i = 1; i <= atom->ntypes; ++i)
    for (int j = i; j <= atom->ntypes; ++j)
      fmt::print(fp, "{} {} {:.16g} {:.16g}\n", i, j, kr[i][j], c[i][j]);
}

double PairDeformableEdge::memory_usage()
{
  return Pair::memory_usage() + edges.memory_usage() + bytes_of(contacts, repulsion);
}
