// The keywords of fix deformable/wall, and its variables.

#include "styles/walls/fix_deformable_wall.h"

#include "styles/lammps_release.h"

#include "laws/parameter_rules.h"

#include "error.h"
#include "modify.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

using namespace LAMMPS_NS;

static constexpr const char *KEYWORDS[] = {"adhesion", "shear", "load"};

/* ----------------------------------------------------------------------
   They come last. Returns the number of words before them.
------------------------------------------------------------------------- */

int FixDeformableWall::read_keywords(int narg, char **arg)
{
  const auto is_keyword = [&](const char *word) {
    return std::any_of(std::begin(KEYWORDS), std::end(KEYWORDS),
                       [&](const char *keyword) { return std::strcmp(word, keyword) == 0; });
  };
  int words = 4;    // a region may be called adhesion
  while (words < narg && !is_keyword(arg[words])) ++words;
  for (int iarg = words; iarg < narg;) {
    if (!is_keyword(arg[iarg]))
      error->all(FLERR_WORD(iarg),
                 "Fix {} deformable/wall: unknown word '{}' after {}: only adhesion w, shear dim v "
                 "and load F m come last",
                 id, arg[iarg], arg[words]);
    for (int before = words; before < iarg; ++before)
      if (!std::strcmp(arg[before], arg[iarg]))
        error->all(FLERR_WORD(iarg), "Fix {} deformable/wall: {} is there twice", id, arg[iarg]);
    iarg = read_keyword(iarg, narg, arg);
  }
  return words;
}

// Returns the place of what follows it.
int FixDeformableWall::read_keyword(int iarg, int narg, char **arg)
{
  const std::string keyword = arg[iarg];
  const int values = keyword == "adhesion" ? 1 : 2;
  if (iarg + values >= narg)
    utils::missing_cmd_args(FLERR, "fix deformable/wall " + keyword, error);
  const char *const first = arg[iarg + 1];
  if (keyword == "adhesion") {
    stickiness = utils::numeric(FLERR, first, false, lmp);
    require(deformable::invalid_adhesion(stickiness));
    if (dimension == 3 && stickiness > 0.0)
      error->all(FLERR_WORD(iarg + 1),
                 "Fix {} deformable/wall: droplets in three dimensions do not stick to walls: use "
                 "adhesion 0, not {}",
                 id, first);
  } else if (keyword == "shear") {
    if (dimension == 3)
      error->all(FLERR_WORD(iarg),
                 "Fix {} deformable/wall: shear moves nothing in three dimensions, where droplets "
                 "slip along walls without friction",
                 id);
    shear.axis = first[0] - 'x';
    if (std::strlen(first) != 1 || shear.axis < 0 || shear.axis > 1)
      error->all(FLERR_WORD(iarg + 1), "Fix {} deformable/wall: shear goes along x or y, not '{}'",
                 id, first);
    require(shear.speed.read("shear", arg[iarg + 2], lmp));
  } else {
    require(load.force.read("load", first, lmp));
    load.mass = utils::numeric(FLERR, arg[iarg + 2], false, lmp);
    if (!(load.mass > 0.0) || !std::isfinite(load.mass))
      error->all(FLERR_WORD(iarg + 2),
                 "Fix {} deformable/wall: the mass of a wall under a load must be positive and "
                 "finite, not {}",
                 id, arg[iarg + 2]);
  }
  return iarg + values + 1;
}

/* ----------------------------------------------------------------------
   Whether the walls are such as can slide, or bear a load.
------------------------------------------------------------------------- */

void FixDeformableWall::check_keywords(WallSources &given) const
{
  if (load.mass > 0.0) {
    const bool one = given.walls.size() == 1 && given.shapes[0].side.sign != 0;
    if (!one || given.shapes[0].moves())
      error->all(
          FLERR,
          "Fix {} deformable/wall: load needs one side, such as zhi 20, with the number where "
          "it begins: give other walls fixes of their own",
          id);
    given.shapes[0].side.is_loaded = true;
  }
  given.slide = shear.axis >= 0;
  for (const WallSource &wall : given.walls) {
    if (shear.axis < 0) break;
    const bool straight = wall.kind == WallSource::FACE;
    const WallShape &shape = given.shapes[wall.shape];
    const deformable::HalfPlane *const face =
        straight ? &shape.planes[wall.sides[0].plane] : nullptr;
    if (!straight || std::fabs(shear.axis == 0 ? face->nx : face->ny) > 1e-12 ||
        (shape.region && shape.region->rotateflag))
      error->all(FLERR,
                 "Fix {} deformable/wall: '{}' cannot slide along {}, as sides and planes along it "
                 "do: give it a fix of its own without shear, or a region that rotates",
                 id, wall.name, "xy"[shear.axis]);
  }
}

/* ---------------------------------------------------------------------- */

std::vector<WallVariable *> FixDeformableWall::variables()
{
  std::vector<WallVariable *> found = {&shear.speed, &load.force};
  for (WallShape &shape : sources().shapes) found.push_back(&shape.side.place);
  found.erase(std::remove_if(found.begin(), found.end(),
                             [](const WallVariable *variable) { return !variable->varies(); }),
              found.end());
  return found;
}

void FixDeformableWall::end_of_step()
{
  evaluate_at_the_end();
}

void FixDeformableWall::evaluate_at_the_end()
{
  const std::vector<WallVariable *> all = variables();
  if (std::none_of(all.begin(), all.end(), [](const WallVariable *v) { return v->waits(); }))
    return;
  modify->clearstep_compute();
  for (WallVariable *variable : all) require(variable->end_step(lmp));
  modify->addstep_compute(update->ntimestep + 1);
}

// Minimizers need the wall from their first energy on.
void FixDeformableWall::check_places()
{
  for (const WallShape &shape : sources().shapes)
    if (shape.side.sign != 0 && !shape.side.place.is_known())
      error->all(FLERR,
                 "Fix {} deformable/wall: the place of {} depends on what computes, fixes or "
                 "thermo keywords find in a run: use 'run 0' before minimize",
                 id, shape.name);
}
