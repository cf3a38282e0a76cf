// Particles of kA = inf whose contacts leave no room for their area: motion stops, a minimization separates them.

#include "styles/pair/pair_deformable_ring.h"

#include "styles/refusals.h"

#include "comm.h"
#include "error.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace deformable;

/* ----------------------------------------------------------------------
   From the first force call without room on, until the end of a minimization,
   areas give way beyond a pressure (stiffness.h): hardly above the one at rest
   at first, because the outlines of firmer particles bulge too far between
   their neighbors. It grows in each iteration, so that particles of any
   pressure that are left at the end are incompressible.
------------------------------------------------------------------------- */

static double yield_after(bigint iterations)
{
  constexpr double FIRST = 1.5, GROWTH = 1.01, MOST = 100.0;    // where no pressure of a shape is
  return std::min(FIRST * std::pow(GROWTH, static_cast<double>(iterations)), MOST);
}

bool PairDeformableRing::may_give_way() const
{
  if (update->whichflag != 2) return false;
  if (kA_by_atom) return true;
  return std::any_of(species.begin(), species.end(), [](const Species &s) {
    return !s.name.empty() && std::isinf(s.stiffness.kA);
  });
}

// Returns whether materials are others than at the last call.
bool PairDeformableRing::choose_yield()
{
  const double before = materials.yield;
  const bool soft = soft_since != NEVER && may_give_way();
  materials.yield = soft ? yield_after(update->ntimestep - soft_since) : 0.0;
  giving_way = 0;
  return materials.yield != before;
}

void PairDeformableRing::begin_to_give_way()
{
  soft_since = update->ntimestep;
  materials.yield = yield_after(0);
}

// Others on all ranks follow at the next call.
Energy PairDeformableRing::shape_without_room(int i, const Contacts &contacts)
{
  Materials soft = materials;
  if (soft.yield == 0.0 && may_give_way()) soft.yield = yield_after(0);
  const Energy energy = shape_ring(i, contacts, soft.stiffness_of(i, ring_radius_of(i)));
  if (!std::isfinite(energy.derivative)) no_shape(i, contacts.size);
  ++giving_way;
  return energy;
}

// The largest adhesion of the contacts that a particle may have.
double PairDeformableRing::largest_adhesion(int i) const
{
  double largest = 0.0;
  for (int type = 1; type <= atom->ntypes; ++type)
    largest = std::max(largest, adhesions.between(atom->type[i], type));
  for (const FixDeformableWall *wall : walls)
    if (atom->mask[i] & wall->groupbit) largest = std::max(largest, wall->adhesion());
  return largest;
}

void PairDeformableRing::no_shape(int i, int contacts)
{
  const bool keeps_area = std::isinf(stiffness_of(i).kA);
  const double adhesion = largest_adhesion(i);
  refuse("Atom {} has no {}: its {} contacts{} leave no room. {}ompress less, {}or give "
         "{} a {} kA",
         atom->tag[i], keeps_area ? "shape that keeps its area" : "stable shape", contacts,
         adhesion > 0.0 ? fmt::format(" of adhesion {:g}", adhesion) : "",
         keeps_area && update->whichflag == 1 ? "Begin with 'minimize', which makes room, c" : "C",
         adhesion > 0.0 ? "take a smaller adhesion, " : "",
         kA_by_atom ? "it" : "species '" + materials.species_of(i).name + "'",
         keeps_area ? "finite" : "larger");
}

int PairDeformableRing::all_giving_way() const
{
  int all = 0;
  MPI_Allreduce(&giving_way, &all, 1, MPI_INT, MPI_SUM, world);
  return all;
}

void PairDeformableRing::tell_room()
{
  pvector[6] = giving_way;
  const bool soft = materials.yield > 0.0;
  if (soft && warned_no_room) return;
  if (!soft && (balanced || !may_give_way())) return;    // balanced contacts have told all ranks
  const int number = all_giving_way();
  if (number == 0) return;
  if (!soft) begin_to_give_way();
  if (!warned_no_room && comm->me == 0)
    error->warning(
        FLERR,
        "The contacts of {} of {} particles leave no room for the area that kA = inf "
        "conserves: in this minimization areas give way until there is room. 'compute ID "
        "all pair' counts them",
        number, atom->natoms);
  warned_no_room = true;
}

// LAMMPS calls this at the end of each run and minimization.
void PairDeformableRing::finish()
{
  if (soft_since == NEVER) return;
  soft_since = NEVER;
  const int number = all_giving_way();
  if (number > 0 && comm->me == 0)
    error->warning(FLERR,
                   "At the end of the minimization the contacts of {} particles of kA = inf still "
                   "leave no room for their area: minimize further, or compress less",
                   number);
}
