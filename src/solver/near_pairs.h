// Pairs that bear a force or may do so soon: of two particles, or of a particle and a wall. Balanced contacts have
// one unknown for each of them.

#ifndef DEFORMABLE_NEAR_PAIRS_H
#define DEFORMABLE_NEAR_PAIRS_H

#include "kernels/force_kernels.h"
#include "solver/large_vector.h"
#include "solver/vector_bytes.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace LAMMPS_NS {

// The force of a pair at the last call; negative: see ForceSolver. Its differences from call to call, further and further
// back, see PairArrays. The sines of the tilts of its contact line and its bends at the last two calls, see CurvedLines.
struct PastForces {
  double force = deformable::UNKNOWN_FORCE;
  double earlier[3] = {0.0, 0.0, 0.0};
  static constexpr int LINES = 2;
  double tilt[LINES] = {deformable::UNKNOWN_FORCE, deformable::UNKNOWN_FORCE};
  double bend[LINES] = {0.0, 0.0};    // from the first particle

  PastForces from_second() const
  {
    PastForces past = *this;
    for (double &b : past.bend) b = -b;
    return past;
  }
};

// Which pairs there are. Pairs with both particles on this rank come first, then those whose second particle is a
// ghost from another rank, then particles and walls.
struct KnownPairs {
  int remote = 0, wall = 0, size = 0;    // first remote pair, first pair with a wall, end

  LargeVector<int> i,
      j;    // local indices, as in the neighbor list; of a wall: its code, -1 - (w + n feature)
  bool curved = false;    // contact lines tilt and bend: without, those arrays are empty
  bool sticks = false;    // some pairs may have films that stick, as well
  LargeVector<double> past, past_tilt[PastForces::LINES], past_bend[PastForces::LINES];
  LargeVector<float> earlier[3];       // in `unit`; see PastForces
  double scale = 1.0, length = 1.0;    // powers of two, of 1/(k R^2) and R: see PairArrays
  double unit() const { return length / scale; }

  PastForces past_of(int k) const
  {
    PastForces found;
    found.force = past[k];
    for (int n = 0; n < 3; ++n) found.earlier[n] = earlier[n][k] * unit();
    for (int n = 0; n < PastForces::LINES && curved; ++n) {
      found.tilt[n] = past_tilt[n][k];
      found.bend[n] = past_bend[n][k];
    }
    return found;
  }
};

// And where they are: a structure of arrays.
struct NearPairs : KnownPairs {
  LargeVector<int> owned;    // by local index: the particle of this rank whose image it is, or -1
  // local index of j's particle, or of the one whose image it is; -1 if that is on another rank
  int second(int k) const { return k < remote ? owned[j[k]] : -1; }
  LargeVector<float>
      stiffening;    // k, see PairArrays: two circles that overlap by o repel with at least k o^3

  // one more than pairs: the last one stands for places of contacts that are empty
  LargeVector<double> force;
  LargeVector<double> overlap,
      per_distance;                     // of walls: the rotation of the direction per sideways step
  LargeVector<double> angle, nx, ny;    // normal of the contact line, from i to j
  LargeVector<double> tilt;             // sine of its angle with the line of centers
  LargeVector<double> bend;             // tan(beta/2), see contact_curve.h
  LargeVector<int> side[2];             // index of the contact of i and of that of j

  // of films that stick, see Films
  LargeVector<char> attached;
  LargeVector<double> sticking, adhesion;    // w if attached, and w or 0
  LargeVector<double> film_angle[2];         // tan(theta/2) of both sides
  LargeVector<double> least;                 // see least_force

  int add(int i_, int j_, const PastForces &past_)
  {
    i.push_back(i_);
    j.push_back(j_);
    past.push_back(past_.force);
    for (int n = 0; n < 3; ++n) earlier[n].push_back(static_cast<float>(past_.earlier[n] / unit()));
    for (int n = 0; n < PastForces::LINES && curved; ++n) {
      past_tilt[n].push_back(past_.tilt[n]);
      past_bend[n].push_back(past_.bend[n]);
    }
    return size++;
  }

  // The direction from i to j, and the cosine of the tilt.
  struct Centers {
    double nx, ny, cosine;
  };
  Centers centers(int k) const
  {
    if (!curved) return {nx[k], ny[k], 1.0};
    const double sine = tilt[k], cosine = std::sqrt(1.0 - sine * sine);
    return {cosine * nx[k] + sine * ny[k], cosine * ny[k] - sine * nx[k], cosine};
  }
  // Removes all pairs; room for about as many, in the same units.
  void clear(const KnownPairs &old);
  void set_units(double scale, double length);
  deformable::PairDirections directions() const
  {
    return {force.data(), angle.data(), nx.data(), ny.data(), curved ? bend.data() : nullptr};
  }
  void make_room();    // for the arrays that add() does not fill

  // Distances, directions and overlaps of pairs of particles.
  deformable::PairPlaces places(const double *x, const double *radius);

  // The first pair whose contact line cannot lie between the centers, or -1.
  int first_behind(const double *radius) const;

  double bytes() const
  {
    double of_lines = 0.0;
    for (int n = 0; n < PastForces::LINES; ++n) of_lines += bytes_of(past_tilt[n], past_bend[n]);
    return of_lines + bytes_of(i, j, owned, stiffening, past, earlier[0], earlier[1], earlier[2],
                               force, overlap, per_distance, angle, nx, ny, tilt, bend, side[0],
                               side[1], attached, sticking, adhesion, film_angle[0], film_angle[1],
                               least);
  }
};

}    // namespace LAMMPS_NS

#endif
