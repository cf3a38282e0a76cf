// Forces of laws of one particle, block by block: its contacts from the neighbor list and the walls give its shape, and the
// derivatives of that its forces.

#ifndef DEFORMABLE_BLOCK_FORCES_H
#define DEFORMABLE_BLOCK_FORCES_H

#include "styles/pair/pair_deformable.h"

#include "kernels/block_walk.h"

#include <algorithm>
#include <vector>

namespace deformable {

class BlockForces {
 public:
  explicit BlockForces(PairDeformable &pair) : pair(pair) {}

  // Shapes and forces of all particles. prepare(particle) may take out its contacts, group_of(particle) chooses a kernel or 0 for
  // law(particle, contacts), and finish(particle) follows its forces.
  template <class Prepare, class GroupOf, class Law, class Finish>
  void for_each(const BatchKernel *chosen, Prepare &&prepare, GroupOf &&group_of, Law &&law,
                Finish &&finish);

  ContactBlock block;                         // that has its turn
  void check_lines(const BlockParticle &);    // all in front of the center?
  void load_shape(const BlockParticle &);     // into the shape of the pair style
  // The local index of the partner of a place, or the code < 0 of a wall.
  int partner_of(const Place &place) const
  {
    return place.partner < 0 ? wall_contacts[-1 - place.partner].wall : place.partner;
  }

  double bytes() const { return block.bytes() + bytes_of(rows, partners, wall_contacts); }

 private:
  PairDeformable &pair;
  // The neighbors of each particle: in front the partners of contacts that were active at the last call.
  struct Row {
    int first, size, active;    // first: in partners
  };
  std::vector<Row> rows;    // by local index
  std::vector<int> partners;
  struct WallContact {
    int wall;    // its code < 0
    double nx, ny, height, per_lever;
  };
  std::vector<WallContact> wall_contacts;    // of the block; a place has -1 minus the index

  static constexpr int BLOCK = 256;
  template <bool WALLS> void gather_block(int begin, int end);
  void push_block();
  void take_neighbors();
  void remember_active(const BlockParticle &);
  void push_mirror(const BlockParticle &, const Place &);
  struct WallPush {
    Vector2 push;
    double shift;    // of its line from the point of the wall nearest to the center
  };
  static WallPush push_of(const WallContact &, const Place &);
  void observe(const BlockParticle &);
  LoadedContact loaded_contact(const BlockParticle &, const Place &) const;
  void check_own_images(const BlockParticle &);
};

template <class Prepare, class GroupOf, class Law, class Finish>
void BlockForces::for_each(const BatchKernel *chosen, Prepare &&prepare, GroupOf &&group_of,
                           Law &&law, Finish &&finish)
{
  const bool shapes =
      pair.results.requested || pair.recording || pair.measuring || pair.neighbor->ago == 0;
  const bool observing = pair.results.requested || pair.recording || pair.rubbing ||
                         pair.eflag_atom || pair.vflag_either;
  if (pair.neighbor->ago == 0) take_neighbors();
  for (int begin = 0; begin < pair.list->inum; begin += BLOCK) {
    const int end = std::min(begin + BLOCK, pair.list->inum);
    pair.walls.empty() ? gather_block<false>(begin, end) : gather_block<true>(begin, end);
    for (BlockParticle &p : block.particles) prepare(p);
    shape_block(block, chosen, shapes, pair.shape, group_of,
                [&](BlockParticle &p, const Contacts &contacts) {
                  check_lines(p);
                  return law(p, contacts);
                });
    push_block();
    for (const BlockParticle &p : block.particles) {
      if (p.moved && pair.bulges()) remember_active(p);
      if (observing) observe(p);
      finish(p);
    }
  }
}

}    // namespace deformable

#endif
