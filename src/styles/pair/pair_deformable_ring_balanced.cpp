// Forces and results of balanced contacts.

#include "styles/pair/pair_deformable_ring.h"

#include "comm.h"
#include "neighbor.h"
#include "update.h"

#include <cmath>

using namespace LAMMPS_NS;
using namespace deformable;

void PairDeformableRing::evaluate_balanced(bool new_material)
{
  Particles particles = {list,         &materials, radii.data(), radius_by_atom,
                         &walls,       reach,      smallest,     neighbor->ago == 0,
                         new_material, &refusals,  &adhesions,   films};
  const auto push = [this](int begin, int end, double part, bool is_final) {
    push_part = part;
    push_pairs(begin, end, is_final);
  };
  bool goes_on = balanced->solve(particles, push);
  if (balanced->lacks_room() && materials.yield == 0.0 && may_give_way()) {
    begin_to_give_way();
    balanced->forget();
    particles.new_list = false;
    particles.new_material = true;
    goes_on = balanced->solve(particles, push);
  }
  if (balanced->lacks_room()) {
    const int crushed = balanced->without_room();
    const int contacts_of_it = crushed < 0 ? 0 : balanced->ring(crushed).contacts;
    balanced->forget();
    refusals.collect([&] {
      if (crushed >= 0) no_shape(crushed, contacts_of_it);
    });
    refusals.stop();
  }
  if (!goes_on) {
    refusals.collect([this] { refuse_pair(balanced->refused_pair()); });
    refusals.stop();
  }
  if (films && update->whichflag == 1 && !update->setupflag) films->lose(balanced->lost_energy());
  push_part = 1.0;
  if (rubbing) load_contacts_of_pairs();
  pvector[4] = balanced->limited_lines();
  giving_way = materials.yield > 0.0 ? balanced->giving_way() : 0;
  if (eflag_global) eng_vdwl += balanced->energy();
  refusals.collect([this] {
    if (eflag_atom || needs_shapes() || neighbor->ago == 0)
      for (int ii = 0; ii < list->inum; ++ii) finish_balanced(list->ilist[ii]);
    else
      for (const int i : balanced->crowded_rings()) finish_balanced(i);
  });
  if (comm->me != 0) return;    // compute pair sums over ranks
  pvector[5] = films ? films->compute_scalar() : 0.0;
  pvector[2] = balanced->summary.evaluations;
  pvector[3] = balanced->summary.imbalance;
  pvector[7] = static_cast<int>(balanced->summary.termination);
}

// The line lies behind the smaller one.
void PairDeformableRing::refuse_pair(int k)
{
  if (k < 0) return;
  int i = balanced->pairs().i[k], j = balanced->pairs().j[k];
  if (radii[i] > radii[j]) std::swap(i, j);
  const double *const *const x = atom->x;
  refuse_behind_center(i, j, x[j][0] - x[i][0], x[j][1] - x[i][1]);
}

/* ----------------------------------------------------------------------
   The force on the first particle of a pair: this share of the one along the
   line of centers, and the one across it from these slopes.
------------------------------------------------------------------------- */

Push PairDeformableRing::push_of(int k, const NearPairs::Centers &centers, double share,
                                 double slope) const
{
  const NearPairs &p = balanced->pairs();
  const double force = push_part * p.force[k];
  const double along = -share * force * centers.cosine, across = -force * slope * p.per_distance[k];
  return {along * centers.nx - across * centers.ny, along * centers.ny + across * centers.nx};
}

/* ----------------------------------------------------------------------
   The force f cos(tilt) along the line of centers, and dU/dtheta over the lever
   across it, of both rings. That is f along the normal of a line whose torques
   balance, and the derivative of the energy for any tilt. Of a pair that two
   ranks share each adds the part of its own ring. What is left of the balance
   completes the energy to that of the dual, whose error is of second order.
------------------------------------------------------------------------- */

void PairDeformableRing::push_pairs(int begin, int end, bool counts_energy)
{
  const NearPairs &p = balanced->pairs();
  double *const f = atom->f[0];
  const bool plain = begin < p.remote && !p.curved && !eflag_atom && !vflag_either;
  const bool sums_energy = counts_energy && eflag_either;
  const int usual = plain ? end : begin;
  double rest_of_usual = 0.0;
  for (int k = begin; k < usual && sums_energy && eflag_global; ++k)
    rest_of_usual += p.force[k] * balanced->left(k);
  eng_vdwl += rest_of_usual;
  // usual pairs of which only forces count: the same sums as below
  for (int k = begin; k < usual; ++k) {
    const double force = p.force[k], nx = p.nx[k], ny = p.ny[k];
    const double slope = balanced->outline_slope(k, 0) + balanced->outline_slope(k, 1);
    const double across = force * slope * p.per_distance[k];
    const double px = -force * nx + across * ny, py = -force * ny - across * nx;
    double *const of_i = f + 3 * p.i[k], *const of_j = f + 3 * p.j[k];
    of_i[0] += px;
    of_i[1] += py;
    of_j[0] -= px;
    of_j[1] -= py;
  }
  for (int k = usual; k < end; ++k) {
    const double force = p.force[k];
    const int i = p.i[k], j = p.j[k];
    const bool is_wall = k >= p.wall, is_remote = !is_wall && k >= p.remote;
    double slope = balanced->outline_slope(k, 0);
    if (!is_wall && !is_remote) slope += balanced->outline_slope(k, 1);
    const NearPairs::Centers centers = p.centers(k);
    const double nx = centers.nx, ny = centers.ny;
    const auto [px, py] = push_of(k, centers, is_remote ? 0.5 : 1.0, slope);
    if (sums_energy) {
      const double rest = balanced->energy_left(k);
      if (eflag_global) eng_vdwl += is_remote ? 0.5 * rest : rest;
      if (eflag_atom) {
        eatom[i] += is_wall ? rest : 0.5 * rest;
        if (!is_wall && !is_remote) eatom[p.second(k)] += 0.5 * rest;
      }
    }
    if (is_wall) {
      if (force == 0.0) continue;
      // The wall exerts the torque dU/dtheta about the center: its force acts beside the nearest point.
      const double height = radii[i] - p.overlap[k];
      const double shift = -(1.0 - height * p.per_distance[k]) * slope;
      push_wall(i, j, px, py, {p.angle[k], nx, ny, p.overlap[k]}, shift);
      continue;
    }
    f[3 * i] += px;
    f[3 * i + 1] += py;
    f[3 * j] -= px;
    f[3 * j + 1] -= py;
    if (vflag_either) {
      const double d = 1.0 / p.per_distance[k];
      ev_tally_xyz(i, j, atom->nlocal, 1, 0.0, 0.0, px, py, 0.0, -nx * d, -ny * d, 0.0);
    }
  }
}

/* ----------------------------------------------------------------------
   The film of a line that is at rest lies beside the foot of the center by the
   slope of its outline. A line that stays perpendicular to the line of centers
   is loaded there.
------------------------------------------------------------------------- */

void PairDeformableRing::load_contacts_of_pairs()
{
  const NearPairs &p = balanced->pairs();
  for (int k = 0; k < p.size; ++k) {
    if (!(p.force[k] > 0.0) && !(p.sticks && p.attached[k])) continue;
    const int i = p.i[k];
    const double height = radii[i] - balanced->indentation(k, 0);
    double shift = 0.0;
    if (k >= p.wall)
      shift = -(1.0 - height * p.per_distance[k]) * balanced->outline_slope(k, 0);
    else if (p.curved)
      shift = -balanced->outline_slope(k, 0);
    loaded.push_back({i, p.j[k], k < p.wall ? p.second(k) : -1, p.nx[k], p.ny[k], height, shift,
                      p.force[k], false});
  }
}

/* ---------------------------------------------------------------------- */

void PairDeformableRing::finish_balanced(int i)
{
  const RingSolver::Ring ring = balanced->ring(i);
  if (eflag_atom) eatom[i] += ring.energy.value;
  const bool is_circle = ring.energy.value == 0.0, is_beyond = ring.arc_radius < 0.0;
  beyond_model += is_beyond;
  if (is_circle) return store_circle(i, ring.energy.derivative);
  if (!needs_shapes() && !is_beyond && neighbor->ago != 0) return;

  const NearPairs &p = balanced->pairs();
  const Contacts row = {balanced->shape_of(i, contacts, seats, shape), contacts.data()};
  // the particle or wall of a contact
  const auto partner = [&](int c) {
    const int k = seats[c] >> 1;
    return seats[c] & 1 ? p.i[k] : p.j[k];
  };
  if (neighbor->ago == 0 && !is_within_reach(i, row)) refuse_bulge(i, row, partner(deepest(row)));
  for (int c = 0; c < row.size; ++c) {
    const int k = seats[c] >> 1, other = partner(c);
    double &length = shape.contact[c].length;
    length = balanced->line_length(i, k, length);
    const double distance = other < 0 ? radii[i] - row[c].indentation : 1.0 / p.per_distance[k];
    // each of two particles has half of the force along the line of centers
    const int side = seats[c] & 1;
    Push push = push_of(k, p.centers(k), other < 0 ? 1.0 : 0.5, balanced->outline_slope(k, side));
    if (side) push = {-push.fx, -push.fy};
    RecordedLine line = {balanced->tilt(k), balanced->half_angle(k)};
    if (side) line.half_angle = -line.half_angle;
    if (p.sticks && p.attached[k]) {
      line.contact_angle = 2.0 * std::atan(p.film_angle[side][k]);
      line.attached = other < 0 ? other : 1.0;
    }
    record(i, other, row[c], length, p.force[k], push, distance, line);
  }
  store_shape(i, row, ring.energy.derivative);
  const double r = ring_radius_of(i);
  if (is_beyond && PI * r * r <= shape.area_deficit)
    for (int c = 0; c < row.size; ++c)
      if (partner(c) >= 0 && shape.contact[c].length > 0.0) check_own_image(i, partner(c));
}
