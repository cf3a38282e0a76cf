#include "solver/adhesions.h"

#include "utils.h"

#include <algorithm>

using namespace LAMMPS_NS;

void Adhesions::set(std::size_t i, std::size_t j, double adhesion)
{
  values[i * types + j] = values[j * types + i] = adhesion;
}

void Adhesions::update()
{
  adhesive = std::any_of(values.begin(), values.end(), [](double w) { return w != 0.0; });
  std::copy_n(values.begin(), written.size(), written.begin());
}

void Adhesions::assign(const std::vector<Species> &species, const std::vector<Adhesion> &known)
{
  types = species.size();
  values.assign(types * types, 0.0);
  for (std::size_t i = 1; i < types; ++i)
    for (std::size_t j = i; j < types; ++j)
      for (const Adhesion &a : known)
        if (a.is_of(species[i].name, species[j].name)) set(i, j, a.energy);
  update();
}

double **Adhesions::array()
{
  if (types == 0) return nullptr;
  written.resize(types * types);
  rows.resize(types);
  for (std::size_t i = 0; i < types; ++i) rows[i] = written.data() + i * types;
  update();
  return rows.data();
}

bool Adhesions::take()
{
  bool changed = false;
  for (std::size_t i = 1; i < rows.size(); ++i)
    for (std::size_t j = i; j < rows.size(); ++j) {
      if (rows[i][j] == between(i, j)) continue;
      set(i, j, rows[i][j]);
      changed = true;
    }
  if (changed) update();
  return changed;
}

std::string Adhesions::problem(const std::vector<Species> &species) const
{
  for (std::size_t i = 1; i < types; ++i)
    for (std::size_t j = i; j < types; ++j) {
      const std::string wrong = invalid_adhesion(between(i, j), species[i], species[j]);
      if (!wrong.empty()) return fmt::format("Types {} and {}: {}", i, j, wrong);
    }
  return "";
}
