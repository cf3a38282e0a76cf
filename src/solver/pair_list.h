// The list of near pairs: which ones belong to it, for how long, and what is remembered of them from list to list.
//
// No outline bulges out of its circle, and no droplet out of its sphere, by more than b, which the law knows. A pair whose
// circles have a gap above b_i + b_j cannot touch. The list has all pairs with a smaller gap plus a margin. It is sufficient
// as long as no particle has moved and bulged by more than half of the margin together. Walls are looked for in each call, so
// they may move as they like.

#ifndef DEFORMABLE_PAIR_LIST_H
#define DEFORMABLE_PAIR_LIST_H

#include "solver/near_pairs.h"
#include "solver/remote_sides.h"
#include "solver/threads.h"
#include "solver/tuning.h"
#include "styles/lammps_names.h"
#include "styles/memory/fix_deformable_films.h"
#include "styles/refusals.h"
#include "styles/species.h"
#include "styles/walls/fix_deformable_wall.h"

#include "neigh_list.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace deformable {

// What a force call is about.
struct ForceCall {
  const NeighList *list = nullptr;    // each pair once; a pair with a ghost at both particles
  const Materials *materials = nullptr;
  const double *radius = nullptr;    // by local index, ghosts included
  bool radii_vary = false;           // from call to call
  const std::vector<FixDeformableWall *> *walls = nullptr;
  double reach = 0.0;           // up to which walls are looked for, over the radius, minus 1
  double smallest = 0.0;        // radius of all
  bool new_list = false;        // the neighbor list is new: particles have other indices
  bool new_material = false;    // a species has changed since the last call
  bool tallies = false;         // pushes add to virials or energies of particles, one by one
  Refusals *refusals = nullptr;
  const Adhesions *adhesions = nullptr;
  FixDeformableFilms *films = nullptr;    // null: no adhesion
};

// What is remembered of pairs and particles by their tags, while a new neighbor list gives them other indices and ranks.
class PairHistory {
 public:
  void reserve(std::size_t pairs, std::size_t particles)
  {
    entries.reserve(pairs);
    bulges.reserve(particles);
  }
  // Particle `tag` and a partner have borne these forces: another particle at the relative position x, or a wall of this
  // code < 0.
  void add(tagint tag, tagint partner, const Vector3 &x, const PairPast &past)
  {
    entries.push_back(entry_of(tag, partner, x, past));
  }
  void add_bulge(tagint tag, double bulge) { bulges.push_back({tag, bulge}); }
  void sort();
  // A particle in a small box may have several images of its partner: the one nearest to x counts. Nothing is known if there
  // is none within the distance that x itself has.
  PairPast find(tagint tag, tagint partner, const Vector3 &x) const;
  double bulge(tagint tag) const;    // negative if it is not known

 private:
  struct Entry {    // from the particle with the smaller tag
    tagint tag, partner;
    float x, y, z;    // sufficient to tell images apart
    PairPast past;
    bool operator<(const Entry &other) const
    {
      return tag != other.tag ? tag < other.tag : partner < other.partner;
    }
  };
  static Entry entry_of(tagint tag, tagint partner, const Vector3 &x, const PairPast &past);
  std::vector<Entry> entries;
  std::vector<std::pair<tagint, double>> bulges;
};

class PairList : protected Pointers {
 public:
  // bulge_per_overlap: b of a particle that no solution has seen, over the overlaps of its circle; most_bulge: over the radius.
  PairList(LAMMPS *lmp, const ForceKernels &kernels, const Tuning &tuning, bool in_space,
           bool curved, double bulge_per_overlap, double most_bulge);

  NearPairs pairs;
  RemoteSides remote_sides;
  // b of each particle as of the last solution; of ghosts, as of the last build
  std::vector<double> bulge;

  // Collects the pairs anew, with what is remembered of them. new_list: particles have other indices.
  void build(const ForceCall &, bool new_list);

  // Overlaps and normals of all pairs. Returns -1, or a pair whose contact line cannot lie between the centers.
  int locate(const ForceCall &, Threads &);

  // Whether the list is sufficient, on all ranks, for the present positions and bulges. `refused`: whether this rank goes no
  // further; then whether any does.
  bool is_sufficient(const ForceCall &, Threads &, bool &refused);
  // The same after bulges have changed, of particles that have not moved.
  bool is_sufficient_after(const ForceCall &, bool &refused);

  // A solution sets all bulges anew: first this, then one by one.
  void reset_growth() { grown = 0.0; }
  void set_bulge(int i, double b)
  {
    grown = std::max(grown, b - bulge_then[i]);
    bulge[i] = b;
  }

  // Keeps which pairs are attached by a film, for the next build, on whatever rank.
  void store_films(const ForceCall &) const;

  // The particles of a list, in the order of the pairs.
  const int *order(const NeighList &list) const
  {
    return columns.empty() ? list.ilist : columns.data();
  }

  double memory_usage() const;

 private:
  const ForceKernels &kernels;
  const Tuning &tuning;
  const double bulge_per_overlap, most_bulge;
  double margin = 0.0;
  bool missed_wall = false;              // one that the list does not have is near
  double farthest = 0.0, grown = 0.0;    // the longest move and the largest growth of a bulge

  // as of the last build
  std::vector<double> x_then, radius_then;
  std::vector<float> bulge_then;    // that is precise enough for the margin
  std::array<double, 6> box_then{};
  std::vector<int> first_wall;        // pair of each particle
  std::vector<int> rank_of;           // of each particle and ghost
  std::vector<int> columns;           // see order; empty if it is that of the list
  std::vector<tagint> tags;           // as of the last neighbor list
  std::vector<tagint> remote_tags;    // of the second particles of remote pairs
  PairHistory history;
  std::vector<RemoteSides::Candidate> candidates;
  std::vector<double> knows_films;    // of particles and ghosts
  std::vector<char> at_walls;         // attached, of pairs with walls

  Vector3 relative(const double *from, const double *to) const
  {
    return {to[0] - from[0], to[1] - from[1], pairs.in_space ? to[2] - from[2] : 0.0};
  }
  void store_history();
  void find_owners();
  void find_order(const ForceCall &);
  void guess_bulges(const ForceCall &);
  std::vector<int> first_of(const KnownPairs &, int begin, int end) const;
  void add_walls(const ForceCall &, bool new_list, const KnownPairs &old);
  void locate_walls(const ForceCall &);
  double move_of(int i, const double *x) const;
  bool is_within_margin(const ForceCall &) const;
  std::array<double, 6> box_now() const;
  double box_change() const;
  bool is_attached(const ForceCall &, int i, int j, const Vector3 &) const;
  void recall_films(const ForceCall &);
};

}    // namespace deformable

#endif
