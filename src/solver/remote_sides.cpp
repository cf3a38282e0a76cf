#include "solver/remote_sides.h"

#include "styles/all_ranks.h"

#include "atom.h"
#include "comm.h"

#include <algorithm>

using namespace LAMMPS_NS;

double RemoteSides::sum(double of_this_rank) const
{
  return comm->nprocs == 1 ? of_this_rank : sum_of_ranks(world, of_this_rank);
}

double RemoteSides::largest(double of_this_rank) const
{
  return comm->nprocs == 1 ? of_this_rank : largest_of_ranks(world, of_this_rank);
}

bool RemoteSides::all_ranks_sufficient(bool sufficient, bool &refused) const
{
  enum { SUFFICIENT, INSUFFICIENT, REFUSED };
  int here = refused ? REFUSED : sufficient ? SUFFICIENT : INSUFFICIENT;
  int worst = here;
  if (comm->nprocs > 1) MPI_Allreduce(&here, &worst, 1, MPI_INT, MPI_MAX, world);
  refused = worst == REFUSED;
  return worst == SUFFICIENT;
}

void RemoteSides::to_ghosts(std::vector<double> &by_particle)
{
  const int all = atom->nlocal + atom->nghost;
  by_particle.resize(all);
  std::vector<double *> each(all);    // `rows` are those of pairs
  for (int i = 0; i < all; ++i) each[i] = &by_particle[i];
  comm->forward_comm_array(1, each.data());
}

// Particles of this rank without a pair on another rank need no row of their own: they share the first one.
void RemoteSides::set_rows(int values)
{
  const int all = atom->nlocal + atom->nghost, length = slots * values;
  int used = 1;
  for (int i = 0; i < atom->nlocal; ++i) used += sides[i] > 0;
  buffer.assign(static_cast<std::size_t>(used + atom->nghost) * length, 0.0);
  rows.resize(all);
  double *next = buffer.data() + length;
  for (int i = 0; i < all; ++i) {
    const bool own_row = i >= atom->nlocal || sides[i] > 0;
    rows[i] = own_row ? next : buffer.data();
    if (own_row) next += length;
  }
}

void RemoteSides::match(std::vector<Candidate> &candidates, bool curved)
{
  enum { PARTNER, X, Y, Z, PAST };
  constexpr int SERIES = 4;    // numbers of a PairPast::Series
  const int kinds = curved ? KINDS : 1, values = PAST + SERIES * kinds;
  constexpr double ROUNDING = 1e-12;
  const auto square = [](double x) { return x * x; };
  const auto at = [this](int row, int slot, int value) -> double & {
    return rows[row][value * slots + slot];
  };
  const int count = static_cast<int>(candidates.size());

  sides.assign(atom->nlocal, 0);
  int longest = 1;
  for (const Candidate &c : candidates) longest = std::max(longest, ++sides[c.i]);
  slots = largest_of_ranks(world, longest);
  set_rows(values);

  std::vector<int> slot_here(count), slot_there;
  std::fill(sides.begin(), sides.end(), 0);
  for (int c = 0; c < count; ++c) {
    const Candidate &pair = candidates[c];
    const int i = pair.i, slot = slot_here[c] = sides[i]++;
    at(i, slot, PARTNER) = static_cast<double>(atom->tag[pair.j]);
    at(i, slot, X) = pair.x.x;
    at(i, slot, Y) = pair.x.y;
    at(i, slot, Z) = pair.x.z;
    for (int kind = 0; kind < kinds; ++kind) {
      const PairPast::Series &series = pair.past.of[kind];
      at(i, slot, PAST + SERIES * kind) = series.last;
      for (int n = 0; n < 3; ++n) at(i, slot, PAST + SERIES * kind + 1 + n) = series.earlier[n];
    }
  }
  comm->forward_comm_array(slots * values, rows.data());

  int kept = 0;
  for (int c = 0; c < count; ++c) {
    Candidate pair = candidates[c];
    double nearest = ROUNDING * dot(pair.x, pair.x);
    int found = -1;
    const int j = pair.j;
    for (int slot = 0; slot < slots; ++slot) {
      if (at(j, slot, PARTNER) != static_cast<double>(atom->tag[pair.i])) continue;
      const double distance2 = square(at(j, slot, X) + pair.x.x) +
                               square(at(j, slot, Y) + pair.x.y) +
                               square(at(j, slot, Z) + pair.x.z);
      if (distance2 >= nearest) continue;
      nearest = distance2;
      found = slot;
    }
    if (found < 0) continue;    // by rounding at the end of the list: too far to bear a force
    if (pair.past.of[FORCE].last == deformable::UNKNOWN) {
      PairPast there;
      for (int kind = 0; kind < kinds; ++kind) {
        PairPast::Series &series = there.of[kind];
        series.last = at(j, found, PAST + SERIES * kind);
        for (int n = 0; n < 3; ++n) series.earlier[n] = at(j, found, PAST + SERIES * kind + 1 + n);
      }
      pair.past = there.from_second();
    }
    candidates[kept] = pair;
    slot_here[kept++] = slot_here[c];
    slot_there.push_back(found);
  }
  candidates.resize(kept);

  set_rows(2);
  sent.resize(kept);
  received.resize(kept);
  for (int c = 0; c < kept; ++c) {
    sent[c] = rows[candidates[c].i] + slot_here[c];
    received[c] = rows[candidates[c].j] + slot_there[c];
  }
}

template <class Number, class Other>
void RemoteSides::exchange(Number *values, Other *more, const int *of_pairs, int end)
{
  if (comm->nprocs == 1) return;
  const int count = static_cast<int>(sent.size());
  for (int c = 0; c < count; ++c) {
    sent[c][0] = values[of_pairs[c]];
    if (more) sent[c][slots] = more[of_pairs[c]];
  }
  comm->forward_comm_array(more ? 2 * slots : slots, rows.data());
  for (int c = 0; c < count; ++c) {
    values[end + c] = static_cast<Number>(received[c][0]);
    if (more) more[end + c] = static_cast<Other>(received[c][slots]);
  }
}

template void RemoteSides::exchange(double *, double *, const int *, int);
template void RemoteSides::exchange(double *, float *, const int *, int);
template void RemoteSides::exchange(float *, float *, const int *, int);
