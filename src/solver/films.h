// Films between particles that stick to each other, or to a wall.
//
// An attached pair gains its adhesion w for each unit of length of its film. Its outlines meet the film at angles, and its
// force may be negative, down to the pull that tears the film off (contact_curve.h). A pair attaches where free outlines
// touch, with a finite film at once, and lets go where its film has no length left. Both lose energy.
//
// Angles depend on the tensions of the outlines, and act on rings like a load. Both lag one evaluation behind the forces. Films
// tilt and bend as all curved lines do.

#ifndef DEFORMABLE_FILMS_H
#define DEFORMABLE_FILMS_H

#include "solver/contact_batches.h"
#include "solver/near_pairs.h"
#include "solver/remote_sides.h"

#include <vector>

namespace deformable {

class Films {
 public:
  explicit Films(const ForceKernels &kernels) : kernels(kernels) {}

  void arrange(ContactBatches &, NearPairs &, RemoteSides &);    // contacts are new

  // A new force call.
  void begin_call();

  // The first angles of a solution are those of the tensions of the last call.
  void begin();

  // The next angles of some pairs for the present tensions, and their largest imbalance, a force; take() makes them the angles.
  double find(int begin, int end);
  void take(int begin, int end);

  // What the tensions of the rings of some batches differ by from those that films know, a force; and films learn of them.
  double tension_imbalance(const RingBatches &) const;
  void follow_tensions(const RingBatches &);

  // Pairs whose film has no length let go, and pairs that touch attach, if they may. Whether any would, on all ranks.
  bool would_change(bool may_attach) const;
  void change(bool may_attach);

  // A pair that presses, but whose film had no length: the law has films of so large an angle only where both are pressed
  // further (contact_curve.h). The local index of one of its particles, or -1.
  int pressed_without_film() const;

  // -w times the film of a pair: the part of one ring, by its side; and the length of the film as that ring sees it.
  double energy(int k, int side) const;
  double length(int k, int side) const;

  double energy() const;    // of all rings of this rank

  // The shortest free arc between two contacts of a particle, an angle: negative where its films leave none.
  double free_arc(int i) const;

  double bytes() const
  {
    return bytes_of(next_angle[0], next_angle[1], next_pull, last_gap, has_let_go);
  }

 private:
  const ForceKernels &kernels;
  NearPairs *pairs = nullptr;
  ContactBatches *batches = nullptr;
  RemoteSides *remote = nullptr;
  std::vector<double> next_angle[2], next_pull;
  std::vector<double> last_gap;    // of tensions, by ring
  std::vector<char>
      has_let_go;    // in this call: such pairs stay free until the next one, or the next list of pairs
  FilmArrays arrays();
  bool would_change(int k, bool may_attach) const;
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
  void agree();
  // At the start of a solution the lower bound of an attached pair is not known yet: there is none.
  double least_until_taken(int k) const { return pairs->attached[k] ? UNKNOWN : 0.0; }
};

}    // namespace deformable

#endif
