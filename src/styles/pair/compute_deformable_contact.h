// The contacts of the deformable pair styles, for dump local: compute ID group deformable/contact

#ifdef COMPUTE_CLASS
// clang-format off
ComputeStyle(deformable/contact,ComputeDeformableContact);
// clang-format on
#else

#ifndef DEFORMABLE_COMPUTE_DEFORMABLE_CONTACT_H
#define DEFORMABLE_COMPUTE_DEFORMABLE_CONTACT_H

#include "compute.h"

#include <vector>

namespace LAMMPS_NS {

class ComputeDeformableContact : public Compute {
 public:
  static constexpr const char *STYLES = "^deformable/";    // for which pair styles record contacts

  ComputeDeformableContact(class LAMMPS *, int, char **);
  void init() override;
  void compute_local() override;
  double memory_usage() override;

 protected:
  // For computes whose rows have so many numbers, and which read their arguments themselves.
  ComputeDeformableContact(class LAMMPS *, int, char **, int columns);
  virtual void list(const class PairDeformable &, std::vector<double> &numbers) const;

 private:
  std::vector<class PairDeformable *> pairs;    // of the last run; several within a hybrid style

  std::vector<double> values;
  std::vector<double *> rows;
};

}    // namespace LAMMPS_NS

#endif
#endif
