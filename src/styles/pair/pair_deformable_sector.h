// Contacts without slip: pair_style deformable/sector [radius type|atom]

#ifdef PAIR_CLASS
// clang-format off
PairStyle(deformable/sector,PairDeformableSector);
// clang-format on
#else

#ifndef DEFORMABLE_PAIR_DEFORMABLE_SECTOR_H
#define DEFORMABLE_PAIR_DEFORMABLE_SECTOR_H

#include "laws/sector.h"
#include "styles/pair/block_forces.h"
#include "styles/pair/pair_deformable.h"

namespace LAMMPS_NS {

class PairDeformableSector : public PairDeformable {
 public:
  PairDeformableSector(class LAMMPS *);
  void settings(int, char **) override;
  std::string law() const override { return "deformable/sector"; }
  void init_style() override;
  void compute(int, int) override;
  double memory_usage() override;
  bool slips() const override { return false; }
  int pack_forward_comm(int, int *, double *, int, int *) override;
  void unpack_forward_comm(int, int, double *) override;

 protected:
  void check_species(const deformable::Species &) const override;
  void outline_of(int i, const std::vector<deformable::RecordedContact> &, int points,
                  deformable::Outline &) const override;

 private:
  deformable::BlockForces blocks{*this};
  std::vector<int> by_angle;    // the contacts of one particle

  // A particle with one contact has no sector: the pair repels as soft disks, once. The partner's number of
  // contacts, which only its own rank knows, decides whether both particles add one half.
  struct SingleContact {
    int atom, partner;    // negative: a wall
    deformable::Contact contact;
    double distance;
  };
  std::vector<SingleContact> singles;
  std::vector<double> ncontacts;    // per atom, ghosts included

  void repel(const SingleContact &);
  void set_aside(deformable::BlockParticle &);
  deformable::Energy deform(deformable::BlockParticle &, const deformable::Contacts &);
};

}    // namespace LAMMPS_NS

#endif
#endif
