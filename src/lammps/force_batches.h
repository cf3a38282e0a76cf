// The rings of this rank in batches (force_kernels.h): which particle is where, and the contacts of each.

#ifndef DEFORMABLE_FORCE_BATCHES_H
#define DEFORMABLE_FORCE_BATCHES_H

#include "force_kernels.h"
#include "near_pairs.h"

#include "lmptype.h"

#include <vector>

namespace LAMMPS_NS {

struct ForceBatches {
  static constexpr int BLOCK =
      256;    // rings are sorted by their numbers of contacts within blocks only

  int batches = 0;
  int contacts =
      0;    // places for contacts; remote ones follow, then one for walls, which yield nothing
  bool soft = false;    // some ring does not conserve its perimeter

  // of batches
  std::vector<int> size, first,
      first_green;    // contacts of a ring; in arrays of contacts and of two contacts

  // of rings: batch x LANES + lane
  std::vector<int> particle;    // or -1
  bool tense = false;           // some ring has a tension
  std::vector<double> radius, kA, kP, tension, pressure, expansion, work, total, per_pressure;
  std::vector<float> mixed, square, rate;

  double scale = 1.0;    // see NearPairs

  // of contacts
  std::vector<int> seat;
  std::vector<double> indentation;
  std::vector<double> slope;    // of the outlines, at the end
  std::vector<float> compliance, share;

  // for corrections
  std::vector<int> partner;
  std::vector<float> weight, left, direction, step, product;    // two products for each contact

  std::vector<float> green;
  std::vector<double> scratch;

  std::vector<int> place;    // of each particle, in arrays of rings
  std::vector<int> count;    // contacts of each particle

  // Seats all contacts, and tells pairs their places. order: the particles, near ones close to each other.
  void arrange(const int *order, int rings, int particles, NearPairs &, const tagint *tags);

  // of contact m of a ring
  int contact(int ring, int m) const
  {
    return first[ring / deformable::LANES] + m * deformable::LANES + ring % deformable::LANES;
  }

  int none() const { return static_cast<int>(product.size() / 2) - 1; }    // see CorrectionArrays

  deformable::RingBatches arrays();

  double bytes() const;

 private:
  void sort_contacts(int i, const NearPairs &, const tagint *tags);
};

}    // namespace LAMMPS_NS

#endif
