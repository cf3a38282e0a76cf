#include "solver/droplet_list.h"

#include "laws/droplet.h"
#include "styles/walls/fix_deformable_wall.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"

#include <algorithm>
#include <cmath>
#include <numeric>

using namespace LAMMPS_NS;

void DropletList::build(const DropletScene &scene, bool new_list)
{
  // of a radius: a larger one means more pairs, a smaller one more builds
  constexpr double MARGIN = 0.1;
  margin = MARGIN * scene.smallest;

  const int nlocal = atom->nlocal;
  if (new_list) {
    store_history();
    tags.assign(atom->tag, atom->tag + nlocal);
    find_owners();
    guess_bulges(scene);
  }
  remote_sides.to_ghosts(bulge);

  DropletPairs old;    // not kept: it would take memory between the builds
  std::swap(old, pairs);
  std::swap(old.owned, pairs.owned);
  const std::vector<int> first = new_list ? std::vector<int>() : first_of(old, 0, old.remote),
                         first_remote =
                             new_list ? std::vector<int>() : first_of(old, old.remote, old.wall);
  candidates.clear();
  const double *const *const x = atom->x;
  const NeighList *const list = scene.list;
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii], *const neighbors = list->firstneigh[i];
    const double *const xi = x[i], of_i = scene.radius[i] + bulge[i] + margin;
    for (int jj = 0; jj < list->numneigh[i]; ++jj) {
      const int j = neighbors[jj] & NEIGHMASK;
      const double d[] = {x[j][0] - xi[0], x[j][1] - xi[1], x[j][2] - xi[2]};
      const double near = of_i + scene.radius[j] + bulge[j];
      if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > near * near) continue;
      const int owner = pairs.owned[j];
      if (j >= nlocal && owner >= 0) {    // an image of this rank's droplet: the list has it twice
        const bool before =
            d[2] < 0.0 || (d[2] == 0.0 && (d[1] < 0.0 || (d[1] == 0.0 && d[0] < 0.0)));
        if (owner < i || (owner == i && before)) continue;
      }
      PastForces past;
      if (new_list) {
        past = history.find(atom->tag[i], atom->tag[j], d[0], d[1], d[2]);
      } else {
        const int end = owner >= 0 ? old.remote : old.wall;
        for (int k = (owner >= 0 ? first : first_remote)[i]; k < end && old.i[k] == i; ++k)
          if (old.j[k] == j) past = old.past_of(k);
      }
      if (owner >= 0)
        pairs.add(i, j, past);
      else
        candidates.push_back({i, j, d[0], d[1], past, d[2]});
    }
  }
  pairs.remote = pairs.size;
  if (comm->nprocs > 1) remote_sides.match(candidates, false);
  remote_tags.clear();
  for (const RemoteSides::Candidate &c : candidates) {
    pairs.add(c.i, c.j, c.past);
    remote_tags.push_back(atom->tag[c.j]);
  }
  pairs.wall = pairs.size;
  if (!scene.walls->empty()) scene.refusals->collect([&] { add_walls(scene, new_list, old); });
  first_wall = first_of(pairs, pairs.wall, pairs.size);
  pairs.make_room();
  history = ForceHistory();    // gives its memory back

  x_then.assign(x[0], x[0] + 3 * nlocal);
  bulge_then.assign(bulge.begin(), bulge.begin() + nlocal);
  radius_then.assign(scene.radius, scene.radius + nlocal);
  box_then = box_now();
  scene.refusals->collect([&] { locate_walls(scene); });
}

void DropletList::add_walls(const DropletScene &scene, bool new_list, const DropletPairs &old)
{
  const std::vector<int> first = new_list ? std::vector<int>() : first_of(old, old.wall, old.size);
  for (int ii = 0; ii < scene.list->inum; ++ii) {
    const int i = scene.list->ilist[ii];
    const double near = scene.radius[i] + bulge[i] + margin;
    visit_walls(*scene.walls, i, scene.radius[i], scene.reach, [&](int code, const auto &point) {
      if (point.height > near) return;
      PastForces past;
      if (new_list) {
        past = history.find(atom->tag[i], code, 0.0, 0.0);
      } else {
        for (int k = first[i]; k < old.size && old.i[k] == i; ++k)
          if (old.j[k] == code) past = old.past_of(k);
      }
      pairs.add(i, code, past);
    });
  }
}

// A wall that is out of reach counts as far away.
void DropletList::locate_walls(const DropletScene &scene)
{
  missed_wall = false;
  if (scene.walls->empty()) return;
  for (int k = pairs.wall; k < pairs.size; ++k) {
    const double radius = scene.radius[pairs.i[k]];
    pairs.place(k, radius, {{1.0, 0.0, 0.0}, (2.0 + scene.reach) * radius, 0.0, 0.0, {}});
  }
  for (int ii = 0; ii < scene.list->inum; ++ii) {
    const int i = scene.list->ilist[ii];
    const double near = scene.radius[i] + bulge_then[i] + 0.5 * margin;
    visit_walls(*scene.walls, i, scene.radius[i], scene.reach, [&](int code, const auto &point) {
      int k = first_wall[i];
      while (k < pairs.size && pairs.i[k] == i && pairs.j[k] != code) ++k;
      if (k < pairs.size && pairs.i[k] == i)
        pairs.place(k, scene.radius[i], point);
      else
        missed_wall |= point.height <= near;
    });
  }
}

// Droplets have other indices after a new neighbor list, pairs still have the former ones.
void DropletList::store_history()
{
  history.reserve(pairs.size, tags.size());
  for (std::size_t i = 0; i < tags.size(); ++i) history.add_bulge(tags[i], bulge[i]);
  for (int k = 0; k < pairs.wall; ++k) {
    const double d = pairs.distance[k];
    const tagint partner = k < pairs.remote ? tags[pairs.second(k)] : remote_tags[k - pairs.remote];
    history.add(tags[pairs.i[k]], partner, d * pairs.nx[k], d * pairs.ny[k], pairs.past_of(k),
                d * pairs.nz[k]);
  }
  for (int k = pairs.wall; k < pairs.size; ++k)
    history.add(tags[pairs.i[k]], pairs.j[k], 0.0, 0.0, pairs.past_of(k));
  history.sort();
}

void DropletList::find_owners()
{
  const int nlocal = atom->nlocal;
  std::vector<double> index(nlocal), rank(nlocal, comm->me);
  std::iota(index.begin(), index.end(), 0.0);
  remote_sides.to_ghosts(index);
  remote_sides.to_ghosts(rank);
  pairs.owned.resize(index.size());
  for (std::size_t i = 0; i < index.size(); ++i)
    pairs.owned[i] = rank[i] == comm->me ? static_cast<int>(index[i]) : -1;
}

// The first of these pairs of each droplet; the end if there is none. Pairs of a droplet follow each other.
std::vector<int> DropletList::first_of(const DropletPairs &pairs, int begin, int end) const
{
  std::vector<int> first(atom->nlocal, end);
  for (int k = end - 1; k >= begin; --k) first[pairs.i[k]] = k;
  return first;
}

// Bulges of the last solution. For a droplet that this rank has not seen before: as of facets with four times half of the
// overlap as their force.
static constexpr double BULGE_PER_OVERLAP =
    deformable::BULGE_PER_LOAD * 2.0 / (8.0 * deformable::PI);

void DropletList::guess_bulges(const DropletScene &scene)
{
  const double *const *const x = atom->x;
  bulge.resize(atom->nlocal);
  std::vector<char> unknown(atom->nlocal);
  for (int i = 0; i < atom->nlocal; ++i) {
    bulge[i] = history.bulge(atom->tag[i]);
    unknown[i] = bulge[i] < 0.0;
    bulge[i] = std::max(bulge[i], 0.0);
  }
  for (int ii = 0; ii < scene.list->inum; ++ii) {
    const int i = scene.list->ilist[ii];
    for (int jj = 0; jj < scene.list->numneigh[i]; ++jj) {
      const int j = scene.list->firstneigh[i][jj] & NEIGHMASK;
      if (!unknown[i] && !(j < atom->nlocal && unknown[j])) continue;
      const double dx = x[j][0] - x[i][0], dy = x[j][1] - x[i][1], dz = x[j][2] - x[i][2];
      const double overlap =
          scene.radius[i] + scene.radius[j] - std::sqrt(dx * dx + dy * dy + dz * dz);
      if (!(overlap > 0.0)) continue;
      if (unknown[i]) bulge[i] += BULGE_PER_OVERLAP * overlap;
      if (j < atom->nlocal && unknown[j]) bulge[j] += BULGE_PER_OVERLAP * overlap;
    }
  }
  if (!scene.walls->empty()) scene.refusals->collect([&] { add_bulges_at_walls(scene, unknown); });
  for (int i = 0; i < atom->nlocal; ++i)
    bulge[i] = std::min(bulge[i], deformable::LARGEST_BULGE * scene.radius[i]);
}

void DropletList::add_bulges_at_walls(const DropletScene &scene, const std::vector<char> &unknown)
{
  for (int ii = 0; ii < scene.list->inum; ++ii) {
    const int i = scene.list->ilist[ii];
    if (!unknown[i]) continue;
    visit_walls(*scene.walls, i, scene.radius[i], 0.0, [&](int, const auto &point) {
      bulge[i] += 2.0 * BULGE_PER_OVERLAP * (scene.radius[i] - point.height);
    });
  }
}

/* ---------------------------------------------------------------------- */

std::array<double, 6> DropletList::box_now() const
{
  return {domain->xprd, domain->yprd, domain->zprd, domain->xy, domain->xz, domain->yz};
}

// Images of a droplet move with the edges of the box, by as many edges as they are away.
double DropletList::box_change() const
{
  const std::array<double, 6> now = box_now();
  double change = 0.0, edges = 1.0;
  for (std::size_t n = 0; n < now.size(); ++n) change += std::fabs(now[n] - box_then[n]);
  for (int axis = 0; axis < 3; ++axis)
    edges = std::max(edges, 1.0 + comm->get_comm_cutoff() / now[axis]);
  return change == 0.0 ? 0.0 : edges * change;
}

bool DropletList::is_sufficient(const DropletScene &scene, bool before, bool &refused)
{
  constexpr double GROWTH = 0.02;    // of the margin, of a bulge in a solution
  const double *const x = atom->nlocal > 0 ? atom->x[0] : nullptr;
  const double most = 0.5 * (margin - box_change()) - (before ? GROWTH * margin : 0.0);
  bool leaves = missed_wall;
  for (int ii = 0; ii < scene.list->inum; ++ii) {    // others may be fast
    const int i = scene.list->ilist[ii];
    const double *const xi = x + 3 * i, *const then = &x_then[3 * i];
    const double dx = xi[0] - then[0], dy = xi[1] - then[1], dz = xi[2] - then[2];
    const double rest = most - std::max(bulge[i] - bulge_then[i], 0.0) -
                        std::fabs(scene.radius[i] - radius_then[i]);
    leaves |= !(rest * std::fabs(rest) >= dx * dx + dy * dy + dz * dz);
  }
  return remote_sides.all_find(!leaves, refused);
}

double DropletList::memory_usage() const
{
  return pairs.bytes() + remote_sides.bytes() + history.bytes() +
         bytes_of(bulge, x_then, radius_then, bulge_then, tags, remote_tags, candidates,
                  first_wall);
}
