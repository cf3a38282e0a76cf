#include "contact_table.h"

#include <algorithm>
#include <numeric>

using namespace LAMMPS_NS;

void ContactTable::clear(int nlocal)
{
  row.assign(nlocal, -1);
  free_rows.resize(count.size());
  std::iota(free_rows.begin(), free_rows.end(), 0);
}

// Gives the particle a row if it has none, and doubles all rows if its own is full.
void ContactTable::make_room(int i)
{
  if (row[i] < 0) {
    if (free_rows.empty()) {
      free_rows.push_back(static_cast<int>(count.size()));
      count.push_back(0);
      contact.resize(count.size() * stride);
      partner.resize(count.size() * stride);
    }
    row[i] = free_rows.back();
    free_rows.pop_back();
    count[row[i]] = 0;
  } else if (count[row[i]] == stride) {
    const std::size_t before = stride;
    stride *= 2;
    contact.resize(count.size() * stride);
    partner.resize(count.size() * stride);
    for (std::size_t r = count.size(); r-- > 1;) {
      std::copy_n(&contact[r * before], before, &contact[r * stride]);
      std::copy_n(&partner[r * before], before, &partner[r * stride]);
    }
  }
}

void ContactTable::add(int i, const deformable::Contact &new_contact, const Partner &with)
{
  make_room(i);
  const std::size_t c = first(i) + count[row[i]]++;
  contact[c] = new_contact;
  partner[c] = with;
}
