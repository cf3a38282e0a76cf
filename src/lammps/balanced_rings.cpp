#include "balanced_rings.h"

#include "atom.h"
#include "comm.h"
#include "error.h"

using namespace LAMMPS_NS;
using namespace deformable;

BalancedRings::BalancedRings(LAMMPS *lmp, double tolerance, int max_evaluations)
    : Pointers(lmp),
      balance(lmp, tolerance, max_evaluations)
{
}

/* ---------------------------------------------------------------------- */

void BalancedRings::begin(const ContactTable &table)
{
  radical.resize(table.contact.size());
  responses.resize(table.contact.size());
  shaped.resize(atom->nlocal);
  for (std::size_t c = 0; c < radical.size(); ++c) radical[c] = table.contact[c].indentation;
}

/* ---------------------------------------------------------------------- */

Energy BalancedRings::result(int i, const ContactTable &table, Shape &shape) const
{
  const int contacts = table.of(i).size;
  shape.reset(contacts, 0.0);
  shape.area_deficit = shaped[i].area_deficit;
  shape.perimeter_excess = shaped[i].perimeter_excess;
  shape.arc_radius = shaped[i].arc_radius;
  if (contacts > 0) std::copy_n(&responses[table.first(i)], contacts, shape.contact.begin());
  return shaped[i].energy;
}

/* ---------------------------------------------------------------------- */

void BalancedRings::warn_unbalanced()
{
  if (warned) return;
  warned = true;
  if (comm->me == 0)
    error->warning(
        FLERR,
        "Contacts are not balanced: after {} evaluations forces of both sides differ by "
        "up to {:.2g} of the largest. Allow more evaluations, or a larger tolerance than "
        "{:.2g} (pair_style deformable/ring balance)",
        balance.evaluations, balance.imbalance, balance.tolerance);
}

/* ---------------------------------------------------------------------- */

double BalancedRings::memory_usage() const
{
  return balance.memory_usage() + bytes_of(shaped, responses, radical);
}
