#include "solver/droplet_films.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace deformable {

void DropletFilms::set_material(const ForceCall &call, const ContactBatches &b, NearPairs &p,
                                bool arranged)
{
  any_caps = false;
  if (arranged) {
    const std::size_t rows = b.particle.size(), places = b.contacts, all = b.indentation.size();
    for (auto *const v : {&sine_if, &rise_if, &sine, &rise, &is_cap, &curved_by_pressure})
      v->assign(places, 0.0);
    for (auto *const v : {&pressure, &radius_of_film}) v->assign(all, 0.0);
    lean.assign(places, 1.0);
    lean_log.assign(places, 0.0);
    least.assign(all, UNKNOWN);    // of walls: none
    stretch.assign(rows, 1.0);
    cover.assign(rows, 0.0);
    bulges.assign(rows, 0.0);
  }
  const auto tension_of = [&](int i) {
    return call.materials->stiffness_of(i, call.radius[i]).tension;
  };
  for (int k = 0; k < p.size; ++k) {
    const int end[] = {p.i[k], p.j[k]};
    const double w = p.adhesion_if_attached[k];
    for (int side = 0; side < 2; ++side) {
      p.film_angle[side][k] = 0.0;
      if (k >= p.wall && side == 1) continue;
      const int i = end[side], j = end[1 - side], place = p.side[side][k];
      const double Ri = call.radius[i], gi = tension_of(i);
      FilmSide film;
      if (k < p.wall) {
        const double Rj = call.radius[j], gj = tension_of(j);
        film = film_side(Ri, gi, Rj, gj, w);
      } else {
        film = film_side_of_wall(gi, w);
      }
      p.film_angle[side][k] = film.rise > 0.0 ? film.rise / film.sine : 0.0;
      if (side == 1 && k >= p.remote) continue;    // of another rank
      sine_if[place] = film.sine;
      rise_if[place] = film.rise;
      lean[place] = film.lean;
      lean_log[place] = std::log(film.lean);
      const bool unlike = k < p.wall && gi == tension_of(j) && Ri != call.radius[j];
      is_cap[place] = unlike ? 1.0 : 0.0;
      any_caps |= unlike;
    }
  }
}

void DropletFilms::begin()
{
  NearPairs &p = *pairs;
  for (int k = 0; k < p.size; ++k) {
    const bool sticks = p.attached[k] && p.adhesion_if_attached[k] > 0.0;
    p.adhesion[k] = sticks ? p.adhesion_if_attached[k] : 0.0;
    for (int side = 0; side < (k < p.remote ? 2 : 1); ++side) {
      const int place = p.side[side][k];
      sine[place] = sticks ? sine_if[place] : 0.0;
      rise[place] = sticks ? rise_if[place] : 0.0;
      if (!sticks) curved_by_pressure[place] = 0.0;    // what a film that is gone has told
    }
  }
}

// A force that was at its lower bound, or is below, is set to the new bound.
double DropletFilms::find_bounds(int begin, int end)
{
  NearPairs &p = *pairs;
  double worst = 0.0;
  for (int k = begin; k < end; ++k) {
    if (p.adhesion[k] == 0.0) {
      p.least[k] = 0.0;
      continue;
    }
    const double bound = std::max(least[p.side[0][k]], least[p.side[1][k]]);
    const bool bears = p.force[k] > p.least[k];
    p.least[k] = bound;
    if (bears && p.force[k] >= bound) continue;
    worst = std::max(worst, std::fabs(p.force[k] - bound));
    p.force[k] = bound;
  }
  return worst;
}

void DropletFilms::add_to(DropletArrays &d)
{
  d.sine = sine.data();
  d.rise = rise.data();
  d.lean = lean.data();
  d.lean_log = lean_log.data();
  d.is_cap = any_caps ? is_cap.data() : nullptr;
  d.stretch = stretch.data();
  d.cover = cover.data();
  d.bulge = bulges.data();
  d.film_radius = radius_of_film.data();
  d.curved_by_pressure = curved_by_pressure.data();
  d.pressure = pressure.data();
  d.least = least.data();
}

// Two films meet where arctan(r_c/h_c) + arctan(r_k/h_k) is the angle between their normals, with the heights h = R - a.
bool DropletFilms::are_beyond(std::size_t row, int contacts, const DropletArrays &d) const
{
  static const double LARGEST_SINE = std::sin(LARGEST_FILM_ANGLE);
  if (cover[row] > LARGEST_COVER) return true;
  struct Opening {
    double x, y, z, cosine, sine;
  };
  static thread_local std::vector<Opening> openings;
  openings.clear();
  const int first = batches->first[row / LANES] + static_cast<int>(row % LANES);
  for (int n = 0; n < contacts; ++n) {
    const int c = first + n * LANES;
    if (sine[c] == 0.0) continue;
    if (sine[c] > LARGEST_SINE) return true;
    const double r = radius_of_film[c], h = batches->radius[row] - batches->indentation[c],
                 over = 1.0 / std::sqrt(h * h + r * r);
    const Opening here = {d.nx[c], d.ny[c], d.nz[c], h * over, r * over};
    for (const Opening &there : openings)
      if (here.cosine * there.cosine - here.sine * there.sine <
          here.x * there.x + here.y * there.y + here.z * there.z)
        return true;
    openings.push_back(here);
  }
  return false;
}

double DropletFilms::bytes() const
{
  return Films::bytes() + bytes_of(sine_if, rise_if, sine, rise, lean, lean_log, is_cap,
                                   radius_of_film, curved_by_pressure, pressure, least, stretch,
                                   cover, bulges);
}

}    // namespace deformable
