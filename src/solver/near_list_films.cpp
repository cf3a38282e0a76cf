// Which pairs are attached by a film, from list to list.

#include "solver/near_list.h"

#include "atom.h"

#include <cmath>

using namespace LAMMPS_NS;

static double adhesion_of(const DeformableParticles &p, int code)
{
  const std::vector<FixDeformableWall *> &walls = *p.walls;
  return walls[(-1 - code) % static_cast<int>(walls.size())]->adhesion();
}

void NearList::set_sticking(const DeformableParticles &p)
{
  for (int k = 0; k < pairs.size; ++k)
    pairs.sticking[k] = k < pairs.wall
                            ? p.adhesions->between(atom->type[pairs.i[k]], atom->type[pairs.j[k]])
                            : adhesion_of(p, pairs.j[k]);
}

// What the particles know; of a particle that is new, whether the circles overlap.
bool NearList::is_attached(const DeformableParticles &p, int i, int j, double x, double y) const
{
  if (!(p.adhesions->between(atom->type[i], atom->type[j]) > 0.0)) return false;
  if (p.films->is_attached(i, atom->tag[j], x, y)) return true;
  if (knows_films[i] != 0.0 && knows_films[j] != 0.0) return false;
  const double touch = p.radius[i] + p.radius[j];
  return x * x + y * y < touch * touch;
}

// Both ranks of a pair: where circles just touch, rounding of a ghost's position decides.
void NearList::recall_films(const DeformableParticles &p)
{
  const double *const *const x = atom->x;
  for (int k = 0; k < pairs.wall; ++k) {
    const int i = pairs.i[k], j = pairs.j[k];
    pairs.attached[k] = is_attached(p, i, j, x[j][0] - x[i][0], x[j][1] - x[i][1]);
  }
  for (int k = pairs.wall; k < pairs.size; ++k)
    pairs.attached[k] = at_walls[k - pairs.wall] && pairs.sticking[k] > 0.0;
}

void NearList::store_films(const DeformableParticles &p) const
{
  const double *const *const x = atom->x;
  p.films->forget(*p.list);
  for (int k = 0; k < pairs.size; ++k) {
    if (!pairs.attached[k]) continue;
    const int i = pairs.i[k], j = pairs.j[k];
    if (k >= pairs.wall) {
      p.films->attach(i, j, 0.0, 0.0);
      continue;
    }
    const double dx = x[j][0] - x[i][0], dy = x[j][1] - x[i][1];
    p.films->attach(i, atom->tag[j], dx, dy);
    if (k < pairs.remote) p.films->attach(pairs.second(k), atom->tag[i], -dx, -dy);
  }
}
