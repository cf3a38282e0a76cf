#include "styles/species_ramps.h"

#include "utils.h"

#include <cstring>

using namespace LAMMPS_NS;
using deformable::PARAMETERS;

double **SpeciesRamps::array_of(const char *name, const std::vector<Species> &species)
{
  for (std::size_t k = 0; k < arrays.size(); ++k) {
    if (!PARAMETERS[k].name || std::strcmp(name, PARAMETERS[k].name) != 0) continue;
    Array &a = arrays[k];
    const std::size_t types = species.size();
    a.values.resize(types * types);
    a.rows.resize(types);
    for (std::size_t i = 0; i < types; ++i) a.rows[i] = a.values.data() + i * types;
    fill(species);
    return a.rows.data();
  }
  return nullptr;
}

void SpeciesRamps::fill(const std::vector<Species> &species)
{
  for (std::size_t k = 0; k < arrays.size(); ++k)
    for (std::size_t i = 0; i < arrays[k].rows.size(); ++i)
      for (std::size_t j = 0; j < arrays[k].rows.size(); ++j)
        arrays[k].rows[i][j] = species[i].stiffness.*PARAMETERS[k].of_ring;
}

// Wildcards of fix adapt write the value of a type to its pairs with others too.
std::string SpeciesRamps::of_two_types(const std::vector<Species> &species) const
{
  for (std::size_t k = 0; k < arrays.size(); ++k) {
    const std::vector<double *> &rows = arrays[k].rows;
    for (std::size_t i = 1; i < rows.size(); ++i)
      for (std::size_t j = i + 1; j < rows.size(); ++j) {
        const double value = rows[i][j];
        if (value != species[i].stiffness.*PARAMETERS[k].of_ring && value != rows[i][i] &&
            value != rows[j][j])
          return fmt::format("{} of types {} and {}", PARAMETERS[k].name, i, j);
      }
  }
  return "";
}

int SpeciesRamps::take(std::vector<Species> &species) const
{
  int first = 0;
  for (std::size_t k = 0; k < arrays.size(); ++k)
    for (std::size_t i = arrays[k].rows.size(); i-- > 1;) {
      if (species[i].name.empty()) continue;
      double &value = species[i].stiffness.*PARAMETERS[k].of_ring;
      if (value == arrays[k].rows[i][i]) continue;
      value = arrays[k].rows[i][i];
      if (first == 0) first = static_cast<int>(i);
    }
  return first;
}
