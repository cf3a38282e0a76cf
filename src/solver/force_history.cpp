#include "solver/force_history.h"

using namespace LAMMPS_NS;

PastForces ForceHistory::find(tagint tag, tagint partner, double x, double y, double z) const
{
  const Entry wanted = entry_of(tag, partner, x, y, z, {});
  const auto [first, last] = std::equal_range(entries.begin(), entries.end(), wanted);
  PastForces found;
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

double ForceHistory::bulge(tagint tag) const
{
  const auto found = std::lower_bound(bulges.begin(), bulges.end(), std::pair(tag, -1.0));
  return found != bulges.end() && found->first == tag ? found->second : -1.0;
}
