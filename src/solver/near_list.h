// The list of near pairs: which ones belong to it, and for how long.
//
// No outline bulges out of its circle by more than b = 0.102 sum L + delta. A pair whose circles have a gap above
// b_i + b_j cannot touch. The list has all pairs with a smaller gap plus a margin. It is sufficient as long as no
// particle has moved and bulged by more than half of the margin together.

#ifndef LMP_NEAR_LIST_H
#define LMP_NEAR_LIST_H

#include "pointers.h"

#include "solver/adhesions.h"
#include "solver/force_history.h"
#include "solver/materials.h"
#include "solver/near_pairs.h"
#include "solver/remote_sides.h"
#include "styles/memory/fix_deformable_films.h"
#include "styles/refusals.h"
#include "styles/walls/fix_deformable_wall.h"

#include "neigh_list.h"

#include <algorithm>
#include <array>
#include <vector>

namespace LAMMPS_NS {

// What a force call is about.
struct DeformableParticles {
  const NeighList *list;
  const Materials *materials;
  const double *radius;    // by local index, ghosts included
  bool radii_vary;         // from call to call
  const std::vector<FixDeformableWall *> *walls;
  double reach, smallest;    // smallest radius of all
  bool new_material;         // a species has changed since the last call
  const Adhesions *adhesions;
  FixDeformableFilms *films;    // null: no contact sticks
  Refusals *refusals;
};

class NearList : protected Pointers {
 public:
  NearList(class LAMMPS *lmp, const deformable::ForceKernels &kernels, bool curved)
      : Pointers(lmp),
        remote_sides(lmp),
        kernels(kernels)
  {
    pairs.curved = curved;
  }

  NearPairs pairs;
  RemoteSides remote_sides;
  // b of each particle as of the last solution; of ghosts, as of the last build
  std::vector<double> bulge;

  // Collects the pairs anew.
  void build(const DeformableParticles &, bool new_list);

  // Keeps which pairs are attached, for the next build, on whatever rank.
  void store_films(const DeformableParticles &) const;

  // Overlaps and directions of all pairs. Returns -1, or a pair whose contact line cannot lie between the centers.
  int locate(const DeformableParticles &);

  // Whether the list is sufficient, on all ranks, for the present positions and bulges. `refused`: whether this rank goes no
  // further; then whether any does.
  bool is_sufficient(const DeformableParticles &, bool &refused);
  // The same after bulges have changed.
  bool is_sufficient_after(const DeformableParticles &);

  // A solution sets all bulges anew: first this, then one by one.
  void forget_growth() { grown = grown_now = 0.0; }
  void set_bulge(int i, double b)
  {
    grown = std::max(grown, b - bulge_then[i]);
    grown_now = std::max(grown_now, b - bulge[i]);
    bulge[i] = b;
  }

  // The particles of a list, in the order of the pairs.
  const int *order(const NeighList &list) const
  {
    return columns.empty() ? list.ilist : columns.data();
  }

  double memory_usage() const;

 private:
  const deformable::ForceKernels &kernels;
  double margin = 0.0;
  bool missed_wall = false;
  // the longest move and the largest growth of a bulge since the last build, and the latter in the last solution
  double farthest = 0.0, grown = 0.0, grown_now = 0.0;
  double move_of(int i, const double *x) const;
  bool is_within_margin(const DeformableParticles &, double growth) const;

  // as of the last build
  std::vector<double> x_then, radius_then;
  std::vector<float> bulge_then;       // that is precise enough for the margin
  std::array<double, 3> box_then{};    // lengths of the periodic edges, tilt
  std::vector<int> first_wall;         // pair of each particle
  std::vector<int> columns;            // see order; empty if it is that of the list

  std::vector<tagint> tags;           // as of the last neighbor list
  std::vector<tagint> remote_tags;    // of the second particles of remote pairs
  ForceHistory history;
  std::vector<RemoteSides::Candidate> candidates;

  void store_history();
  std::vector<double> knows_films;    // of particles and ghosts
  std::vector<char> at_walls;         // attached, of pairs with walls
  bool is_attached(const DeformableParticles &, int i, int j, double x, double y) const;
  void recall_films(const DeformableParticles &);
  void set_sticking(const DeformableParticles &);
  void find_owners();
  void find_order(const DeformableParticles &);
  std::vector<int> first_of(const KnownPairs &, int begin, int end) const;
  void guess_bulges(const DeformableParticles &);
  void add_walls(const DeformableParticles &, bool new_list, const KnownPairs &old);
  void locate_walls(const DeformableParticles &);
  std::vector<double> softness;    // by type; of particles and ghosts, if these vary
  void find_softness(const DeformableParticles &);
  void set_constants(const DeformableParticles &);
  double box_change() const;
};

}    // namespace LAMMPS_NS

#endif
