#include "solver/pair_list.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace deformable {

PairList::PairList(LAMMPS *lmp, const ForceKernels &kernels, const Tuning &tuning, bool in_space,
                   bool curved, double bulge_per_overlap, double most_bulge)
    : Pointers(lmp),
      remote_sides(lmp),
      kernels(kernels),
      tuning(tuning),
      bulge_per_overlap(bulge_per_overlap),
      most_bulge(most_bulge)
{
  pairs.in_space = in_space;
  pairs.curved = curved;
}

void PairList::build(const ForceCall &call, bool new_list)
{
  margin = tuning.margin * call.smallest;
  const int nlocal = atom->nlocal;
  if (new_list) {
    store_history();
    tags.assign(atom->tag, atom->tag + nlocal);
    find_owners();
    guess_bulges(call);
    find_order(call);
  }
  remote_sides.to_ghosts(bulge);
  pairs.adhesive = call.films != nullptr;
  if (pairs.adhesive) {
    if (new_list) call.films->follow();
    call.films->who_knows(knows_films);
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
  const NeighList *const list = call.list;
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = order(*list)[ii],
              count = list->numneigh[i], *const neighbors = list->firstneigh[i];
    const double of_i = call.radius[i] + bulge[i] + margin;
    for (int jj = 0; jj < count; ++jj) {
      const int j = neighbors[jj] & NEIGHMASK;
      const Vector3 d = relative(x[i], x[j]);
      const double near = of_i + call.radius[j] + bulge[j];
      if (d.x * d.x + d.y * d.y + d.z * d.z > near * near &&    // a film may be stretched
          !(pairs.adhesive && is_attached(call, i, j, d)))
        continue;
      const int owner = pairs.owned[j];
      if (j >= nlocal &&
          owner >= 0) {    // an image of this rank's particle: LAMMPS' list has it twice
        // images in one row have the same y to the last bit; those above each other in a tilted box not the same x
        const bool before = d.z < 0.0 || (d.z == 0.0 && (d.y < 0.0 || (d.y == 0.0 && d.x < 0.0)));
        if (owner < i || (owner == i && before)) continue;
      }
      PairPast past;
      if (new_list) {
        past = history.find(atom->tag[i], atom->tag[j], d);
      } else {
        const int end = owner >= 0 ? old.remote : old.wall;
        for (int k = (owner >= 0 ? first_old : first_old_remote)[i]; k < end && old.i[k] == i; ++k)
          if (old.j[k] == j) past = old.past_of(k);
      }
      if (owner >= 0)
        pairs.add(i, j, past);
      else
        candidates.push_back({i, j, rank_of[j], d, past});
    }
  }
  pairs.remote = pairs.size;
  if (comm->nprocs > 1) remote_sides.match(candidates);
  remote_tags.clear();
  for (const RemoteSides::Candidate &c : candidates) {
    pairs.add(c.i, c.j, c.past);
    remote_tags.push_back(atom->tag[c.j]);
  }
  pairs.wall = pairs.size;
  if (!call.walls->empty()) {
    call.refusals->collect([&] { add_walls(call, new_list, old); });
    first_wall = first_of(pairs, pairs.wall, pairs.size);
  }
  pairs.make_room();
  if (pairs.adhesive) recall_films(call);
  history = PairHistory();    // gives its memory back

  const int dimension = pairs.in_space ? 3 : 2;
  x_then.resize(static_cast<std::size_t>(dimension) * nlocal);
  for (int i = 0; i < nlocal; ++i) std::copy_n(x[i], dimension, &x_then[dimension * i]);
  bulge_then.assign(bulge.begin(), bulge.begin() + nlocal);
  if (call.radii_vary) radius_then.assign(call.radius, call.radius + nlocal);
  box_then = box_now();
  missed_wall = false;
  farthest = grown = 0.0;
}

// The neighbor list is new: particles have other indices now, pairs still have the former ones.
void PairList::store_history()
{
  history.reserve(pairs.size, tags.size());
  for (int i = 0; i < static_cast<int>(tags.size()); ++i) history.add_bulge(tags[i], bulge[i]);
  for (int k = 0; k < pairs.wall; ++k) {
    const double d = 1.0 / pairs.per_distance[k];
    const NearPairs::Centers centers = pairs.centers(k);
    const Vector3 x = {centers.nx * d, centers.ny * d, pairs.in_space ? pairs.nz[k] * d : 0.0};
    const tagint partner = k < pairs.remote ? tags[pairs.second(k)] : remote_tags[k - pairs.remote];
    history.add(tags[pairs.i[k]], partner, x, pairs.past_of(k));
  }
  for (int k = pairs.wall; k < pairs.size; ++k)
    history.add(tags[pairs.i[k]], pairs.j[k], {}, pairs.past_of(k));
  history.sort();
}

void PairList::find_owners()
{
  const int nlocal = atom->nlocal;
  std::vector<double> index(nlocal), rank(nlocal, comm->me);
  for (int i = 0; i < nlocal; ++i) index[i] = i;
  remote_sides.to_ghosts(index);
  remote_sides.to_ghosts(rank);
  pairs.owned.resize(index.size());
  rank_of.assign(rank.begin(), rank.end());
  for (std::size_t i = 0; i < index.size(); ++i)
    pairs.owned[i] = rank_of[i] == comm->me ? static_cast<int>(index[i]) : -1;
}

// LAMMPS sorts particles in rows along x. Where the box is cut across x only, columns along y are better: few blocks have
// contacts with other ranks then (BlockLevels).
void PairList::find_order(const ForceCall &call)
{
  columns.clear();
  if (pairs.in_space || comm->procgrid[0] == 1 || comm->procgrid[1] > 1 ||
      comm->layout == Comm::LAYOUT_TILED)
    return;
  const int rings = call.list->inum, *const list = call.list->ilist;
  std::vector<double> column(atom->nlocal);    // also far from the origin
  for (int i = 0; i < atom->nlocal; ++i)
    column[i] = std::floor(atom->x[i][0] / (tuning.column * call.smallest));
  columns.assign(list, list + rings);
  std::stable_sort(columns.begin(), columns.end(),
                   [&](int a, int b) { return column[a] < column[b]; });
}

// The first of these pairs of each particle; the end if there is none. Pairs of a particle follow each other.
std::vector<int> PairList::first_of(const KnownPairs &pairs, int begin, int end) const
{
  std::vector<int> first(atom->nlocal, end);
  for (int k = end - 1; k >= begin; --k) first[pairs.i[k]] = k;
  return first;
}

// Bulges of the last solution. For a particle that this rank has not seen before, in proportion to its overlaps.
void PairList::guess_bulges(const ForceCall &call)
{
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
  for (int ii = 0; ii < call.list->inum; ++ii) {
    const int i = call.list->ilist[ii];
    for (int jj = 0; jj < call.list->numneigh[i]; ++jj) {
      const int j = call.list->firstneigh[i][jj] & NEIGHMASK;
      const double overlap = call.radius[i] + call.radius[j] - length(relative(x[i], x[j]));
      if (!(overlap > 0.0)) continue;
      if (unknown[i]) bulge[i] += bulge_per_overlap * overlap;
      if (j < nlocal && unknown[j]) bulge[j] += bulge_per_overlap * overlap;
    }
  }
  if (pairs.in_space && !call.walls->empty())
    call.refusals->collect([&] {
      for (int ii = 0; ii < call.list->inum; ++ii) {
        const int i = call.list->ilist[ii];
        if (!unknown[i]) continue;
        visit_walls(*call.walls, i, call.radius[i], 0.0, [&](int, const SurfacePoint &point) {
          bulge[i] += 2.0 * bulge_per_overlap * (call.radius[i] - point.height);
        });
      }
    });
  for (int i = 0; i < nlocal; ++i) bulge[i] = std::min(bulge[i], most_bulge * call.radius[i]);
}

void PairList::add_walls(const ForceCall &call, bool new_list, const KnownPairs &old)
{
  const std::vector<int> first_old =
      new_list ? std::vector<int>() : first_of(old, old.wall, old.size);
  at_walls.clear();
  for (int ii = 0; ii < call.list->inum; ++ii) {
    const int own = order(*call.list)[ii];
    const double near = call.radius[own] + bulge[own] + margin;
    visit_walls(
        *call.walls, own, call.radius[own], call.reach, [&](int code, const SurfacePoint &point) {
          const bool is_attached =
              pairs.adhesive && (call.films->is_attached(own, code) ||
                                 (knows_films[own] == 0.0 && point.height < call.radius[own]));
          if (point.height > near && !is_attached) return;
          at_walls.push_back(is_attached);
          PairPast past;
          if (new_list) {
            past = history.find(atom->tag[own], code, {});
          } else {
            for (int k = first_old[own]; k < old.size && old.i[k] == own; ++k)
              if (old.j[k] == code) past = old.past_of(k);
          }
          pairs.add(own, code, past);
        });
  }
}

int PairList::locate(const ForceCall &call, Threads &threads)
{
  std::fill(pairs.tilt.begin(), pairs.tilt.end(), 0.0);
  const int wrong =
      pairs.locate(kernels, threads, atom->nmax > 0 ? atom->x[0] : nullptr, call.radius);
  if (wrong >= 0 || call.walls->empty()) return wrong;
  call.refusals->collect([&] { locate_walls(call); });
  return -1;
}

// A wall that is out of reach counts as far away.
void PairList::locate_walls(const ForceCall &call)
{
  for (int k = pairs.wall; k < pairs.size; ++k) {
    const double radius = call.radius[pairs.i[k]];
    pairs.locate_wall(k, radius, {{1.0, 0.0, 0.0}, (2.0 + call.reach) * radius, 0.0, 0.0, {}});
  }
  for (int ii = 0; ii < call.list->inum; ++ii) {
    const int i = call.list->ilist[ii];
    visit_walls(*call.walls, i, call.radius[i], call.reach,
                [&](int code, const SurfacePoint &point) {
                  int k = first_wall[i];
                  while (k < pairs.size && pairs.i[k] == i && pairs.j[k] != code) ++k;
                  if (k < pairs.size && pairs.i[k] == i)
                    pairs.locate_wall(k, call.radius[i], point);
                  else
                    missed_wall |= point.height <= call.radius[i] + bulge_then[i] + 0.5 * margin;
                });
  }
}

/* ----------------------------------------------------------------------
   How long the list is sufficient
------------------------------------------------------------------------- */

std::array<double, 6> PairList::box_now() const
{
  return {domain->xprd, domain->yprd, domain->zprd, domain->xy, domain->xz, domain->yz};
}

// Images of a particle move with the edges of the box, by as many edges as they are away.
double PairList::box_change() const
{
  const std::array<double, 6> now = box_now();
  const int axes = pairs.in_space ? 3 : 2;
  const auto of = [&](int n) { return std::fabs(now[n] - box_then[n]); };
  double change = 0.0, edges = 1.0;
  for (int axis = 0; axis < axes; ++axis) {
    if (!domain->periodicity[axis]) continue;
    change += of(axis);
    if (axis == 1) change += of(3);
    if (axis == 2) change += of(4) + of(5);
    edges = std::max(edges, 1.0 + comm->get_comm_cutoff() / now[axis]);
  }
  return edges * change;
}

// Since the last build, squared.
double PairList::move_of(int i, const double *x) const
{
  if (!pairs.in_space) {
    const double dx = x[3 * i] - x_then[2 * i], dy = x[3 * i + 1] - x_then[2 * i + 1];
    return dx * dx + dy * dy;
  }
  const double *const now = x + 3 * i, *const then = &x_then[3 * i];
  const double dx = now[0] - then[0], dy = now[1] - then[1], dz = now[2] - then[2];
  return dx * dx + dy * dy + dz * dz;
}

bool PairList::is_sufficient(const ForceCall &call, Threads &threads, bool &refused)
{
  const double *const x = atom->nlocal > 0 ? atom->x[0] : nullptr;
  constexpr double INFINITE = std::numeric_limits<double>::infinity();
  std::vector<double> most(threads.count(), 0.0);    // squares; NaN is infinite
  threads.share(call.list->inum, [&](int begin, int end, int thread) {
    double here = 0.0;
    for (int ii = begin; ii < end; ++ii) {    // others may be fast
      const double d2 = move_of(call.list->ilist[ii], x);
      here = std::max(here, d2 < INFINITE ? d2 : INFINITE);
    }
    most[thread] = here;
  });
  farthest = std::sqrt(*std::max_element(most.begin(), most.end()));
  return is_sufficient_after(call, refused);
}

bool PairList::is_sufficient_after(const ForceCall &call, bool &refused)
{
  return remote_sides.all_ranks_sufficient(!missed_wall && is_within_margin(call), refused);
}

// Mostly the longest move and the largest growth of a bulge are together below half of the margin: then no particle needs a
// look of its own.
bool PairList::is_within_margin(const ForceCall &call) const
{
  const double most = 0.5 * (margin - box_change());
  if (!call.radii_vary && farthest + grown <= most) return true;
  const double *const x = atom->nlocal > 0 ? atom->x[0] : nullptr;
  bool are_near = true;
  for (int ii = 0; ii < call.list->inum; ++ii) {
    const int i = call.list->ilist[ii];
    const double left = most - std::max(bulge[i] - bulge_then[i], 0.0) -
                        (call.radii_vary ? std::fabs(call.radius[i] - radius_then[i]) : 0.0);
    are_near &= left * std::fabs(left) >= move_of(i, x);
  }
  return are_near;
}

/* ----------------------------------------------------------------------
   Which pairs are attached by a film, from list to list
------------------------------------------------------------------------- */

// What the particles know; of a particle that is new, whether the circles overlap.
bool PairList::is_attached(const ForceCall &call, int i, int j, const Vector3 &x) const
{
  if (!(call.adhesions->between(atom->type[i], atom->type[j]) > 0.0)) return false;
  if (call.films->is_attached(i, atom->tag[j], x)) return true;
  if (knows_films[i] != 0.0 && knows_films[j] != 0.0) return false;
  const double touch = call.radius[i] + call.radius[j];
  return dot(x, x) < touch * touch;
}

// Where circles just touch, rounding of a ghost's position decides: Films::agree lets both ranks decide alike.
void PairList::recall_films(const ForceCall &call)
{
  for (int k = 0; k < pairs.wall; ++k) {
    const int i = pairs.i[k], j = pairs.j[k];
    pairs.attached[k] = is_attached(call, i, j, relative(atom->x[i], atom->x[j]));
  }
  for (int k = pairs.wall; k < pairs.size; ++k)
    pairs.attached[k] =
        at_walls[k - pairs.wall] && wall_of(pairs.j[k], *call.walls).adhesion() > 0.0;
}

void PairList::store_films(const ForceCall &call) const
{
  call.films->forget(*call.list);
  for (int k = 0; k < pairs.size; ++k) {
    if (!pairs.attached[k]) continue;
    const int i = pairs.i[k], j = pairs.j[k];
    if (k >= pairs.wall) {
      call.films->attach(i, j, {});
      continue;
    }
    const Vector3 d = relative(atom->x[i], atom->x[j]);
    call.films->attach(i, atom->tag[j], d);
    if (k < pairs.remote) call.films->attach(pairs.second(k), atom->tag[i], -d);
  }
}

/* ----------------------------------------------------------------------
   History
------------------------------------------------------------------------- */

PairHistory::Entry PairHistory::entry_of(tagint tag, tagint partner, const Vector3 &at,
                                         const PairPast &past)
{
  const float x = static_cast<float>(at.x), y = static_cast<float>(at.y),
              z = static_cast<float>(at.z);
  if (partner < 0 || tag <= partner) return {tag, partner, x, y, z, past};
  return {partner, tag, -x, -y, -z, past.from_second()};
}

void PairHistory::sort()
{
  std::sort(entries.begin(), entries.end());
  std::sort(bulges.begin(), bulges.end());
}

PairPast PairHistory::find(tagint tag, tagint partner, const Vector3 &x) const
{
  const Entry wanted = entry_of(tag, partner, x, {});
  const auto [first, last] = std::equal_range(entries.begin(), entries.end(), wanted);
  PairPast found;
  float nearest = wanted.x * wanted.x + wanted.y * wanted.y + wanted.z * wanted.z;
  for (auto entry = first; entry != last; ++entry) {
    const float dx = entry->x - wanted.x, dy = entry->y - wanted.y, dz = entry->z - wanted.z;
    const float square = dx * dx + dy * dy + dz * dz;
    if (square > nearest) continue;
    nearest = square;
    found = entry->past;
  }
  return wanted.tag == tag ? found : found.from_second();
}

double PairHistory::bulge(tagint tag) const
{
  const auto found = std::lower_bound(bulges.begin(), bulges.end(), std::pair(tag, -1.0));
  return found != bulges.end() && found->first == tag ? found->second : -1.0;
}

double PairList::memory_usage() const
{
  return pairs.bytes() + remote_sides.bytes() +
         bytes_of(bulge, rank_of, x_then, bulge_then, radius_then, first_wall, columns, tags,
                  remote_tags, candidates, knows_films, at_walls);
}

}    // namespace deformable
