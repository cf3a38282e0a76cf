#include "contact_memory.h"

#include "vector_bytes.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;

static_assert(sizeof(RememberedContact) == RememberedContact::SIZE * sizeof(double));

RememberedContact *ContactMemory::find(int i, double partner, const ContactPlace &place,
                                       bool own_image)
{
  const auto square = [](double x, double y) { return x * x + y * y; };
  double nearest = square(place.x, place.y);
  RememberedContact *found = nullptr;
  for (RememberedContact &c : rows[i]) {
    if (c.partner != partner) continue;
    double distance = square(c.place.x - place.x, c.place.y - place.y);
    if (own_image) distance = std::min(distance, square(c.place.x + place.x, c.place.y + place.y));
    if (distance > nearest) continue;
    nearest = distance;
    found = &c;
  }
  return found;
}

RememberedContact &ContactMemory::add(int i, double partner, double kt, const ContactPlace &place)
{
  RememberedContact contact = {};
  contact.partner = partner;
  contact.kt = kt;
  contact.place = place;
  rows[i].push_back(contact);
  return rows[i].back();
}

int ContactMemory::pack(int i, double *buffer) const
{
  const int n = size(i);
  buffer[0] = n;
  std::memcpy(buffer + 1, rows[i].data(), (n - 1) * sizeof(double));
  return n;
}

int ContactMemory::unpack(int i, const double *buffer)
{
  const int n = static_cast<int>(buffer[0]);
  rows[i].resize((n - 1) / RememberedContact::SIZE);
  std::memcpy(rows[i].data(), buffer + 1, (n - 1) * sizeof(double));
  return n;
}

double ContactMemory::bytes() const
{
  double sum = bytes_of(rows);
  for (const std::vector<RememberedContact> &row : rows) sum += bytes_of(row);
  return sum;
}
