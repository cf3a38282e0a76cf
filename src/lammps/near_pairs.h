// Pairs that bear a force or may do so soon: of two particles, or of a particle and a wall. Balanced contacts have
// one unknown for each of them.

#ifndef DEFORMABLE_NEAR_PAIRS_H
#define DEFORMABLE_NEAR_PAIRS_H

#include "force_kernels.h"
#include "vector_bytes.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace LAMMPS_NS {

// Forces of a pair at the last calls, the latest first; negative: see ForceSolver. And the sines of the tilts of its
// contact line, see LineTilts.
struct PastForces {
  double at[3] = {deformable::UNKNOWN_FORCE, deformable::UNKNOWN_FORCE, deformable::UNKNOWN_FORCE};
  double tilt[3] = {deformable::UNKNOWN_FORCE, deformable::UNKNOWN_FORCE,
                    deformable::UNKNOWN_FORCE};
};

// Which pairs there are. Pairs with both particles on this rank come first, then those whose second particle is a
// ghost from another rank, then particles and walls.
struct KnownPairs {
  int remote = 0, wall = 0, size = 0;    // first remote pair, first pair with a wall, end

  std::vector<int> i,
      j;    // local indices, as in the neighbor list; of a wall: its code, -1 - (w + n feature)
  bool tilts = false;    // contact lines may tilt: without, the arrays of tilts are empty
  std::vector<double> past[3], past_tilt[3];

  PastForces past_of(int k) const
  {
    PastForces found = {{past[0][k], past[1][k], past[2][k]}};
    if (tilts)
      for (int n = 0; n < 3; ++n) found.tilt[n] = past_tilt[n][k];
    return found;
  }
};

// And where they are: a structure of arrays.
struct NearPairs : KnownPairs {
  std::vector<int>
      second;    // row of j if it, or the particle whose image it is, is on this rank; or -1
  std::vector<float>
      stiffening;    // k, see PairArrays: two circles that overlap by o repel with at least k o^3
  double scale = 1.0, length = 1.0;    // powers of two, of 1/(k R^2) and R: see PairArrays
  double unit() const { return length / scale; }

  // one more than pairs: the last one stands for places of contacts that are empty
  std::vector<double> force;
  std::vector<double> overlap,
      per_distance;                     // of walls: the rotation of the direction per sideways step
  std::vector<double> angle, nx, ny;    // normal of the contact line, from i to j
  std::vector<double> tilt;             // sine of its angle with the line of centers
  std::vector<int> side[2];             // index of the contact of i and of that of j

  int add(int i_, int j_, int second_, const PastForces &past_)
  {
    i.push_back(i_);
    j.push_back(j_);
    second.push_back(second_);
    for (int n = 0; n < 3; ++n) {
      past[n].push_back(past_.at[n]);
      if (tilts) past_tilt[n].push_back(past_.tilt[n]);
    }
    return size++;
  }

  // The direction from i to j, and the cosine of the tilt.
  struct Centers {
    double nx, ny, cosine;
  };
  Centers centers(int k) const
  {
    if (!tilts) return {nx[k], ny[k], 1.0};
    const double sine = tilt[k], cosine = std::sqrt(1.0 - sine * sine);
    return {cosine * nx[k] + sine * ny[k], cosine * ny[k] - sine * nx[k], cosine};
  }
  void clear(int expected);    // removes all pairs; memory for about as many
  deformable::PairDirections directions() const
  {
    return {force.data(), angle.data(), nx.data(), ny.data()};
  }
  void make_room();    // for the arrays that add() does not fill

  // Distances, directions and overlaps of pairs of particles.
  deformable::PairPlaces places(const double *x, const double *radius);

  // The first pair whose contact line cannot lie between the centers, or -1.
  int first_behind(const double *radius) const;

  double bytes() const
  {
    return bytes_of(i, j, second, stiffening, past[0], past[1], past[2], past_tilt[0], past_tilt[1],
                    past_tilt[2], force, overlap, per_distance, angle, nx, ny, tilt, side[0],
                    side[1]);
  }
};

}    // namespace LAMMPS_NS

#endif
