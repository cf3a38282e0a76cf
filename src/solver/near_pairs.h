// Pairs that bear a force or may do so soon: of two particles, or of a particle and a wall. The solver has one unknown for each
// of them, its force.

#ifndef DEFORMABLE_NEAR_PAIRS_H
#define DEFORMABLE_NEAR_PAIRS_H

#include "geometry/surface.h"
#include "kernels/force_kernels.h"
#include "kernels/large_vector.h"
#include "solver/threads.h"

#include <cmath>
#include <vector>

namespace deformable {

// What is remembered of a pair: its force or, if it bears none, its imbalance, which is negative (DualSolver). With curved lines also
// the sine of the tilt, and the bend as the first particle sees it. Of each: the value at the last call, or UNKNOWN, and differences from call to
// call (PastArrays), which DualSolver::predict moves on.
enum { FORCE, TILT, BEND, KINDS };
struct PairPast {
  struct Series {
    double last = UNKNOWN;
    double earlier[3] = {0.0, 0.0, 0.0};
  } of[KINDS];

  PairPast from_second() const
  {
    PairPast past = *this;
    Series &bend = past.of[BEND];
    if (bend.last != UNKNOWN) bend.last = -bend.last;
    for (double &change : bend.earlier) change = -change;
    return past;
  }
};

// Which pairs there are. Pairs with both particles on this rank come first, then those whose second particle is a
// ghost from another rank, then particles and walls.
struct KnownPairs {
  bool in_space = false;
  bool curved = false;      // contact lines tilt and bend: without, those arrays are empty
  bool adhesive = false;    // some pairs may have films, as well

  int remote = 0, wall = 0, size = 0;    // first remote pair, first pair with a wall, end

  LargeVector<int> i, j;    // local indices, as in the neighbor list; of a wall: its code < 0
  struct Past {
    LargeVector<double> last;
    LargeVector<float> earlier[3];    // in unit(kind)
    PastArrays arrays()
    {
      return {last.data(), {earlier[0].data(), earlier[1].data(), earlier[2].data()}};
    }
  } past[KINDS];
  double scale = 1.0, length = 1.0;    // powers of two, of 1/(k R^2) and R: see PairArrays
  double unit(int kind = FORCE) const { return kind == FORCE ? length / scale : 1.0; }
  int kinds() const { return curved ? KINDS : 1; }    // of what is remembered

  // Both ranks have a pair with a remote side: each counts half of it.
  double part(int k) const { return k >= remote && k < wall ? 0.5 : 1.0; }
  template <class Sum> double sum(Sum &&sum) const    // of sum(begin, end)
  {
    return sum(0, remote) + 0.5 * sum(remote, wall) + sum(wall, size);
  }

  PairPast past_of(int k) const
  {
    PairPast found;
    for (int kind = 0; kind < kinds(); ++kind) {
      found.of[kind].last = past[kind].last[k];
      for (int n = 0; n < 3; ++n) found.of[kind].earlier[n] = past[kind].earlier[n][k] * unit(kind);
    }
    return found;
  }
};

// And where they are: a structure of arrays.
struct NearPairs : KnownPairs {
  LargeVector<int> owned;    // by local index: the particle of this rank whose image it is, or -1
  // local index of j's particle, or of the one whose image it is; -1 if that is on another rank
  int second(int k) const { return k < remote ? owned[j[k]] : -1; }
  // k, see PairArrays: two circles that overlap by o repel with at least k o^3
  LargeVector<float> stiffening;

  // one more than pairs: the last one stands for places of contacts that are empty
  LargeVector<double> force;
  LargeVector<double> overlap;
  LargeVector<double> per_distance;    // of walls: the rotation of the direction per sideways step
  LargeVector<double> nx, ny, nz;      // normal of the contact, from i to j; nz: in space
  LargeVector<double> angle;           // of the normal, in the plane
  LargeVector<double> tilt;            // sine of its angle with the line of centers
  LargeVector<double> bend;            // tan(beta/2), see contact_curve.h
  LargeVector<int> side[2];            // index of the contact of i and of that of j
  LargeVector<int> ring[2];            // with curved lines: those of i and j in arrays of rings
  std::vector<SurfacePoint> surfaces;    // of walls in space, from the first one on

  // of films, see Films
  LargeVector<char> attached;
  LargeVector<double> adhesion_if_attached, adhesion;    // w if attached, and w or 0
  LargeVector<double> film_angle[2];                     // tan(theta/2) of both sides
  LargeVector<double> least;                             // see least_force

  int add(int i_, int j_, const PairPast &known)
  {
    i.push_back(i_);
    j.push_back(j_);
    for (int kind = 0; kind < kinds(); ++kind) {
      past[kind].last.push_back(known.of[kind].last);
      for (int n = 0; n < 3; ++n)
        past[kind].earlier[n].push_back(static_cast<float>(known.of[kind].earlier[n] / unit(kind)));
    }
    return size++;
  }

  Vector3 normal(int k) const { return {nx[k], ny[k], in_space ? nz[k] : 0.0}; }
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
  void make_room();    // for the arrays that add() does not fill

  // Distances, normals and overlaps of pairs of particles: of positions x and radii. Returns a pair whose contact line cannot
  // lie between the centers, in space one without a direction; or -1.
  int locate(const ForceKernels &, Threads &, const double *x, const double *radius);
  int locate_in_space(const double *x, const double *radius, int begin, int end);
  // The point of a wall that is nearest to the center of a pair.
  void locate_wall(int k, double radius, const SurfacePoint &);

  PairDirections directions() const
  {
    PairDirections d = {};
    d.force = force.data();
    d.angle = angle.data();
    d.nx = nx.data();
    d.ny = ny.data();
    d.nz = nz.data();
    if (curved) d.bend = bend.data();
    if (adhesive) d.least = least.data();
    return d;
  }

  double bytes() const;
};

}    // namespace deformable

#endif
