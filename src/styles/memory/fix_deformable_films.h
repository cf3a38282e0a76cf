// Which pairs are attached (Films), and what attaching and letting go has cost. The pair style makes this fix, with the ID
// deformable_films: fix ID all deformable/films. Styles of a hybrid one share it, each for its particles, in whatever order they are.

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/films,FixDeformableFilms);
// clang-format on
#else

#ifndef DEFORMABLE_FIX_DEFORMABLE_FILMS_H
#define DEFORMABLE_FIX_DEFORMABLE_FILMS_H

#include "laws/vector3.h"
#include "styles/memory/fix_partner_memory.h"

namespace deformable {

// Both particles of a pair have it.
struct RememberedFilm {
  double partner;
  double x, y, z;    // to its center; nan: the nearest image, of n such films the nearest n
};

}    // namespace deformable

namespace LAMMPS_NS {

class FixDeformableFilms : public deformable::FixPartnerMemory<deformable::RememberedFilm> {
 public:
  FixDeformableFilms(class LAMMPS *, int, char **);
  static constexpr const char *STYLE = "wall/films";    // see FixDeformableWall
  static constexpr const char *ID = "deformable_films";

  int modify_param(int, char **) override;

  // Whether all films of a particle are known: not of one that is new. 1 or 0, of the particles of this rank.
  void who_knows(std::vector<double> &) const;

  // Whether particle i of this rank is attached to this partner at the relative position x, in the plane with z = 0. A wall has its
  // code < 0 in place of a tag.
  bool is_attached(int i, tagint partner, const deformable::Vector3 &x = {}) const;

  // From now on the particles of this list are known, and free; or all of this rank.
  void forget(const class NeighList &);
  void forget();
  void attach(int i, tagint partner, const deformable::Vector3 &x);

  // Energy lost in runs, on all ranks.
  void lose(double energy) { lost += energy; }
  double compute_scalar() override { return lost; }

 protected:
  std::vector<double> all_sums() override { return {lost}; }
  void go_on_from(const std::vector<double> &sums) override { lost = sums[0]; }

 private:
  int nearer_images(const deformable::Vector3 &at) const;
  void forget(int i);
  double lost = 0.0;
};

}    // namespace LAMMPS_NS

#endif
#endif
