#include "solver/near_list.h"

#include "laws/ring_forces.h"
#include "laws/trigonometry.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

void NearList::build(const DeformableParticles &p, bool new_list)
{
  constexpr double MARGIN =
      0.1;    // of a radius: a larger one means more pairs, a smaller one more builds
  margin = MARGIN * p.smallest;

  const int nlocal = atom->nlocal;
  if (new_list) {
    store_history();
    tags.assign(atom->tag, atom->tag + nlocal);
    find_owners();
    guess_bulges(p);
    find_order(p);
  }
  remote_sides.to_ghosts(bulge);
  find_softness(p);
  pairs.sticks = p.films != nullptr;
  if (pairs.sticks) {
    if (new_list) p.films->follow();
    p.films->who_knows(knows_films);
    remote_sides.to_ghosts(knows_films);
  }

  KnownPairs old;    // not kept: it would take memory between the builds
  std::swap(old, static_cast<KnownPairs &>(pairs));
  pairs.clear(old);
  candidates.clear();
  const std::vector<int> first_old = new_list ? std::vector<int>() : first_of(old, 0, old.remote),
                         first_old_remote =
                             new_list ? std::vector<int>() : first_of(old, old.remote, old.wall);
  const double *const *const x = atom->x;
  const NeighList *const list = p.list;
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = order(*list)[ii],
              count = list->numneigh[i], *const neighbors = list->firstneigh[i];
    const double xi = x[i][0], yi = x[i][1], of_i = p.radius[i] + bulge[i] + margin;
    for (int jj = 0; jj < count; ++jj) {
      const int j = neighbors[jj] & NEIGHMASK;
      const double dx = x[j][0] - xi, dy = x[j][1] - yi, near = of_i + p.radius[j] + bulge[j];
      if (dx * dx + dy * dy > near * near &&    // a film may be stretched
          !(pairs.sticks && is_attached(p, i, j, dx, dy)))
        continue;
      const int owner = pairs.owned[j];
      if (j >= nlocal && owner >= 0) {    // an image of this rank's particle: the list has it twice
        // images in one row have the same y to the last bit; those above each other in a tilted box not the same x
        const bool before = dy < 0.0 || (dy == 0.0 && dx < 0.0);
        if (owner < i || (owner == i && before)) continue;
      }
      PastForces past;
      if (new_list) {
        past = history.find(atom->tag[i], atom->tag[j], dx, dy);
      } else {
        const int end = owner >= 0 ? old.remote : old.wall;
        for (int k = (owner >= 0 ? first_old : first_old_remote)[i]; k < end && old.i[k] == i; ++k)
          if (old.j[k] == j) past = old.past_of(k);
      }
      if (owner >= 0)
        pairs.add(i, j, past);
      else
        candidates.push_back({i, j, dx, dy, past});
    }
  }
  pairs.remote = pairs.size;
  if (comm->nprocs > 1) remote_sides.match(candidates, pairs.curved);
  remote_tags.clear();
  for (const RemoteSides::Candidate &c : candidates) {
    pairs.add(c.i, c.j, c.past);
    remote_tags.push_back(atom->tag[c.j]);
  }
  pairs.wall = pairs.size;
  if (!p.walls->empty()) {
    p.refusals->collect([&] { add_walls(p, new_list, old); });
    first_wall = first_of(pairs, pairs.wall, pairs.size);
  }
  pairs.make_room();
  set_constants(p);
  if (pairs.sticks) recall_films(p);
  history = ForceHistory();    // gives its memory back

  x_then.resize(2 * nlocal);
  for (int i = 0; i < nlocal; ++i) {
    x_then[2 * i] = x[i][0];
    x_then[2 * i + 1] = x[i][1];
  }
  bulge_then.assign(bulge.begin(), bulge.begin() + nlocal);
  if (p.radii_vary) radius_then.assign(p.radius, p.radius + nlocal);
  box_then = {domain->xprd, domain->yprd, domain->xy};
  missed_wall = false;
  farthest = grown = 0.0;
}

// The neighbor list is new: particles have other indices now, pairs still have the former ones.
void NearList::store_history()
{
  history.reserve(pairs.size, tags.size());
  for (int i = 0; i < static_cast<int>(tags.size()); ++i) history.add_bulge(tags[i], bulge[i]);
  for (int k = 0; k < pairs.wall; ++k) {
    const NearPairs::Centers centers = pairs.centers(k);
    const double d = 1.0 / pairs.per_distance[k], x = centers.nx * d, y = centers.ny * d;
    const tagint tag = tags[pairs.i[k]];
    const tagint partner = k < pairs.remote ? tags[pairs.second(k)] : remote_tags[k - pairs.remote];
    history.add(tag, partner, x, y, pairs.past_of(k));
  }
  for (int k = pairs.wall; k < pairs.size; ++k)
    history.add(tags[pairs.i[k]], pairs.j[k], 0.0, 0.0, pairs.past_of(k));
  history.sort();
}

void NearList::find_owners()
{
  const int nlocal = atom->nlocal;
  std::vector<double> index(nlocal), rank(nlocal, comm->me);
  for (int i = 0; i < nlocal; ++i) index[i] = i;
  remote_sides.to_ghosts(index);
  remote_sides.to_ghosts(rank);
  pairs.owned.resize(index.size());
  for (std::size_t i = 0; i < index.size(); ++i)
    pairs.owned[i] = rank[i] == comm->me ? static_cast<int>(index[i]) : -1;
}

// LAMMPS sorts particles in rows along x. Where the box is cut across x only, columns along y are better: few blocks have
// contacts with other ranks then (BlockLevels).
void NearList::find_order(const DeformableParticles &p)
{
  constexpr double WIDTH = 3.0;    // of a column, in smallest radii; 1.4 to 6 were measured
  columns.clear();
  if (comm->procgrid[0] == 1 || comm->procgrid[1] > 1 || comm->layout == Comm::LAYOUT_TILED) return;
  const int rings = p.list->inum, *const list = p.list->ilist;
  std::vector<double> column(atom->nlocal);    // also far from the origin
  for (int i = 0; i < atom->nlocal; ++i)
    column[i] = std::floor(atom->x[i][0] / (WIDTH * p.smallest));
  columns.assign(list, list + rings);
  std::stable_sort(columns.begin(), columns.end(),
                   [&](int a, int b) { return column[a] < column[b]; });
}

// The first of these pairs of each particle; the end if there is none. Pairs of a particle follow each other.
std::vector<int> NearList::first_of(const KnownPairs &pairs, int begin, int end) const
{
  std::vector<int> first(atom->nlocal, end);
  for (int k = end - 1; k >= begin; --k) first[pairs.i[k]] = k;
  return first;
}

// Bulges of the last solution. For a particle that this rank has not seen before: contacts have a length of about
// 8 times the indentation, which is half of the overlap.
void NearList::guess_bulges(const DeformableParticles &p)
{
  constexpr double PER_OVERLAP = 0.4;
  const int nlocal = atom->nlocal;
  bulge.resize(nlocal);
  std::vector<char> unknown(nlocal);
  bool any = false;
  for (int i = 0; i < nlocal; ++i) {
    bulge[i] = history.bulge(atom->tag[i]);
    unknown[i] = bulge[i] < 0.0;
    bulge[i] = std::max(bulge[i], 0.0);
    any |= unknown[i] != 0;
  }
  if (!any) return;
  const double *const *const x = atom->x;
  for (int ii = 0; ii < p.list->inum; ++ii) {
    const int i = p.list->ilist[ii];
    for (int jj = 0; jj < p.list->numneigh[i]; ++jj) {
      const int j = p.list->firstneigh[i][jj] & NEIGHMASK;
      const double overlap =
          p.radius[i] + p.radius[j] - std::hypot(x[j][0] - x[i][0], x[j][1] - x[i][1]);
      if (!(overlap > 0.0)) continue;
      if (unknown[i]) bulge[i] += PER_OVERLAP * overlap;
      if (j < nlocal && unknown[j]) bulge[j] += PER_OVERLAP * overlap;
    }
  }
}

/* ---------------------------------------------------------------------- */

void NearList::add_walls(const DeformableParticles &p, bool new_list, const KnownPairs &old)
{
  const std::vector<int> first_old =
      new_list ? std::vector<int>() : first_of(old, old.wall, old.size);
  at_walls.clear();
  for (int ii = 0; ii < p.list->inum; ++ii) {
    const int own = order(*p.list)[ii];
    visit_walls(*p.walls, own, p.radius[own], p.reach, [&](int code, const auto &point) {
      const bool is_attached =
          pairs.sticks && (p.films->is_attached(own, code) ||
                           (knows_films[own] == 0.0 && point.height < p.radius[own]));
      if (point.height > p.radius[own] + bulge[own] + margin && !is_attached) return;
      at_walls.push_back(is_attached);
      PastForces past;
      if (new_list) {
        past = history.find(atom->tag[own], code, 0.0, 0.0);
      } else {
        for (int k = first_old[own]; k < old.size && old.i[k] == own; ++k)
          if (old.j[k] == code) past = old.past_of(k);
      }
      pairs.add(own, code, past);
    });
  }
}

// A pair alone bears o^3/2 G(0)^2 (k_i^(-1/3) + k_j^(-1/3))^3 with the stiffnesses k of small loads. With a tension,
// the force is linear: k is that of a ring which bears as much at an indentation of TYPICAL radii. This is k^(-1/3).
static double softness_of(double r, const deformable::Stiffness &k)
{
  constexpr double TYPICAL = 0.05;
  const double a = TYPICAL * r;
  if (k.tension > 0.0)    // f = p a/G(0)
    return a / std::cbrt(2.0 * deformable::GREEN_AT_ZERO * k.rest_pressure(r) * a);
  return 1.0 / std::cbrt(deformable::area_stiffness(r, k));
}

void NearList::find_softness(const DeformableParticles &p)
{
  softness.clear();
  const Materials &m = *p.materials;
  if (!m.vary()) {
    for (int type = 0; type <= atom->ntypes; ++type) {
      const Species &s = m.species[type];
      softness.push_back(s.radius == 0.0 ? 0.0 : softness_of(s.radius - s.skin, s.stiffness));
    }
    return;
  }
  for (int i = 0; i < atom->nlocal; ++i) {
    const Species &s = m.species_of(i);
    const double r = p.radius[i] - s.skin;
    softness.push_back(s.radius == 0.0 ? 0.0 : softness_of(r, m.stiffness_of(i, r)));
  }
  remote_sides.to_ghosts(softness);
}

void NearList::set_constants(const DeformableParticles &p)
{
  using deformable::GREEN_AT_ZERO;
  const int *const type = p.materials->vary() ? nullptr : atom->type;
  const auto stiffening = [&](int k) {
    const int i = pairs.i[k], j = pairs.j[k];
    double soft = softness[type ? type[i] : i];
    if (k < pairs.wall) soft += softness[type ? type[j] : j];
    return 1.0 / (2.0 * GREEN_AT_ZERO * GREEN_AT_ZERO * soft * soft * soft);
  };
  double most = 0.0;
  for (int k = 0; k < pairs.size; ++k) most = std::max(most, stiffening(k));
  double of_all = most;    // the same on all ranks, which sum up what is scaled
  if (comm->nprocs > 1) MPI_Allreduce(&most, &of_all, 1, MPI_DOUBLE, MPI_MAX, world);
  of_all *= p.smallest * p.smallest;
  pairs.set_units(of_all > 0.0 ? std::ldexp(1.0, -std::ilogb(of_all)) : 1.0,
                  std::ldexp(1.0, std::ilogb(p.smallest)));
  const double unit = pairs.scale * pairs.length * pairs.length;
  for (int k = 0; k < pairs.size; ++k)
    pairs.stiffening[k] = static_cast<float>(stiffening(k) * unit);
  if (pairs.sticks) set_sticking(p);
}

/* ----------------------------------------------------------------------
   A wall that is out of reach counts as far away.
------------------------------------------------------------------------- */

int NearList::locate(const DeformableParticles &p)
{
  if (p.new_material) set_constants(p);
  std::fill(pairs.tilt.begin(), pairs.tilt.end(), 0.0);
  if (pairs.wall > 0 && !kernels.locate(pairs.places(atom->x[0], p.radius), 0, pairs.wall))
    return pairs.first_behind(p.radius);
  if (p.walls->empty()) return -1;
  for (int k = pairs.wall; k < pairs.size; ++k) {
    pairs.overlap[k] = -(1.0 + p.reach) * p.radius[pairs.i[k]];
    pairs.nx[k] = 1.0;
    pairs.ny[k] = pairs.angle[k] = pairs.per_distance[k] = 0.0;
  }
  p.refusals->collect([&] { locate_walls(p); });
  return -1;
}

void NearList::locate_walls(const DeformableParticles &p)
{
  for (int ii = 0; ii < p.list->inum; ++ii) {
    const int i = p.list->ilist[ii];
    visit_walls(*p.walls, i, p.radius[i], p.reach, [&](int code, const auto &point) {
      int k = first_wall[i];
      while (k < pairs.size && pairs.i[k] == i && pairs.j[k] != code) ++k;
      if (k == pairs.size || pairs.i[k] != i) {
        missed_wall |= point.height <= p.radius[i] + bulge_then[i] + 0.5 * margin;
        return;
      }
      pairs.overlap[k] = p.radius[i] - point.height;
      pairs.nx[k] = point.n.x;
      pairs.ny[k] = point.n.y;
      pairs.angle[k] = deformable::angle_of(point.n.x, point.n.y);
      pairs.per_distance[k] = point.turn;
    });
  }
}

/* ---------------------------------------------------------------------- */

double NearList::memory_usage() const
{
  return pairs.bytes() + remote_sides.bytes() + history.bytes() +
         bytes_of(bulge, x_then, bulge_then, radius_then, first_wall, columns, tags, remote_tags,
                  candidates);
}
