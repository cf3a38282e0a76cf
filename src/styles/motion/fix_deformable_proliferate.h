// Particles that grow and divide: fix ID group deformable/proliferate N rate division seed [pressure P]
// [axis random|stress|long] [kappa k] [asymmetry a]

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/proliferate,FixDeformableProliferate);
// clang-format on
#else

#ifndef DEFORMABLE_FIX_DEFORMABLE_PROLIFERATE_H
#define DEFORMABLE_FIX_DEFORMABLE_PROLIFERATE_H

#include "laws/proliferation.h"
#include "laws/vector3.h"
#include "styles/memory/fix_memory.h"
#include "styles/motion/counted_random.h"
#include "styles/refusals.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace deformable {

// Of a particle at the last force call before particles grow; 0 without contacts. It goes with the particle, as another fix may give
// it to another rank, or delete others, before this one.
struct Pressed {
  SymmetricTensor stress;     // sum of f h n n over contacts, h their distance
  SymmetricTensor moments;    // of the outline
  double rate;                // of a variable
};

}    // namespace deformable

namespace LAMMPS_NS {

class FixDeformableProliferate : public deformable::FixMemory<deformable::Pressed> {
 public:
  FixDeformableProliferate(class LAMMPS *, int, char **);
  static constexpr const char *STYLE = "grow/divide";    // see FixDeformableWall

  int setmask() override;
  void init() override;
  void setup(int) override;
  void final_integrate() override;
  void pre_exchange() override;
  double compute_scalar() override { return divisions; }
  void write_restart(FILE *) override;
  void restart(char *) override;

  // Whether this force call is the last one before particles grow, by which they are pressed.
  bool needs_contacts() const;
  bool has_pressure() const { return most_pressure < HUGE_VAL; }

 private:
  enum Axis { RANDOM, STRESS, LONG };

  double rate = 0.0, division;
  std::string variable;    // in place of the rate
  int variable_index = -1;
  std::uint64_t seed;
  double most_pressure = HUGE_VAL;
  Axis axis = RANDOM;
  double kappa = HUGE_VAL;    // of directions about the axis
  double asymmetry = 0.0;
  double divisions = 0.0;
  tagint last_id =
      0;    // of all atoms that were there when a run began, or that such fixes have made
  deformable::Refusals refusals;

  void find_last_id();
  void find_stresses();
  void find_moments();
  void find_variable();
  void find_rates();

  void grow(int i);
  deformable::Vector3 axis_of(int i, deformable::CountedRandom &) const;
  bool is_outside(const double *x) const;
  void divide(int i, std::vector<double> &daughters);
  void create(int n, const std::vector<double> &daughters);    // of all ranks
  template <class Visitor> void visit_inherited(int i, Visitor &&visitor) const;
};

}    // namespace LAMMPS_NS

#endif
#endif
