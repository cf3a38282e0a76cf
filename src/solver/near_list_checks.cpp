// How long the list of near pairs is sufficient.

#include "solver/near_list.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;

// Images of a particle move with the edges of the box, by as many edges as they are away.
double NearList::box_change() const
{
  double change = 0.0, edges = 1.0;
  const double cutoff = comm->get_comm_cutoff();
  if (domain->xperiodic) {
    change += std::fabs(domain->xprd - box_then[0]);
    edges = std::max(edges, 1.0 + cutoff / domain->xprd);
  }
  if (domain->yperiodic) {
    change += std::fabs(domain->yprd - box_then[1]) + std::fabs(domain->xy - box_then[2]);
    edges = std::max(edges, 1.0 + cutoff / domain->yprd);
  }
  return edges * change;
}

// Since the last build, squared.
double NearList::move_of(int i, const double *x) const
{
  const double dx = x[3 * i] - x_then[2 * i], dy = x[3 * i + 1] - x_then[2 * i + 1];
  return dx * dx + dy * dy;
}

// Bulges may grow in the solution that follows, about as much as in the last one. A list that is too small for that is
// found again now: afterwards it would cost a second solution.
bool NearList::is_sufficient(const DeformableParticles &p, bool &refused)
{
  constexpr double MOST = 0.1;    // of the margin, as the last growth may have been a jump
  const double *const x = atom->nlocal > 0 ? atom->x[0] : nullptr;
  constexpr double INFINITE = std::numeric_limits<double>::infinity();
  double farthest2 = 0.0;
  bool are_finite = true;
  for (int ii = 0; ii < p.list->inum; ++ii) {    // others may be fast
    const double d2 = move_of(p.list->ilist[ii], x);
    are_finite &= d2 < INFINITE;
    farthest2 = std::max(farthest2, d2);
  }
  farthest = are_finite ? std::sqrt(farthest2) : INFINITE;
  const double expected = std::min(grown_now, MOST * margin);
  grown_now = 0.0;
  return remote_sides.all_find(!missed_wall && is_within_margin(p, expected), refused);
}

bool NearList::is_sufficient_after(const DeformableParticles &p)
{
  bool refused = false;
  return remote_sides.all_find(!missed_wall && is_within_margin(p, 0.0), refused);
}

// Whether each bulge may still grow by so much. Mostly the longest move and the largest growth of a bulge are together below
// half of the margin: then no particle needs a look of its own.
bool NearList::is_within_margin(const DeformableParticles &p, double growth) const
{
  const double most = 0.5 * (margin - box_change()) - growth;
  if (!p.radii_vary && farthest + grown <= most) return true;
  const double *const x = atom->nlocal > 0 ? atom->x[0] : nullptr;
  bool are_near = true;
  for (int ii = 0; ii < p.list->inum; ++ii) {
    const int i = p.list->ilist[ii];
    const double left = most - std::max(bulge[i] - bulge_then[i], 0.0) -
                        (p.radii_vary ? std::fabs(p.radius[i] - radius_then[i]) : 0.0);
    are_near &= left * std::fabs(left) >= move_of(i, x);
  }
  return are_near;
}
