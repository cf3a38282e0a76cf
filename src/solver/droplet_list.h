// The list of near pairs of droplets: which ones belong to it, and for how long.
//
// No droplet bulges by more than b = droplet_bulge(R, load). A pair whose spheres have a gap above b_i + b_j cannot touch. The
// list has all pairs with a smaller gap plus a margin. It is sufficient as long as no droplet has moved and bulged by more
// than half of the margin together. Walls are looked for in each call, so they may move as they like.

#ifndef LMP_DROPLET_LIST_H
#define LMP_DROPLET_LIST_H

#include "pointers.h"

#include "solver/droplet_pairs.h"
#include "solver/force_history.h"
#include "solver/materials.h"
#include "solver/remote_sides.h"
#include "styles/refusals.h"

#include "neigh_list.h"

#include <array>
#include <vector>

namespace LAMMPS_NS {

// What a force call is about.
struct DropletScene {
  const NeighList *list;
  const Materials *materials;
  const double *radius;    // by local index, ghosts included
  double smallest;         // of all
  const std::vector<class FixDeformableWall *> *walls;
  double reach;    // up to which walls are looked for, over the radius, minus 1
  Refusals *refusals;
};

class DropletList : protected Pointers {
 public:
  explicit DropletList(class LAMMPS *lmp) : Pointers(lmp), remote_sides(lmp) {}

  DropletPairs pairs;
  RemoteSides remote_sides;
  std::vector<double> bulge;    // b as of the last solution; of ghosts, as of the last build

  // Collects the pairs anew, with their past.
  void build(const DropletScene &, bool new_list);

  // Where the walls are now: before is_sufficient.
  void locate_walls(const DropletScene &);

  // Whether the list is sufficient, on all ranks, for the present positions and bulges. `before` a solution, in which
  // bulges grow a little. `refused`: whether this rank goes no further; then whether any does.
  bool is_sufficient(const DropletScene &, bool before, bool &refused);

  double memory_usage() const;

 private:
  double margin = 0.0;
  // as of the last build
  std::vector<double> x_then, radius_then, bulge_then;
  std::array<double, 6> box_then{};
  std::array<double, 6> box_now() const;

  std::vector<tagint> tags;           // as of the last neighbor list
  std::vector<tagint> remote_tags;    // of the second droplets of remote pairs
  ForceHistory history;
  std::vector<RemoteSides::Candidate> candidates;

  void store_history();
  void find_owners();
  std::vector<int> first_of(const DropletPairs &, int begin, int end) const;
  void guess_bulges(const DropletScene &);
  double box_change() const;

  std::vector<int> first_wall;    // of each droplet: its first pair with a wall, or the end
  bool missed_wall = false;
  void add_bulges_at_walls(const DropletScene &, const std::vector<char> &unknown);
  void add_walls(const DropletScene &, bool new_list, const DropletPairs &old);
};

}    // namespace LAMMPS_NS

#endif
