// Films between droplets in space, and of droplets with walls: laws/droplet_film.h.
//
// Angles are those of pairs of materials. The lower bound of a film moves with the pressures of its droplets. What films between
// droplets of unlike radii add by the pressures lags one evaluation behind the forces.
//
// A film is torn at the least force that its law has, where it still has a radius, and lets go there. Where centers are held another
// branch of shapes goes on from there, with weaker pulls, up to the largest distance. It is no maximum of the dual problem, so
// that forces would not be its unknowns. What the jump gains or takes is in the lost energy, of whatever sign: above an angle of
// 0.3 rad such a film has a little less energy than a droplet without it.

#ifndef DEFORMABLE_DROPLET_FILMS_H
#define DEFORMABLE_DROPLET_FILMS_H

#include "solver/films.h"
#include "solver/pair_list.h"

#include "laws/droplet_film.h"

#include <cmath>

namespace deformable {

class DropletFilms : public Films {
 public:
  // Angles of all pairs, if they are attached; `arranged`: contacts are new.
  void set_material(const ForceCall &, const ContactBatches &, NearPairs &, bool arranged);

  void begin() override;
  double find_bounds(int begin, int end) override;

  void add_to(DropletArrays &);
  void exchange(RemoteSides &r)
  {
    r.exchange(least.data(), pressure.data(), radius_of_film.data());
  }

  // Of a pair: one for both sides, of the mean of their areas.
  double film_radius(int k) const
  {
    const double here = radius_of_film[pairs->side[0][k]];
    if (k >= pairs->wall) return here;
    const double there = radius_of_film[pairs->side[1][k]];
    return std::sqrt(0.5 * (here * here + there * there));
  }
  double rise_of(int place) const { return rise[place]; }
  // By the place of a droplet in batches: how far it may bulge, over the radius.
  double bulge(std::size_t row) const { return bulges[row]; }
  // Whether films are outside of the range of the law: they cover too much, their angle is too large, or they meet.
  bool are_beyond(std::size_t row, int contacts, const DropletArrays &) const;

  double bytes() const override;

 private:
  // by contact, see DropletArrays; `_if`: of pairs that are attached
  LargeVector<double> sine_if, rise_if, sine, rise, lean, lean_log, is_cap, radius_of_film,
      curved_by_pressure, pressure, least;
  bool any_caps = false;
  LargeVector<double> stretch, cover, bulges;    // by droplet
};

}    // namespace deformable

#endif
