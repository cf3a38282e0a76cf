// Walls at the sides of the box: xlo place, where the place is a number, EDGE or a variable v_name.

#include "wall_shapes.h"

#include "domain.h"
#include "input.h"
#include "lammps.h"
#include "utils.h"
#include "variable.h"

#include <cmath>

using namespace LAMMPS_NS;

bool WallSources::is_side(const std::string &word)
{
  return word.size() == 3 && word[0] >= 'x' && word[0] <= 'z' &&
         (word.substr(1) == "lo" || word.substr(1) == "hi");
}

std::string WallSources::add_side(const std::string &word, const std::string &place, LAMMPS *lmp)
{
  WallShape shape;
  shape.name = word;
  shape.side.axis = word[0] - 'x';
  shape.side.sign = word[1] == 'l' ? -1 : 1;
  const double sign = shape.side.sign;
  const int axis = shape.side.axis;
  shape.spaces.push_back(
      {{axis == 0 ? sign : 0.0, axis == 1 ? sign : 0.0, axis == 2 ? sign : 0.0}, 0.0});
  if (place == "EDGE" || utils::strmatch(place, "^v_")) {
    shape.side.place = place;
    const std::string problem = shape.place_side(lmp);
    if (!problem.empty()) return problem;
  } else {
    shape.spaces[0].offset = sign * utils::numeric(FLERR, place, false, lmp);
    if (!std::isfinite(shape.spaces[0].offset)) return word + ": '" + place + "' is not finite";
  }
  const int index = static_cast<int>(shapes.size());
  walls.push_back({WallSource::FACE, word, {{index, 0, false}}, index});
  shapes.push_back(shape);
  return "";
}

std::string WallShape::place_side(LAMMPS *lmp)
{
  double at;
  if (side.place == "EDGE") {
    if (lmp->domain->triclinic)
      return name + " EDGE: a side of a tilted box is no plane across an axis, use 'plane'";
    at = side.sign < 0 ? lmp->domain->boxlo[side.axis] : lmp->domain->boxhi[side.axis];
  } else {
    Variable &variables = *lmp->input->variable;
    const int found = variables.find(side.place.substr(2).c_str());
    if (found < 0) return name + ": variable '" + side.place.substr(2) + "' does not exist";
    if (!variables.equalstyle(found))
      return name + ": variable '" + side.place.substr(2) + "' must be equal-style";
    at = variables.compute_equal(found);
    if (!std::isfinite(at)) return fmt::format("{}: its place '{}' is {}", name, side.place, at);
  }
  spaces[0].offset = side.sign * at;
  return "";
}
