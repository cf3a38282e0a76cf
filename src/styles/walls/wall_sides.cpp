// Walls at the sides of the box: xlo place, where the place is a number, EDGE or a variable v_name.

#include "styles/walls/wall_shapes.h"

#include "domain.h"
#include "lammps.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
  shape.side.is_edge = place == "EDGE";
  const double n[3] = {shape.side.axis == 0 ? shape.side.sign : 0.0,
                       shape.side.axis == 1 ? shape.side.sign : 0.0,
                       shape.side.axis == 2 ? shape.side.sign : 0.0};
  if (dimension == 2)
    shape.planes.push_back({n[0], n[1], 0.0});
  else
    shape.spaces.push_back({{n[0], n[1], n[2]}, 0.0});
  std::string problem = shape.side.is_edge ? "" : shape.side.place.read(word, place, lmp);
  if (problem.empty()) problem = shape.place_side(lmp);
  if (!problem.empty()) return problem;
  const int index = static_cast<int>(shapes.size());
  walls.push_back({WallSource::FACE, word, {{index, 0, false}}, index});
  shapes.push_back(shape);
  return "";
}

std::string WallShape::place_side(LAMMPS *lmp)
{
  if (side.is_edge) {
    if (lmp->domain->triclinic)
      return name + " EDGE: a side of a tilted box is no plane across an axis, use 'plane'";
    side.place.now = side.sign < 0 ? lmp->domain->boxlo[side.axis] : lmp->domain->boxhi[side.axis];
  }
  const double offset =
      side.place.is_known() ? side.sign * side.place.now : std::numeric_limits<double>::infinity();
  (planes.empty() ? spaces[0].offset : planes[0].offset) = offset;
  return "";
}

bool WallSources::move() const
{
  return slide || std::any_of(shapes.begin(), shapes.end(),
                              [](const WallShape &shape) { return shape.moves(); });
}

std::string WallSources::place_sides(LAMMPS *lmp, bool goes_on)
{
  for (WallShape &shape : shapes) {
    if (shape.side.sign == 0) continue;
    std::string problem = shape.side.place.begin_step(lmp, goes_on);
    if (problem.empty()) problem = shape.place_side(lmp);
    if (!problem.empty()) return problem;
  }
  return "";
}
