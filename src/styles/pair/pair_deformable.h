// The base of the pair styles: parameters, walls, and what is asked for of particles and contacts. Forces come from BlockForces, for
// laws of one particle, or from a DualSolver, for laws of forces.

#ifndef DEFORMABLE_PAIR_DEFORMABLE_H
#define DEFORMABLE_PAIR_DEFORMABLE_H

#include "pair.h"

#include "geometry/surface.h"
#include "kernels/batch_kernels.h"
#include "kernels/large_vector.h"
#include "laws/shape.h"
#include "laws/stiffness.h"
#include "laws/vector2.h"
#include "response/outline.h"
#include "solver/pair_list.h"
#include "styles/lammps_names.h"
#include "styles/refusals.h"
#include "styles/species.h"
#include "styles/walls/fix_deformable_wall.h"

#include "atom.h"
#include "force.h"
#include "neigh_list.h"
#include "neighbor.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace deformable {

class BlockForces;

// Per-particle results of the pair styles, for fix pair.
class ParticleResults {
 public:
  explicit ParticleResults(int dimension) : dimension(dimension) {}

  bool requested = false;    // by extract

  // Values of all particles, null before the next call of resize; null for an unknown name.
  double *extract(const char *name);

  void resize(std::size_t particles);
  void clear(std::size_t particles);

  // Particle i, whose ring has this radius when undeformed.
  void store_shape(int i, double radius, int contacts, const Shape &, double pressure);
  void store_circle(int i, double radius, double pressure);
  // Droplet i in three dimensions: of its surface and of its facets.
  struct Surface {
    double area;
    int contacts;
    double pressure, contact_area, load;
  };
  void store_surface(int i, const Surface &);

  double bytes() const;

 private:
  enum { AREA, PERIMETER, CONTACTS, PRESSURE, ARC_RADIUS, CONTACT_LENGTH, SIZE };
  static constexpr const char *NAMES[] = {"area",     "perimeter",  "contacts",
                                          "pressure", "arc_radius", "contact_length"};
  // Droplets have these in place of two results of rings:
  enum { CONTACT_AREA = PERIMETER, LOAD = ARC_RADIUS };
  static constexpr int SIZE_OF_SURFACE = 5;
  static constexpr const char *NAMES_OF_SURFACE[] = {"area", "contact_area", "contacts", "pressure",
                                                     "load"};
  const int dimension;
  std::array<std::vector<double>, SIZE> values;
};

// What is recorded of a contact line beside its place.
struct RecordedLine {
  double tilt = 0.0;             // its normal turns by this from the line of centers
  double half_angle = 0.0;       // of an arc: positive where it is convex
  double contact_angle = 0.0;    // at which the outline meets a film
  double attached = 0.0;         // 0 or 1; of a wall: 0 or its code < 0, see FixDeformableFilms
  // The outline of a ring between contacts has the support function H = E - sum L G.
  double support_radius = 0.0;    // E
  double support_length = 0.0;    // L
};

// A contact from one of its two sides.
struct RecordedContact {
  int atom;
  tagint partner;    // its ID, or -1 - k of the walls of fix k, from 0
  double indentation, length, force;
  double x, y;        // point of the line that is nearest to the center
  double angle;       // of the direction to the line
  double distance;    // of the partner's center, or of the wall
  RecordedLine line;
  Vector2 push;    // force on the particle from its own energy; from a wall all of it
};

// A contact that bears a force, for fix deformable/friction and propel.
struct LoadedContact {
  int i, j;          // local indices; of a wall its code < 0
  int owned;         // local index of the particle whose image j is, or -1: it is on another rank
  Vector3 n;         // normal of the contact, from i to j
  Vector3 middle;    // of its film, from the center of i
  double force;
  // of its film, if asked for: length in the plane, area in space; the mean of both sides
  double size;
  bool one_side;    // the other side has a row, and a force, of its own
};

// In the plane: at this height along the normal, and this far to the left of it.
inline Vector3 middle_of(double nx, double ny, double height, double shift)
{
  return {height * nx - shift * ny, height * ny + shift * nx, 0.0};
}

// Two particles, or a particle and a wall, at the last force call: for minimizers, which take them for springs.
struct Spring {
  int i, j;           // local indices, j may be a ghost; of a wall: -1
  Vector3 n;          // from i to j
  double distance;    // of the centers, or of the wall
  double overlap;     // negative: a gap
};

}    // namespace deformable

namespace LAMMPS_NS {

class PairDeformable : public Pair {
  friend class deformable::BlockForces;

 public:
  // Contacts of this rank's particles at the last call, if a compute of contacts or outlines is defined.
  std::vector<deformable::RecordedContact> recorded;

  // All contacts of this rank's particles that bear a force at the last call, if a fix deformable/friction or propel asks for
  // them. A contact between two ranks is on both.
  std::vector<deformable::LoadedContact> loaded;
  virtual bool slips() const { return true; }    // along its contacts

  // The energy of particle i where nothing but one contact presses it, with this force: a restitution asks for it. The contact
  // is one with a particle, by its local index, or with a wall < 0.
  virtual double energy_alone(int /*i*/, int /*partner*/, double /*force*/) const { return 0.0; }
  virtual bool knows_energy_alone() const { return false; }

  // What a restart file must be continued with, by what it belongs to: the law, and the species of each type.
  virtual std::string law() const = 0;
  std::map<std::string, std::string> description() const;

  // For the next force calls: contacts need not balance better than to this force, where it is above the tolerance. A minimizer
  // says so as long as it is far from rest.
  virtual void accept_imbalance(double /*force*/) {}
  // Stops a run where the last force call has found what cannot be. Fixes also call for trial places, which no step ends with.
  virtual void check_state() const {}
  // Whether the energy of these places is another one in the next iteration of a minimization. All ranks ask, and hear the same.
  virtual bool law_changes() const { return false; }
  const deformable::FrontKernels &front_kernels() const { return kernels->fronts; }

  bool has_wall(int code) const
  {
    return code < 0 && deformable::wall_of(code) < static_cast<int>(walls.size());
  }
  FixDeformableWall &wall(int code) const { return deformable::wall_of(code, walls); }
  // The code of the first feature of the same obstacle: it stays where a particle turns around a corner.
  int wall_key(int code) const
  {
    const int first = wall(code).first_feature(deformable::wall_feature_of(code));
    return deformable::wall_code(deformable::wall_of(code), first);
  }

  PairDeformable(class LAMMPS *, int outputs = 2, int dimension = 2);
  ~PairDeformable() override;

  void coeff(int, char **) override;
  void init_style() override;
  double init_one(int, int) override;
  void *extract(const char *, int &) override;
  void *extract_peratom(const char *, int &) override;

  // Appends the rows of compute deformable/contact: of contacts of this rank's particles in the group.
  static int contact_columns(int dimension) { return dimension == 3 ? 21 : 15; }
  virtual void list_contacts(int groupbit, std::vector<double> &rows) const;
  // Those of compute deformable/outline; points: of a whole turn.
  static constexpr int OUTLINE_COLUMNS = 8;
  void list_outlines(int groupbit, int points, std::vector<double> &rows) const;
  double memory_usage() override;
  bool has_radii_of_atoms() const { return radius_by_atom; }

  // All contacts of this rank's particles, and pairs with a gap up to this part of both radii. Each once, those of a particle
  // and a ghost on both sides.
  void list_springs(double gap, std::vector<deformable::Spring> &springs) const;
  double smallest_radius() const;    // of all particles of all ranks

 protected:
  // Stops with an error if the style does not support this species.
  virtual void check_species(const deformable::Species &) const {}

  // Films of contacts that stick. The law has them from `use_films` on.
  class FixDeformableFilms *films = nullptr;    // null: no adhesion
  virtual void use_films() {}
  void find_films();
  void forget_films() { films = nullptr; }    // the law is another one
  void check_adhesive_walls();
  // Stop if the law has no film of such an adhesion: of two types; the problem of particle i at a wall, or nothing.
  virtual void check_films(const std::vector<deformable::Species> &,
                           const deformable::Adhesions &) const
  {
  }
  virtual std::string invalid_at_wall(double adhesion, int i) const;

  // Values that fix adapt has set since the last call. Whether a species or an adhesion has changed.
  deformable::SpeciesRamps ramps;
  bool take_ramps();
  bool unchecked = false;    // values of ramps, also after an error that the caller has caught

  // Whether contact lines bend, without which nothing can stick: stops if the owner of an adhesion does.
  virtual bool bends_lines() const { return false; }
  void check_lines_bend(const std::string &whose, bool sticks) const;

  // How far the laws balance contacts that solve for forces, from the keyword arg[iarg] of a style.
  struct Balance {
    double tolerance = 1e-8;
    int evaluations = 1000;    // at most
  };
  Balance read_balance(const std::string &style, int iarg, char **arg) const;
  int read_threads(const std::string &style, const char *value) const;    // see DualSolver

  // Stops if values that fix adapt has set are invalid.
  void check_ramped_species() const;

  // Gives each pair_style and pair_coeff command of this process a number of its own.
  void number_definition();

  double reach = 0.0;    // largest distance of contacts over R_i + R_j, minus 1
  bool bulges() const { return reach > 0.0; }    // else contacts are the lines inside of the circle
  std::vector<deformable::Species>
      species;                        // by atom type; without a name: of another pair style
  deformable::Materials materials;    // as of this call
  deformable::Adhesions adhesions;    // of all pairs of types
  std::map<std::string, std::string> defined;    // by pair_coeff
  void describe_species();
  std::vector<FixDeformableWall *> walls;

  // The force of a wall on particle i at this contact, at `shift` beside the point nearest to the center.
  void push_wall(int i, int partner, double fx, double fy, const deformable::Contact &contact,
                 double shift)
  {
    const double ri = radii[i], height = ri - contact.indentation;
    wall(partner).add_contact(
        i, deformable::wall_feature_of(partner), fx, fy, -height * contact.nx + shift * contact.ny,
        -height * contact.ny - shift * contact.nx, -contact.ny, contact.nx, (1.0 + reach) * ri);
  }

  // Undeformed radii: of the species or, with `radius atom`, of each atom.
  bool is_by_atom(int iarg, char **arg) const;    // the value of a keyword, 'type' or 'atom'
  bool radius_by_atom = false;
  std::vector<double> radii;    // of all particles, ghosts included
  double smallest = 0.0;        // of all ranks, as of the last new neighbor list
  double ring_radius_of(int i) const { return radii[i] - species[atom->type[i]].skin; }
  deformable::Stiffness stiffness_of(int i) const
  {
    return materials.stiffness_of(i, ring_radius_of(i));
  }

  deformable::Shape shape;    // of the particle that is evaluated

  // A force call is begin_call, then the forces, e.g. of blocks of particles, then end_call.
  void begin_call(int eflag, int vflag);
  deformable::ForceCall force_call();    // what a DualSolver is told
  const deformable::BatchKernels *kernels;
  bool whole_list = true;    // each pair at both of its particles, as BlockForces need it
  void end_call();
  deformable::Refusals refusals;

  deformable::ParticleResults results;
  bool recording = false;    // for computes of contacts and outlines, and fixes of division
  bool rubbing = false;      // whether `loaded` is asked for
  bool measuring = false;    // and the sizes of films

  // Whether anyone asks for shapes and contacts of single particles in this call.
  bool needs_shapes() const { return recording || results.requested; }

  // The outline of particle i about its center, from what was recorded of its contacts.
  virtual void outline_of(int /*i*/, const std::vector<deformable::RecordedContact> &,
                          int /*points*/, deformable::Outline &) const
  {
  }

  // For such computes, if there is one.
  void record(int i, int partner, const deformable::Contact &, double length, double force,
              const deformable::Vector2 &push, double distance,
              const deformable::RecordedLine &line = {});

  // Stops because the contact line of particle i does not lie in front of its center.
  [[noreturn]] void refuse_behind_center(int i, int j, double dx, double dy);
  // Stops if j is an image of particle i, which has no area left.
  void check_own_image(int i, int j);

  int beyond_model;    // particles of this rank
  virtual const char *what_is_beyond() const
  {
    return "part of their outline has a negative radius of curvature (past confluence, or contacts "
           "too close to each other). Their shape does not exist, their";
  }
  double bulge_over_reach;    // the largest of this rank, at the last new neighbor list

 private:
  std::vector<double> radius;    // by atom type; the largest one if radii are by atom
  void check_radii();

  struct {
    double definition, walls, friction, exclusions, forces_of_motion;
    std::vector<double> by_type;
  } asked{};    // for extract

  const int dimension;
  bool has_computes = false;    // of contacts or outlines
  std::vector<class FixDeformableProliferate *> proliferations;
  bool warned_beyond_model = false, warned_out_of_plane = false, warned_unused_radii = false;

  void refuse_scaled() const;
  void allocate();
};

}    // namespace LAMMPS_NS

namespace deformable {

// The pair style of a run, or the styles within a hybrid one, in its order. They are known by their class, because the names of
// other styles, such as deformable/edge, begin alike.
inline std::vector<PairDeformable *> deformable_pairs(Force &force)
{
  std::vector<PairDeformable *> found;
  const auto add = [&found](Pair *pair) {
    if (auto *const deformable = dynamic_cast<PairDeformable *>(pair)) found.push_back(deformable);
    return pair != nullptr;
  };
  constexpr const char *NAMES = "^deformable/";
  if (add(force.pair_match(NAMES, 0))) return found;    // the only one of these names
  for (int n = 1; add(force.pair_match(NAMES, 0, n));) ++n;
  return found;
}

// The same for a command that works with them only, such as "Fix ID deformable/wall": stops if there is none.
std::vector<PairDeformable *> require_deformable_pairs(LAMMPS *, const std::string &command);

}    // namespace deformable

#endif
