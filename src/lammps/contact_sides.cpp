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

// From each rank's particles to their ghosts. On a single rank mirrors leave these out.
void ContactSides::exchange(SideValues &values)
{
  if (comm->nprocs == 1 && !facing) return;
  comm->forward_comm_array(stride, values.row.data());
}

/* ----------------------------------------------------------------------
   the other side of each: two particles of a small box meet more than once,
   perhaps in one direction, but not in one place
------------------------------------------------------------------------- */

void ContactSides::face(const ContactTable &table)
{
  const std::vector<Known> known = recall();

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
  for (SideValues *values : {&shifts, &before, &earlier, &partners, &xs, &ys, &weight, &owner})
    values->reset(rows, stride);
  tags.assign(atom->tag, atom->tag + nlocal);
  for (int i = 0; i < nlocal; ++i)
    for (int c = 0; c < count[i]; ++c) {
      const int k = side(i, c);
      const Partner &seen = table.partner[table.first(i) + c];
      const tagint partner = atom->tag[seen.atom];
      const double distance = 1.0 / seen.per_lever;
      partners[k] = static_cast<double>(partner);
      xs[k] = table.of(i)[c].nx * distance;
      ys[k] = table.of(i)[c].ny * distance;
      double nearest = distance * distance;
      const auto [first, last] = std::equal_range(known.begin(), known.end(),
                                                  Known{tags[i], partner, 0.0, 0.0, 0.0, 0.0, 0.0});
      for (auto candidate = first; candidate != last; ++candidate) {
        const double apart = square(candidate->x - xs[k]) + square(candidate->y - ys[k]);
        if (apart >= nearest) continue;
        nearest = apart;
        weight[k] = 1.0;
        shifts[k] = candidate->shift;
        before[k] = candidate->before;
        earlier[k] = candidate->earlier;
      }
    }
  for (int i = 0; i < nlocal; ++i) owner[side(i, 0)] = i;
  facing = true;
  for (SideValues *values : {&owner, &partners, &xs, &ys, &weight, &shifts, &before, &earlier})
    exchange(*values);
  facing = false;

  mirror.resize(static_cast<std::size_t>(nlocal) * stride);
  for (int i = 0; i < nlocal; ++i)
    for (int c = 0; c < count[i]; ++c) {
      const int k = side(i, c), j = table.partner[table.first(i) + c].atom;
      mirror[k] = k;
      double nearest = square(xs[k]) + square(ys[k]);
      for (int m = side(j, 0); m < side(j, stride); ++m) {
        if (partners[m] != static_cast<double>(tags[i])) continue;
        const double apart = square(xs[m] + xs[k]) + square(ys[m] + ys[k]);
        if (apart >= nearest) continue;
        nearest = apart;
        mirror[k] = comm->nprocs == 1 ? m + side(static_cast<int>(owner[side(j, 0)]) - j, 0) : m;
      }
    }

  // what either of both sides recalls
  std::vector<double> common(mirror.size(), 0.0);
  for (SideValues *values : {&shifts, &before, &earlier}) {
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
  for (const SideValues *values : {&shifts, &before, &earlier, &partners, &xs, &ys})
    bytes += values->bytes();
  return bytes;
}

/* ---------------------------------------------------------------------- */

std::vector<ContactSides::Known> ContactSides::recall()
{
  std::vector<Known> known;
  for (int i = 0; i < static_cast<int>(count.size()); ++i)
    for (int k = side(i, 0); k < side(i, count[i]); ++k)
      if (shifts[k] != 0.0)
        known.push_back({tags[i], static_cast<tagint>(partners[k]), xs[k], ys[k], shifts[k],
                         before[k], earlier[k]});
  std::sort(known.begin(), known.end());
  return known;
}
