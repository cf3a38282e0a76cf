// Friction, rotation and damping of contacts, and their films, in the plane and in space:
//   fix ID group deformable/friction mu kt gt [damp gn] [restitution e] [film c n] [types I J mu kt gt gn ...] ...
//     [ledger yes]
//
// The pair style tells which contacts bear a force, where and along which normal. This fix adds what else acts between their
// two sides, before ranks sum up the forces on ghosts. Of two particles the rank of the one with the smaller ID does so,
// for both.
//
// Velocities are of the half step before, v(t - dt/2). The way of a contact in a step is the mean of the ways with its place at
// the begin of the step and at its end: so work, springs and losses balance to second order in dt.

#ifdef FIX_CLASS
// clang-format off
FixStyle(deformable/friction,FixDeformableFriction);
// clang-format on
#else

#ifndef DEFORMABLE_FIX_DEFORMABLE_FRICTION_H
#define DEFORMABLE_FIX_DEFORMABLE_FRICTION_H

#include "styles/friction/box_rate.h"
#include "styles/friction/friction_coefficients.h"
#include "styles/memory/fix_partner_memory.h"

#include <array>
#include <string>
#include <vector>

namespace LAMMPS_NS {

class PairDeformable;

}    // namespace LAMMPS_NS

namespace deformable {

struct LoadedContact;

// Of two particles the one with the smaller ID remembers a contact. It is the same from both sides but for its directions: n x xi
// keeps its sign.

// As the particle that remembers sees it.
template <class V> struct ContactPlace {
  V r;    // center of the partner, from that of the particle; 0 for a wall
  V b;    // middle of the contact
  V n;    // towards the partner

  ContactPlace from_partner() const { return {-r, b - r, -n}; }
};

// In the plane what is along a contact is the third component.
struct RememberedContact {
  double partner;    // ID, or the code < 0 of a wall
  double kt;
  ContactPlace<Vector3> place;
  Vector3 xi, force;    // n x, see laws/friction.h
  ContactVector<Vector3> film;
  double damping;
  double one_side;    // the partner remembers a contact of its own
  double is_here;     // in this step
};

}    // namespace deformable

namespace LAMMPS_NS {

class FixDeformableFriction : public deformable::FixPartnerMemory<deformable::RememberedContact> {
 public:
  FixDeformableFriction(class LAMMPS *, int, char **);
  static constexpr const char *STYLE = "contact/friction";    // see FixDeformableWall

  const std::string words;    // that define it

  int setmask() override;
  int modify_param(int, char **) override;
  void init() override;
  void reset_dt() override;
  void setup_pre_reverse(int, int) override;
  void post_integrate() override { box_rate.measure(); }
  void pre_reverse(int, int) override;
  void post_run() override { box_rate.end_run(); }
  double compute_scalar() override;
  double compute_vector(int) override;

  bool has_films() const { return coefficients.have_films(); }

  double memory_usage() override;
  void grow_arrays(int) override;
  int pack_reverse_comm(int, int, double *) override;
  void unpack_reverse_comm(int, int *, double *) override;

 protected:
  std::vector<double> all_sums() override;
  void go_on_from(const std::vector<double> &) override;
  bool belongs_to_partner(int i, const deformable::RememberedContact &) const override;
  deformable::RememberedContact from_partner(int i,
                                             const deformable::RememberedContact &) const override;

 private:
  const bool ledger;    // whether losses are told by particle and by contact
  deformable::FrictionCoefficients coefficients;
  std::vector<PairDeformable *> pairs;    // several within a hybrid style
  bool told_of_spins = false, told_of_box = false;
  void check_spins();
  void check_box();
  void find_partners();
  double lightest = 0.0;    // mass of a particle of all ranks
  void find_lightest();
  void check_time_step() const;

  // By sliding, in dashpots along and across contacts, in films.
  using Losses = std::array<double, 4>;
  enum { STORED, SLIDING, DASHPOTS, DAMPING, CONTACTS, SLIDES, FILMS, OUTPUTS };
  // Of this rank; losses of all runs so far, others of the last call.
  double output[OUTPUTS] = {};
  std::vector<double> values;                  // see array_local
  std::vector<double *> rows, of_particles;    // the latter: see array_atom

  // A particle, which remembers the contact, and its partner. Local indices, of a wall its code < 0.
  struct Sides {
    int particle, partner;
    int rememberer;    // the particle of this rank whose image it may be
  };
  const bool in_plane;
  double lever() const;            // 1 + m R^2/I
  double largest_film = 0.0;       // constant of a film with n < 1 that is allowed
  double linear_film = 0.0;        // largest constant of a film with n = 1
  double largest_dashpot = 0.0;    // of a restitution
  void check_dashpots() const;
  double mass_of(int i) const;    // in force time^2/distance units
  double dashpot(const PairDeformable &, const Sides &, double ratio, double force);
  deformable::BoxRate box_rate;
  double dt = 0.0;    // 0: before the first step of a run
  void rub_all(int vflag);

  // V: Vector2 in the plane, where what particles have of z, and of spins about x and y, does not count; or Vector3.
  template <class V> struct Velocity {
    V v;                                      // of the partner's center past the particle's
    deformable::Along<V> spin, other_spin;    // of both
  };
  // Of the partner's side past the particle's; and of the partner's alone if that is a wall.
  template <class V> struct Speeds {
    deformable::ContactVector<V> v, wall;
  };
  // At the end of a step.
  template <class V> struct Acting {
    deformable::Rub<deformable::Along<V>> rub;
    double damping;
    deformable::ContactVector<V> film;
  };
  template <class V> void rub_contacts();
  template <class V> void rub(const PairDeformable &, const deformable::LoadedContact &);
  template <class V>
  bool find_sides(const deformable::LoadedContact &, Sides &, deformable::ContactPlace<V> &) const;
  template <class V> Velocity<V> velocity(const Sides &) const;
  template <class V>
  Speeds<V> speeds(const Sides &, const Velocity<V> &, const deformable::ContactPlace<V> &,
                   double age) const;
  template <class V>
  deformable::ContactVector<V> film_force(const deformable::Friction &, double size,
                                          deformable::ContactVector<V> v);
  template <class V>
  Losses lose(const Sides &, const Acting<V> &before, const Acting<V> &now, double kt,
              const Speeds<V> &v_before, const Speeds<V> &v_now, bool ends = false);
  template <class V>
  void push(const Sides &, const deformable::ContactPlace<V> &,
            const deformable::ContactVector<V> &);
  template <class V>
  Losses power_of(const deformable::Friction &, const Acting<V> &,
                  const deformable::ContactVector<V> &v) const;
  void blame(const Sides &, const Losses &);
  bool blaming = false;    // in reverse communication
  template <class V>
  void list_row(int i, const Sides &, const deformable::ContactPlace<V> &, const Acting<V> &,
                double force, const Losses &power);
  template <class V> void end(int i, const deformable::RememberedContact &);
  void sweep();
  int words_of_spring() const;
  void give_spring(int i, const double *numbers);
};

}    // namespace LAMMPS_NS

#endif
#endif
