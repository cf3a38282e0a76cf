// Which pairs stick to each other, or to a wall, by a film.
//
// A pair attaches where free outlines touch, with a finite film at once, and lets go where its film is torn. Both lose energy. An
// attached pair may bear a tension: its force is above a lower bound, where the film tears. The bound follows from the law, RingFilms
// in the plane and DropletFilms in space.

#ifndef DEFORMABLE_FILMS_H
#define DEFORMABLE_FILMS_H

#include "solver/contact_batches.h"
#include "solver/near_pairs.h"
#include "solver/remote_sides.h"

#include <vector>

namespace deformable {

class Films {
 public:
  virtual ~Films() = default;

  virtual void arrange(ContactBatches &, NearPairs &, RemoteSides &);    // contacts are new

  // A new force call.
  void begin_call();

  // A new solution: films of pairs that have attached or let go.
  virtual void begin() = 0;

  // In a sweep, see DualSolver: the lower bounds of some pairs that follow from shapes; what films lag behind in particles of some
  // batches; both return an imbalance, a force. And films follow.
  virtual double find_bounds(int /*begin*/, int /*end*/) { return 0.0; }
  virtual double lag(const RingBatches &) const { return 0.0; }
  virtual void follow(const RingBatches &) {}

  // Pairs whose film is torn let go, and pairs that touch attach, if they may. Whether any would, on all ranks.
  bool would_change(bool may_attach) const;
  void change(bool may_attach);

  // A pair that presses, but whose film was torn at once: in the plane the law has films of so large an angle only where both are
  // pressed further (contact_curve.h). The local index of one of its particles, or -1.
  int pressed_without_film() const;

  virtual double bytes() const { return bytes_of(has_let_go); }

 protected:
  NearPairs *pairs = nullptr;
  ContactBatches *batches = nullptr;
  RemoteSides *remote = nullptr;

 private:
  std::vector<char>
      has_let_go;    // in this call: such pairs stay free until the next one, or the next list of pairs
  bool would_change(int k, bool may_attach) const;
  void agree();
  // At the start of a solution the lower bound of an attached pair is not known yet: there is none.
  double least_until_known(int k) const { return pairs->attached[k] ? UNKNOWN : 0.0; }
};

}    // namespace deformable

#endif
