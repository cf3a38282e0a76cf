#include "fix_deformable_films.h"

#include "atom.h"
#include "domain.h"
#include "error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

using namespace LAMMPS_NS;

FixDeformableFilms::FixDeformableFilms(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  if (narg != 3) error->all(FLERR, "Fix deformable/films has no arguments");
  delete[] style;
  style = utils::strdup(STYLE);
  restart_peratom = 1;
  create_attribute = 1;
  maxexchange_dynamic = 1;
  FixDeformableFilms::grow_arrays(atom->nmax);
  atom->add_callback(Atom::GROW);
  atom->add_callback(Atom::RESTART);
}

FixDeformableFilms::~FixDeformableFilms()
{
  if (!id) return;
  atom->delete_callback(id, Atom::GROW);
  atom->delete_callback(id, Atom::RESTART);
}

/* ----------------------------------------------------------------------
   fix_modify deformable_films attached none, or attached I J ...: IDs of
   particles, or the code < 0 of a wall
------------------------------------------------------------------------- */

int FixDeformableFilms::modify_param(int narg, char **arg)
{
  constexpr double NEAREST = std::numeric_limits<double>::quiet_NaN();
  if (std::string(arg[0]) != "attached" || narg < 2) return 0;
  if (narg == 2 && std::string(arg[1]) == "none") {
    forget();
    return 2;
  }
  if (narg % 2 == 0)
    error->all(FLERR,
               "fix_modify {} attached: expected 'none', or two IDs for each pair, not {} words",
               id, narg - 1);
  for (int n = 1; n < narg; n += 2) {
    const tagint pair[2] = {utils::tnumeric(FLERR, arg[n], false, lmp),
                            utils::tnumeric(FLERR, arg[n + 1], false, lmp)};
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < atom->nlocal; ++i)
        if (atom->tag[i] == pair[side]) attach(i, pair[1 - side], NEAREST, NEAREST);
  }
  return narg;
}

/* ---------------------------------------------------------------------- */

void FixDeformableFilms::who_knows(std::vector<double> &knows) const
{
  knows.resize(atom->nlocal);
  for (int i = 0; i < atom->nlocal; ++i) knows[i] = memory[i].is_known ? 1.0 : 0.0;
}

// A particle in a small box may have several images of its partner: the one that has moved by less than its distance.
bool FixDeformableFilms::is_attached(int i, tagint partner, double x, double y) const
{
  const double *const h = domain->h_inv;
  const auto is_this = [&](const Film &film) {
    if (film.partner != static_cast<double>(partner)) return false;
    if (partner < 0) return true;
    if (std::isnan(film.x)) {
      const auto is_near = [](bool periodic, double part) {
        return !periodic || std::fabs(part) <= 0.5;
      };
      return is_near(domain->xperiodic, h[0] * x + h[5] * y) &&
             is_near(domain->yperiodic, h[1] * y);
    }
    const double dx = film.x - x, dy = film.y - y;
    return dx * dx + dy * dy <= x * x + y * y;
  };
  return std::any_of(memory[i].films.begin(), memory[i].films.end(), is_this);
}

void FixDeformableFilms::forget()
{
  for (int i = 0; i < atom->nlocal; ++i) {
    memory[i].is_known = true;
    memory[i].films.clear();
  }
}

void FixDeformableFilms::attach(int i, tagint partner, double x, double y)
{
  memory[i].films.push_back({static_cast<double>(partner), x, y});
  maxexchange = std::max(maxexchange, size_restart(i));
}

/* ---------------------------------------------------------------------- */

double FixDeformableFilms::memory_usage()
{
  double bytes = static_cast<double>(memory.capacity() * sizeof(Memory));
  for (const Memory &m : memory) bytes += static_cast<double>(m.films.capacity() * sizeof(Film));
  return bytes;
}

void FixDeformableFilms::grow_arrays(int size)
{
  memory.resize(size);
}

void FixDeformableFilms::copy_arrays(int from, int to, int /*delflag*/)
{
  memory[to] = memory[from];
}

void FixDeformableFilms::set_arrays(int i)
{
  memory[i] = {};
}

// Numbers of a particle: how many there are, whether it is known, and its films.
int FixDeformableFilms::pack(int i, double *buffer) const
{
  const Memory &m = memory[i];
  int n = 0;
  buffer[n++] = static_cast<double>(2 + 3 * m.films.size());
  buffer[n++] = m.is_known ? 1.0 : 0.0;
  for (const Film &film : m.films)
    for (const double value : {film.partner, film.x, film.y}) buffer[n++] = value;
  return n;
}

int FixDeformableFilms::unpack(int i, const double *buffer)
{
  const int size = static_cast<int>(buffer[0]);
  Memory &m = memory[i];
  m.is_known = buffer[1] != 0.0;
  m.films.clear();
  for (int n = 2; n < size; n += 3) m.films.push_back({buffer[n], buffer[n + 1], buffer[n + 2]});
  return size;
}

int FixDeformableFilms::pack_exchange(int i, double *buffer)
{
  return pack(i, buffer);
}

int FixDeformableFilms::unpack_exchange(int i, double *buffer)
{
  return unpack(i, buffer);
}

int FixDeformableFilms::pack_restart(int i, double *buffer)
{
  return pack(i, buffer);
}

// Atom::extra has the numbers of all fixes, one after the other; each begins with its size.
void FixDeformableFilms::unpack_restart(int i, int fix)
{
  const double *values = atom->extra[i];
  for (int n = 0; n < fix; ++n) values += static_cast<int>(values[0]);
  unpack(i, values);
}

int FixDeformableFilms::size_restart(int i)
{
  return 2 + 3 * static_cast<int>(memory[i].films.size());
}

// Of all ranks: the first one tells those that read the file how much room they need.
int FixDeformableFilms::maxsize_restart()
{
  int most = 2, of_all;
  for (int i = 0; i < atom->nlocal; ++i) most = std::max(most, size_restart(i));
  MPI_Allreduce(&most, &of_all, 1, MPI_INT, MPI_MAX, world);
  return of_all;
}
