#include "styles/refusals.h"

#include "styles/all_ranks.h"
#include "styles/species.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "group.h"
#include "input.h"
#include "lammps.h"
#include "modify.h"
#include "neigh_list.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

namespace deformable {

void Refusals::agree()
{
  int here = any_here(), anywhere = here;
  if (comm->nprocs > 1) MPI_Allreduce(&here, &anywhere, 1, MPI_INT, MPI_MAX, world);
  if (anywhere) stop();
}

void Refusals::stop()
{
  std::string told = std::exchange(message, {});
  int first = told.empty() ? comm->nprocs : comm->me, size = static_cast<int>(told.size());
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, world);
  MPI_Bcast(&size, 1, MPI_INT, first, world);
  told.resize(size);
  MPI_Bcast(told.data(), size, MPI_CHAR, first, world);
  error->all(FLERR, told);
}

namespace {

[[noreturn]] void refuse_special_bonds(const std::string &atoms)
{
  refuse("special_bonds gives {} a factor that is not 1, but deformable pair styles do not "
         "scale contacts: use 'special_bonds lj/coul 1 1 1'",
         atoms);
}

/* ----------------------------------------------------------------------
   Factors of zero remove pairs from the neighbor list. Other factors only
   mark them, and the pair styles would not scale their energy. The factors
   are read in each call: pair_style hybrid may set its own for each style.
------------------------------------------------------------------------- */

void check_special_bonds(LAMMPS *lmp, const NeighList &list, const std::vector<Species> &species)
{
  Atom *atom = lmp->atom;
  const Force *force = lmp->force;
  if (atom->molecular == Atom::ATOMIC) return;
  bool any = false, refused[4];    // 1-2, 1-3 and 1-4 partners
  for (int k = 1; k <= 3; ++k) {
    refused[k] = force->special_lj[k] != 1.0;
    any |= refused[k];
  }
  if (!any) return;
  if (atom->molecular == Atom::TEMPLATE) refuse_special_bonds("atoms of a molecule template");

  for (int ii = 0; ii < list.inum; ++ii) {
    const int i = list.ilist[ii];
    for (int k = 1, n = 0; k <= 3; ++k)
      for (; n < atom->nspecial[i][k - 1]; ++n) {
        const int j = refused[k] ? atom->map(atom->special[i][n]) : -1;
        if (j >= 0 && species[atom->type[j]].radius > 0.0)
          refuse_special_bonds(
              fmt::format("atoms {} and {} of a molecule", atom->tag[i], atom->special[i][n]));
      }
  }
}

constexpr double ROUNDING = 1e-12;

// Of the particles of all ranks that are wrong by this; -1 if none is.
template <class IsWrong>
tagint largest_id(LAMMPS *lmp, const NeighList &list, IsWrong &&is_wrong)
{
  tagint here = -1;
  for (int ii = 0; ii < list.inum; ++ii)
    if (is_wrong(list.ilist[ii])) here = std::max(here, lmp->atom->tag[list.ilist[ii]]);
  return largest_of_ranks(lmp->world, here);
}

// The group of comm_modify is a protected member, and in some releases so is the present command.
struct BorderGroup : Comm {
  static int of(const Comm *comm) { return comm->*(&BorderGroup::bordergroup); }
};
struct PresentCommand : Input {
  static const char *of(const Input *input) { return input->*(&PresentCommand::command); }
};

}    // namespace

/* ----------------------------------------------------------------------
   Particles outside of the group of comm_modify have no ghosts: they lack
   contacts across boundaries of the box and between ranks.
------------------------------------------------------------------------- */

void check_ghosts(LAMMPS *lmp, const NeighList &list)
{
  const Group *group = lmp->group;
  const int chosen = BorderGroup::of(lmp->comm);
  if (chosen == 0) return;    // all
  for (int ii = 0; ii < list.inum; ++ii) {
    const int i = list.ilist[ii];
    if (lmp->atom->mask[i] & group->bitmask[chosen]) continue;
    refuse("comm_modify group {} removes contacts of atom {}, which is not in that group: "
           "use 'comm_modify group all', or 'neigh_modify include {}'",
           group->names[chosen], lmp->atom->tag[i], group->names[chosen]);
  }
}

void check_contacts(LAMMPS *lmp, const NeighList &list, const std::vector<Species> &species)
{
  check_special_bonds(lmp, list, species);
  check_ghosts(lmp, list);
}

void refuse_respa(LAMMPS *lmp, const char *id, const char *fix)
{
  if (utils::strmatch(lmp->update->integrate_style, "^respa"))
    lmp->error->all(FLERR, "Fix {} {} cannot be used with run_style respa", id, fix);
}

/* ----------------------------------------------------------------------
   The section Pair Coeffs, or PairIJ Coeffs, calls pair_coeff.
------------------------------------------------------------------------- */

void refuse_data_coefficients(LAMMPS *lmp)
{
  const char *const command = PresentCommand::of(lmp->input);
  if (command && std::strcmp(command, "read_data") == 0)
    lmp->error->all(FLERR,
                    "The data file has coefficients of pairs, which are not those of {}: use "
                    "'read_data ... nocoeff', and pair_coeff after it",
                    lmp->force->pair_style);
}

/* ----------------------------------------------------------------------
   Names the particle of largest ID. Conversions of tilted boxes round z.
------------------------------------------------------------------------- */

bool warn_out_of_plane(LAMMPS *lmp, const NeighList &list)
{
  const double *const *x = lmp->atom->x, *const *v = lmp->atom->v;
  const double in_plane = ROUNDING * lmp->domain->zprd;
  const tagint id =
      largest_id(lmp, list, [=](int i) { return std::fabs(x[i][2]) > in_plane || v[i][2] != 0.0; });
  if (id < 0 || lmp->comm->me != 0) return id >= 0;
  const std::vector<Fix *> fixes = lmp->modify->get_fix_by_style("^enforce2d"),
                           deposits = lmp->modify->get_fix_by_style("^deposit");
  std::string cure = "'fix ID all enforce2d' after all other fixes";
  if (!deposits.empty())
    cure = fmt::format("give the region of fix {} deposit zlo = zhi = 0", deposits[0]->id);
  else if (!fixes.empty())
    cure =
        fmt::format("define fix {} enforce2d anew after all other fixes: it must be the last one, "
                    "for all atoms",
                    fixes[0]->id);
  lmp->error->warning(FLERR,
                      "Atom {} leaves the plane: its z or vz is not zero, which deformable pair "
                      "styles ignore. Use 'set group all z 0 vz 0', and {}",
                      id, cure);
  return id >= 0;
}

/* ----------------------------------------------------------------------
   Radii of atoms have no effect unless the style is told to use them: fix
   adapt, for example, would change nothing.
------------------------------------------------------------------------- */

bool warn_unused_radii(LAMMPS *lmp, const NeighList &list, const std::vector<Species> &species)
{
  const Atom *atom = lmp->atom;
  const tagint id = largest_id(lmp, list, [&](int i) {
    const double r = species[atom->type[i]].radius;
    return std::fabs(atom->radius[i] - r) > ROUNDING * r;
  });
  if (id >= 0 && lmp->comm->me == 0)
    lmp->error->warning(FLERR,
                        "Atom {} has another radius than its species, which the pair style takes: "
                        "use 'radius atom' in pair_style, or set the diameters of the species",
                        id);
  return id >= 0;
}

}    // namespace deformable
