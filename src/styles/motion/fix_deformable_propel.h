// Self-propulsion along directions that diffuse, and align:
//   fix ID group deformable/propel f tau seed [velocity k] [neighbors k R] [free k]

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/propel,FixDeformablePropel);
// clang-format on
#else

#ifndef DEFORMABLE_FIX_DEFORMABLE_PROPEL_H
#define DEFORMABLE_FIX_DEFORMABLE_PROPEL_H

#include "laws/vector3.h"
#include "styles/memory/fix_memory.h"

#include <cstdint>
#include <vector>

namespace LAMMPS_NS {

class PairDeformable;

// It remembers the components of directions, which are unit vectors; 0 of a particle that has none yet.
class FixDeformablePropel : public deformable::FixMemory<double> {
 public:
  FixDeformablePropel(class LAMMPS *, int, char **);
  static constexpr const char *STYLE = "propel/active";    // see FixDeformableWall

  int setmask() override;
  void init() override;
  void init_list(int, class NeighList *neighbors) override { list = neighbors; }
  void setup(int) override;
  void post_force(int) override;

  bool needs_contacts() const { return by_contact || of_free != 0.0; }

  void grow_arrays(int) override;
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;
  double memory_usage() override;

 private:
  double strength, persistence;
  std::uint64_t seed;
  std::vector<double *> rows;    // see array_atom

  // Rates at which directions turn: to velocities, to those of neighbors, to free space.
  double of_velocity = 0.0, of_neighbors = 0.0, of_free = 0.0;
  bool by_contact = false;    // neighbors are those in contact
  double distance = 0.0;      // or those this near
  class NeighList *list = nullptr;
  std::vector<PairDeformable *> pairs;
  std::vector<deformable::Vector3> fields, sums;    // by local index
  std::vector<int> numbers;                         // of neighbors

  bool aligns() const { return of_velocity != 0.0 || of_neighbors != 0.0 || of_free != 0.0; }
  void align(double dt);
  void add_near();
  void add_contacts();
  void add_neighbor(int i, int j);
  void push(double dt);
  double *direction_of(int i);
  deformable::Vector3 direction(int i);
};

}    // namespace LAMMPS_NS

#endif
#endif
