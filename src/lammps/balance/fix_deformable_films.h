// Which pairs are attached (Films): a memory that goes with the particles, to other ranks and into restart files. The pair
// style makes this fix, with the ID deformable_films: fix ID all deformable/films

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/films,FixDeformableFilms);
// clang-format on
#else

#ifndef LMP_FIX_DEFORMABLE_FILMS_H
#define LMP_FIX_DEFORMABLE_FILMS_H

#include "fix.h"

#include <vector>

namespace LAMMPS_NS {

class FixDeformableFilms : public Fix {
 public:
  FixDeformableFilms(class LAMMPS *, int, char **);
  ~FixDeformableFilms() override;
  static constexpr const char *STYLE = "wall/films";    // see FixDeformableWall
  static constexpr const char *ID = "deformable_films";

  int setmask() override { return 0; }
  int modify_param(int, char **) override;

  // A particle that is new knows nothing. 1 or 0, of the particles of this rank.
  void who_knows(std::vector<double> &) const;

  // Whether particle i of this rank is attached to this partner at the relative position (x, y). A wall has its code < 0
  // in place of a tag.
  bool is_attached(int i, tagint partner, double x = 0.0, double y = 0.0) const;

  void forget();    // from now on all particles of this rank are known, and free
  void attach(int i, tagint partner, double x, double y);

  double memory_usage() override;
  void grow_arrays(int) override;
  void copy_arrays(int, int, int) override;
  void set_arrays(int) override;
  int pack_exchange(int, double *) override;
  int unpack_exchange(int, double *) override;
  int pack_restart(int, double *) override;
  void unpack_restart(int, int) override;
  int size_restart(int) override;
  int maxsize_restart() override;

 private:
  struct Film {
    double partner, x, y;    // nan: the nearest image
  };
  struct Memory {
    bool is_known = false;
    std::vector<Film> films;
  };
  std::vector<Memory> memory;    // by local index
  int pack(int i, double *) const;
  int unpack(int i, const double *);
};

}    // namespace LAMMPS_NS

#endif
#endif
