#include "contact_sides.h"

#include "atom.h"
#include "comm.h"

#include <algorithm>

using namespace LAMMPS_NS;

namespace {

double square(double x)
{
  return x * x;
}

}    // namespace

void SideValues::reset(int rows, int stride)
{
  value.assign(static_cast<std::size_t>(rows) * stride, 0.0);
  row.resize(rows);
  for (int r = 0; r < rows; ++r) row[r] = value.data() + static_cast<std::size_t>(r) * stride;
}

// From each rank's particles to their ghosts. On a single rank the mirror of a side is never a ghost's, so that
// only match_sides needs this.
void ContactSides::exchange(SideValues &values)
{
  if (comm->nprocs == 1 && !matching) return;
  comm->forward_comm_array(stride, values.row.data());
}

/* ----------------------------------------------------------------------
   Finds the mirror of each side. In a small box two particles may have several
   contacts, even in one direction, but each at another relative position. At
   the end of the neighbor list a side may lack its mirror, by rounding.
------------------------------------------------------------------------- */

void ContactSides::match_sides(const ContactTable &table)
{
  const std::vector<OldSide> old = old_sides();

  const int nlocal = atom->nlocal, rows = nlocal + atom->nghost;
  count.assign(nlocal, 0);
  int longest = 1;
  for (int i = 0; i < nlocal; ++i) {
    const deformable::Contacts contacts = table.of(i);
    while (count[i] < contacts.size && table.partner[table.first(i) + count[i]].atom >= 0)
      ++count[i];
    longest = std::max(longest, count[i]);
  }
  MPI_Allreduce(&longest, &stride, 1, MPI_INT, MPI_MAX, world);

  SideValues weight, owner;
  for (SideValues *values :
       {&shifts, &last_shifts, &second_last_shifts, &partners, &xs, &ys, &weight, &owner})
    values->reset(rows, stride);
  tags.assign(atom->tag, atom->tag + nlocal);
  for (int i = 0; i < nlocal; ++i)
    for (int c = 0; c < count[i]; ++c) {
      const int k = side(i, c);
      const Partner &other = table.partner[table.first(i) + c];
      const tagint partner = atom->tag[other.atom];
      const double distance = 1.0 / other.per_lever;
      partners[k] = static_cast<double>(partner);
      xs[k] = table.of(i)[c].nx * distance;
      ys[k] = table.of(i)[c].ny * distance;
      double nearest = distance * distance;
      const auto [first, last] = std::equal_range(
          old.begin(), old.end(), OldSide{tags[i], partner, 0.0, 0.0, 0.0, 0.0, 0.0});
      for (auto candidate = first; candidate != last; ++candidate) {
        const double distance2 = square(candidate->x - xs[k]) + square(candidate->y - ys[k]);
        if (distance2 >= nearest) continue;
        nearest = distance2;
        weight[k] = 1.0;
        shifts[k] = candidate->shift;
        last_shifts[k] = candidate->last_shift;
        second_last_shifts[k] = candidate->second_last_shift;
      }
    }
  for (int i = 0; i < nlocal; ++i) owner[side(i, 0)] = i;
  matching = true;
  for (SideValues *values :
       {&owner, &partners, &xs, &ys, &weight, &shifts, &last_shifts, &second_last_shifts})
    exchange(*values);
  matching = false;

  constexpr double ROUNDING = 1e-12;
  mirror.resize(static_cast<std::size_t>(nlocal) * stride);
  for (int i = 0; i < nlocal; ++i)
    for (int c = 0; c < count[i]; ++c) {
      const int k = side(i, c), j = table.partner[table.first(i) + c].atom;
      mirror[k] = k;
      double nearest = ROUNDING * (square(xs[k]) + square(ys[k]));
      for (int m = side(j, 0); m < side(j, stride); ++m) {
        if (partners[m] != static_cast<double>(tags[i])) continue;
        const double distance2 = square(xs[m] + xs[k]) + square(ys[m] + ys[k]);
        if (distance2 >= nearest) continue;
        nearest = distance2;
        mirror[k] = comm->nprocs == 1 ? m + side(static_cast<int>(owner[side(j, 0)]) - j, 0) : m;
      }
    }

  // the mean of what both sides have kept; a new side has kept nothing
  std::vector<double> common(mirror.size(), 0.0);
  for (SideValues *values : {&shifts, &last_shifts, &second_last_shifts}) {
    for (int i = 0; i < nlocal; ++i)
      for (int k = side(i, 0); k < side(i, count[i]); ++k) {
        const double sum = weight[k] + weight[mirror[k]];
        common[k] = sum > 0.0 ? ((*values)[k] - (*values)[mirror[k]]) / sum : 0.0;
      }
    std::copy(common.begin(), common.end(), values->value.begin());
  }
}

/* ---------------------------------------------------------------------- */

double ContactSides::memory_usage() const
{
  double bytes = bytes_of(count, mirror, tags);
  for (const SideValues *values : {&shifts, &last_shifts, &second_last_shifts, &partners, &xs, &ys})
    bytes += values->bytes();
  return bytes;
}

/* ---------------------------------------------------------------------- */

std::vector<ContactSides::OldSide> ContactSides::old_sides()
{
  std::vector<OldSide> old;
  for (int i = 0; i < static_cast<int>(count.size()); ++i)
    for (int k = side(i, 0); k < side(i, count[i]); ++k)
      if (shifts[k] != 0.0)
        old.push_back({tags[i], static_cast<tagint>(partners[k]), xs[k], ys[k], shifts[k],
                       last_shifts[k], second_last_shifts[k]});
  std::sort(old.begin(), old.end());
  return old;
}
