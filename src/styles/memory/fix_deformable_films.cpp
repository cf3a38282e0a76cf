#include "styles/memory/fix_deformable_films.h"

#include "domain.h"
#include "neigh_list.h"

#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace deformable;

FixDeformableFilms::FixDeformableFilms(LAMMPS *lmp, int narg, char **arg)
    : FixPartnerMemory(lmp, narg, arg, STYLE)
{
  if (narg != 3) error->all(FLERR, "Fix deformable/films has no arguments");
  scalar_flag = extscalar = global_freq = ecouple_flag = 1;
  begin();
}

/* ----------------------------------------------------------------------
   fix_modify deformable_films attached none, or attached I J ...: IDs of
   particles, or the code < 0 of a wall
------------------------------------------------------------------------- */

int FixDeformableFilms::modify_param(int narg, char **arg)
{
  constexpr double NEAREST = std::numeric_limits<double>::quiet_NaN();
  if (std::string(arg[0]) != "attached" || narg < 2) return 0;
  follow();
  if (narg == 2 && std::string(arg[1]) == "none") {
    forget();
    return 2;
  }
  const std::string command = fmt::format("fix_modify {} attached", id);
  if (narg % 2 == 0)
    error->all(FLERR, "{}: expected 'none', or two IDs for each pair, not {} words", command,
               narg - 1);
  std::vector<double> partners;
  for (int n = 1; n < narg; ++n)
    partners.push_back(static_cast<double>(utils::tnumeric(FLERR, arg[n], false, lmp)));
  require_partners(partners, command);
  const std::unordered_map<double, int> here = local_indices();
  for (std::size_t n = 0; n < partners.size(); ++n) {
    const auto found = here.find(partners[n]);
    if (found != here.end())
      attach(found->second, static_cast<tagint>(partners[n ^ 1]), {NEAREST, NEAREST, NEAREST});
  }
  return narg;
}

void FixDeformableFilms::who_knows(std::vector<double> &knows) const
{
  knows.resize(atom->nlocal);
  for (int i = 0; i < atom->nlocal; ++i) knows[i] = particles[i].is_known;
}

// How many other images of what is there are nearer.
int FixDeformableFilms::nearer_images(const Vector3 &at) const
{
  const double *const h = domain->h;
  const auto last = [](bool periodic) { return periodic ? 1 : 0; };
  const int nx = last(domain->xperiodic), ny = last(domain->yperiodic),
            nz = last(domain->zperiodic);
  int count = 0;
  for (int a = -nx; a <= nx; ++a)
    for (int b = -ny; b <= ny; ++b)
      for (int c = -nz; c <= nz; ++c) {
        const Vector3 other = {at.x + a * h[0] + b * h[5] + c * h[4], at.y + b * h[1] + c * h[3],
                               at.z + c * h[2]};
        count += dot(other, other) < (1.0 - 1e-9) * dot(at, at);
      }
  return count;
}

// A particle in a small box may have several images of its partner: the one that has moved by less than half of the box, or the nearest
// ones, as many as there are such films.
bool FixDeformableFilms::is_attached(int i, tagint partner, const Vector3 &at) const
{
  const double *const h = domain->h_inv;
  const auto is_near = [](bool periodic, double part) {
    return !periodic || std::fabs(part) <= 0.5;
  };
  int of_nearest = 0;
  for (const RememberedFilm &film : particles[i].rows) {
    if (film.partner != static_cast<double>(partner)) continue;
    if (partner < 0) return true;
    if (std::isnan(film.x)) {
      ++of_nearest;
      continue;
    }
    const Vector3 d = at - Vector3{film.x, film.y, film.z};
    if (is_near(domain->xperiodic, h[0] * d.x + h[5] * d.y + h[4] * d.z) &&
        is_near(domain->yperiodic, h[1] * d.y + h[3] * d.z) &&
        is_near(domain->zperiodic, h[2] * d.z))
      return true;
  }
  return of_nearest > 0 && nearer_images(at) < of_nearest;
}

void FixDeformableFilms::forget(int i)
{
  particles[i].id = static_cast<double>(atom->tag[i]);
  particles[i].is_known = 1.0;
  particles[i].rows.clear();
}

void FixDeformableFilms::forget(const NeighList &list)
{
  for (int ii = 0; ii < list.inum; ++ii) forget(list.ilist[ii]);
}

void FixDeformableFilms::forget()
{
  for (int i = 0; i < atom->nlocal; ++i) forget(i);
}

void FixDeformableFilms::attach(int i, tagint partner, const Vector3 &x)
{
  remember(i, {static_cast<double>(partner), x.x, x.y, x.z});
}
