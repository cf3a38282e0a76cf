// What is asked for of droplets and their contacts.

#include "styles/pair/pair_deformable_droplet.h"

#include "laws/droplet.h"

using namespace LAMMPS_NS;
using namespace deformable;

/* ---------------------------------------------------------------------- */

void PairDeformableDroplet::finish_droplets()
{
  const NearPairs &p = solver->pairs();
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    double energy = -solver->work(i), rest = 0.0;
    for (int n = 0; n < solver->contacts_of(i); ++n) {
      const int c = solver->place_of_contact(i, n);
      const int k = solver->seat(c) >> 1;
      energy += p.force[k] * solver->indentation(c);
      // more precise than solver->left(k)
      const double left =
          p.overlap[k] - solver->indentation(p.side[0][k]) - solver->indentation(p.side[1][k]);
      rest += (k < p.wall ? 0.5 : 1.0) * p.force[k] * left;
    }
    if (eflag_atom) eatom[i] += energy + rest;
    if (needs_shapes()) store_droplet(i, energy);
  }
}

void PairDeformableDroplet::store_droplet(int i, double energy)
{
  if (!results.requested) return;
  const NearPairs &p = solver->pairs();
  const double r = radii[i], tension = stiffness_of(i).tension;
  double moment = 0.0, area = 0.0;
  int contacts = 0;
  for (int n = 0; n < solver->contacts_of(i); ++n) {
    const int c = solver->place_of_contact(i, n);
    const double force = p.force[solver->seat(c) >> 1], facet = facet_radius(force, r, tension);
    moment += force * (r - solver->indentation(c));
    area += PI * facet * facet;
    contacts += force > 0.0;
  }
  results.store_surface(i, {4.0 * PI * r * r + energy / tension, contacts,
                            droplet_pressure(r, tension, energy, moment), area, solver->load(i)});
}

// On the droplet, from its own energy; from a wall all of it.
Vector3 PairDeformableDroplet::force_of_contact(int k, int side) const
{
  const NearPairs &p = solver->pairs();
  if (k >= p.wall) {
    const SurfacePoint &point = p.surfaces[k - p.wall];
    return -p.force[k] * point.n - point.turned(torque(k, 0));
  }
  const double along = (side ? 0.5 : -0.5) * p.force[k];
  return along * p.normal(k) - p.per_distance[k] * torque(k, side);
}

/* ----------------------------------------------------------------------
   One row for each side of a contact: the particle, its partner, indentation,
   radius of the facet, force, its middle, its normal, distance of the centers
   or of the wall, and the force on the particle from its own energy.
------------------------------------------------------------------------- */

void PairDeformableDroplet::list_contacts(int groupbit, std::vector<double> &rows) const
{
  const NearPairs &p = solver->pairs();
  if (p.size == 0) return;    // there may be no neighbor list yet
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    if (!(atom->mask[i] & groupbit)) continue;
    for (int m = 0; m < solver->contacts_of(i); ++m) {
      const int c = solver->place_of_contact(i, m);
      const int k = solver->seat(c) >> 1, side = solver->seat(c) & 1;
      const double force = p.force[k], sign = side ? -1.0 : 1.0;
      if (force == 0.0) continue;
      const Vector3 n = sign * p.normal(k), push = force_of_contact(k, side),
                    at = Vector3{atom->x[i][0], atom->x[i][1], atom->x[i][2]} +
                         (radii[i] - solver->indentation(c)) * n;
      const double distance = k >= p.wall ? p.surfaces[k - p.wall].height : 1.0 / p.per_distance[k];
      const tagint partner = k >= p.wall ? 0 : atom->tag[side ? p.i[k] : p.j[k]];
      rows.insert(rows.end(),
                  {static_cast<double>(atom->tag[i]), static_cast<double>(partner),
                   solver->indentation(c), facet_radius(force, radii[i], stiffness_of(i).tension),
                   force, at.x, at.y, at.z, n.x, n.y, n.z, distance, push.x, push.y, push.z});
    }
  }
}
