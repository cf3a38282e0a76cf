// The particles of this rank in batches of eight (force_kernels.h): which one is where, the contacts of each, and what the solver
// needs of them. Arrays that a law does not need are empty.

#ifndef DEFORMABLE_CONTACT_BATCHES_H
#define DEFORMABLE_CONTACT_BATCHES_H

#include "kernels/force_kernels.h"
#include "laws/ring_forces.h"
#include "solver/near_pairs.h"
#include "styles/lammps_names.h"

#include "lmptype.h"

#include <array>
#include <cstddef>
#include <vector>

namespace deformable {

struct ContactBatches {
  // rings are sorted by their numbers of contacts within blocks only
  static constexpr int BLOCK = 512;

  int batches = 0;
  int threads = 1;    // that may have a block each
  // places for contacts; remote ones follow, then one for walls, which yield nothing
  int contacts = 0;
  bool soft = false;    // some ring does not conserve its perimeter; see set_kind

  // of batches
  LargeVector<int> size, first;    // contacts of a ring; its first one in arrays of contacts
  LargeVector<std::size_t> first_green;    // in arrays of two contacts

  // of rings: batch x LANES + lane
  LargeVector<int> particle;    // or -1
  LargeVector<double> radius, pressure, work, total, per_pressure;
  LargeVector<float> square;
  LargeVector<double> stiffness[MEMBERS];    // empty where all rings have the default
  LargeVector<double> skin;                  // the same
  // empty unless rings are soft
  LargeVector<double> expansion;
  LargeVector<float> mixed, rate;

  // empty unless lines are curved: see OutlineArrays
  LargeVector<double> free_radius_of, bulk_and_swell, change;
  LargeVector<float> per_lengths, normal[2], rate_of_slope, across, turn;

  // empty unless films stick: T as their angles know it, and FilmTerms by contact
  LargeVector<double> film_tension, film[4];

  double scale = 1.0, length = 1.0;    // see NearPairs

  // of contacts
  LargeVector<int> pair_side;
  LargeVector<double> indentation;
  LargeVector<double> slope;    // of the outlines
  LargeVector<float> compliance, share;
  LargeVector<float> own;    // empty: G(0) for all contacts, see ContactArrays

  // for corrections
  LargeVector<int> partner;
  LargeVector<float> weight, left, direction, step, product;

  LargeVector<float> green;
  LargeVector<unsigned char> scratch;    // of each thread, see arrays()
  std::size_t scratch_of_thread = 0;

  LargeVector<int> place;    // of each particle, in arrays of rings
  LargeVector<int> count;    // contacts of each particle

  // Gives all contacts their indices, and tells pairs. order: the particles, near ones close to each other; own: whether
  // contacts have compliances of their own.
  void arrange(const int *order, int rings, int particles, NearPairs &, const tagint *tags,
               bool own);

  // Whether some rings are soft or have a skin, and the members of Stiffness that some have; makes room for what they need.
  using Members = std::array<bool, MEMBERS>;
  void set_kind(bool soft_, bool skinned, const Members &);
  // T = gamma + kP (P - P0), 0 where the perimeter is conserved
  double tension_of(int ring) const
  {
    const Stiffness k = stiffness_of(ring);
    return k.conserves_perimeter() ? 0.0 : k.line_tension(loaded(ring).expansion);
  }
  // q, the mean radius of curvature of the free outline
  double free_radius(std::size_t ring) const
  {
    return radius[ring] + loaded(static_cast<int>(ring)).expansion -
           total[ring] * per_pressure[ring] * (0.5 / PI);
  }
  Stiffness stiffness_of(int ring) const { return stiffness_at(stiffnesses(), ring); }
  void set_stiffness(std::size_t ring, const Stiffness &k)
  {
    for (int m = 0; m < MEMBERS; ++m)
      if (!stiffness[m].empty()) stiffness[m][ring] = k.*PARAMETERS[m].of_ring;
  }
  LoadedRing loaded(int ring) const { return {pressure[ring], soft ? expansion[ring] : 0.0}; }

  // of contact m of a ring
  int contact(int ring, int m) const { return first[ring / LANES] + m * LANES + ring % LANES; }

  int none() const { return static_cast<int>(slope.size()) - 1; }    // see CorrectionArrays

  RingBatches arrays(int thread = 0);
  std::vector<RingBatches> of_threads();

  double bytes() const;

 private:
  // Steps of arrange: places of rings, and of contacts from their numbers; memory; which contact is where.
  void place_rings(const int *order, int rings, int particles);
  void make_room(const NearPairs &, bool has_own);
  void number_contacts(NearPairs &, const tagint *tags);
  StiffnessArrays stiffnesses() const;
  void sort_contacts(int i, const NearPairs &, const tagint *tags);
};

}    // namespace deformable

#endif
