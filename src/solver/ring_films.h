// Films between rings, and of rings with walls.
//
// An attached pair gains its adhesion w for each unit of length of its film. Its outlines meet the film at angles, and its
// force may be negative, down to the pull where its film has no length left (contact_curve.h).
//
// Angles depend on the tensions of the outlines, and act on rings like a load. Both lag one evaluation behind the forces. Films
// tilt and bend as all curved lines do.

#ifndef DEFORMABLE_RING_FILMS_H
#define DEFORMABLE_RING_FILMS_H

#include "solver/films.h"

#include <vector>

namespace deformable {

class RingFilms : public Films {
 public:
  explicit RingFilms(const ForceKernels &kernels) : kernels(kernels) {}

  void arrange(ContactBatches &, NearPairs &, RemoteSides &) override;

  // The first angles of a solution are those of the tensions of the last call.
  void begin() override;

  // The next angles of some pairs for the present tensions, and their largest imbalance, a force; take() makes them the angles.
  double find(int begin, int end);
  void take(int begin, int end);

  // What the tensions of rings differ by from those that films know; and films learn of them.
  double lag(const RingBatches &) const override;
  void follow(const RingBatches &) override;

  // -w times the film of a pair: the part of one ring, by its side; and the length of the film as that ring sees it.
  double energy(int k, int side) const;
  double length(int k, int side) const;

  double energy() const;    // of all rings of this rank

  // The shortest free arc between two contacts of a particle, an angle: negative where its films leave none.
  double free_arc(int i) const;

  double bytes() const override
  {
    return Films::bytes() + bytes_of(next_angle[0], next_angle[1], next_pull, last_gap);
  }

 private:
  const ForceKernels &kernels;
  std::vector<double> next_angle[2], next_pull;
  std::vector<double> last_gap;    // of tensions, by ring
  FilmArrays arrays();
  // rings whose tension may change, and by what it differs from that which films know
  template <class Act> void for_tensions(const RingBatches &rings, Act &&act) const
  {
    for (int ring = rings.begin * LANES; ring < rings.end * LANES; ++ring)
      if (batches->particle[ring] >= 0 && batches->stiffness_of(ring).tension != 0.0 &&
          batches->stiffness_of(ring).kP != 0.0)
        act(ring);
  }
  double gap(int ring) const { return batches->tension_of(ring) - batches->film_tension[ring]; }
  int ring_of(int k, int side) const;
};

}    // namespace deformable

#endif
