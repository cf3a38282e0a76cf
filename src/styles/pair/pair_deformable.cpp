#include "styles/pair/pair_deformable.h"

#include "solver/dual_solver.h"

#include "laws/parameter_rules.h"
#include "laws/trigonometry.h"
#include "styles/all_ranks.h"
#include "styles/friction/fix_deformable_friction.h"
#include "styles/lammps_release.h"
#include "styles/memory/fix_deformable_films.h"
#include "styles/memory/fix_deformable_restart.h"
#include "styles/motion/fix_deformable_proliferate.h"
#include "styles/motion/fix_deformable_propel.h"
#include "styles/pair/compute_deformable_contact.h"
#include "styles/refusals.h"
#include "styles/walls/fix_deformable_wall.h"

#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

using namespace LAMMPS_NS;
using namespace deformable;

PairDeformable::PairDeformable(LAMMPS *lmp, int outputs, int dimension)
    : Pair(lmp),
      refusals(lmp),
      results(dimension),
      beyond_model(0),
      bulge_over_reach(0.0),
      dimension(dimension)
{
  single_enable = 0;
  restartinfo = 0;
  one_coeff = 1;
  manybody_flag = 1;
  centroidstressflag = CENTROID_NOTAVAIL;
  nextra = outputs;
  pvector = new double[nextra]();

  const std::string level = environment(lmp, "DEFORMABLE_SIMD");
  kernels = batch_kernels(level);
  refusals.check([&] {    // processors of ranks may differ
    if (!kernels) refuse("{}", why_no_kernels("DEFORMABLE_SIMD", level));
  });
}

PairDeformable::~PairDeformable()
{
  if (copymode) return;
  delete[] pvector;
  if (allocated) {
    memory->destroy(setflag);
    memory->destroy(cutsq);
  }
}

void PairDeformable::allocate()
{
  allocated = 1;
  const int n = atom->ntypes;
  memory->create(setflag, n + 1, n + 1, "pair:setflag");
  memory->create(cutsq, n + 1, n + 1, "pair:cutsq");
  for (int i = 1; i <= n; ++i)
    for (int j = 1; j <= n; ++j) setflag[i][j] = 0;
  map = new int[n + 1];
}

/* ----------------------------------------------------------------------
   pair_coeff * * FILE species1 species2 ... After an error that the caller has
   caught all is as before.
------------------------------------------------------------------------- */

void PairDeformable::coeff(int narg, char **arg)
{
  if (!allocated) allocate();
  refuse_data_coefficients(lmp);
  number_definition();
  if (narg < 4) utils::missing_cmd_args(FLERR, "pair_coeff", error);
  if (narg != 3 + atom->ntypes)
    error->all(FLERR,
               "pair_coeff of {} names {} species for {} atom types: give one (or NULL) a type",
               force->pair_style, narg - 3, atom->ntypes);
  const SpeciesFile known = read_species(lmp, arg[2]);
  std::vector<Species> of_types(atom->ntypes + 1);
  for (int type = 1; type <= atom->ntypes; ++type) {
    const std::string name = arg[2 + type];
    if (name == "NULL") continue;
    for (const Species &candidate : known.species)
      if (candidate.name == name) of_types[type] = candidate;
    if (of_types[type].name.empty()) {
      std::string names;
      for (const Species &candidate : known.species) names += " " + shown(candidate.name);
      error->all(FLERR_WORD(2 + type), "Species '{}' is not in the file '{}', which has:{}", name,
                 arg[2], names);
    }
    check_species(of_types[type]);
  }
  Adhesions of_pairs;
  of_pairs.assign(of_types, known.adhesions);
  check_films(of_types, of_pairs);
  check_lines_bend("Species", of_pairs.any());
  map_element2type(narg - 3, arg + 3);
  species = of_types;
  radius.clear();
  for (const Species &s : species) radius.push_back(s.radius);
  adhesions.assign(species, known.adhesions);
  ramps.fill(species);
  describe_species();
}

void PairDeformable::check_lines_bend(const std::string &whose, bool sticks) const
{
  if (sticks && !bends_lines())
    error->all(FLERR,
               "{}: adhesion needs contact lines that bend, to meet outlines at an angle. Use "
               "'pair_style deformable/ring contact curved', or adhesion 0",
               whose);
}

void PairDeformable::init_style()
{
  refusals.forget();
  accept_imbalance(0.0);
  if (domain->dimension != dimension)
    error->all(FLERR,
               dimension == 3
                   ? "Pair style deformable/droplet is three-dimensional: use 'dimension 3', or "
                     "'pair_style deformable/ring' for droplets in two dimensions"
                   : "Pair styles deformable/* are two-dimensional: use 'dimension 2', or "
                     "'pair_style deformable/droplet' for droplets in three dimensions");
  if (force->newton_pair == 0)
    error->all(FLERR, "Pair styles deformable/* need 'newton on': their forces act on ghost atoms");
  if (radius_by_atom && !atom->radius_flag)
    error->all(FLERR,
               "Pair styles deformable/* with 'radius atom' need atoms that have radii: use "
               "'atom_style sphere', not {}",
               atom->get_style());
  // or each pair of this rank's particles once, pairs with a ghost on both ranks
  neighbor->add_request(this, whole_list ? NeighConst::REQ_FULL : NeighConst::REQ_NEWTON_OFF);

  // false again after unfix; extract_peratom sets it for a new fix pair
  results.requested = !modify->get_fix_by_style("^pair$").empty();

  has_computes = !modify->get_compute_by_style(ComputeDeformableContact::STYLES).empty();
  proliferations.clear();
  for (Fix *fix : modify->get_fix_by_style(FixDeformableProliferate::STYLE))
    proliferations.push_back(static_cast<FixDeformableProliferate *>(fix));
  const std::vector<Fix *> frictions = modify->get_fix_by_style(FixDeformableFriction::STYLE);
  const std::vector<Fix *> propulsions = modify->get_fix_by_style(FixDeformablePropel::STYLE);
  rubbing =
      !frictions.empty() || std::any_of(propulsions.begin(), propulsions.end(), [](const Fix *fix) {
        return static_cast<const FixDeformablePropel *>(fix)->needs_contacts();
      });
  measuring = std::any_of(frictions.begin(), frictions.end(), [](const Fix *fix) {
    return static_cast<const FixDeformableFriction *>(fix)->has_films();
  });

  const char *const id = FixDeformableRestart::ID;
  if (!modify->get_fix_by_id(id)) modify->add_fix(fmt::format("{} all deformable/restart", id));

  walls.clear();
  for (Fix *fix : modify->get_fix_by_style(FixDeformableWall::STYLE))
    walls.push_back(static_cast<FixDeformableWall *>(fix));
  refuse_scaled();
  check_lines_bend("Species", adhesions.any());
  for (const FixDeformableWall *wall : walls)
    check_lines_bend(fmt::format("Fix {} deformable/wall", wall->id), wall->adhesion() > 0.0);
}

/* ----------------------------------------------------------------------
   hybrid/scaled scales the forces that this style leaves on the atoms, and its
   energy. It does not know what fixes do with the same contacts.
------------------------------------------------------------------------- */

void PairDeformable::refuse_scaled() const
{
  if (!utils::strmatch(force->pair_style, "^hybrid/scaled")) return;
  const auto refuse_with = [this](const std::string &what) {
    error->all(FLERR,
               "Pair style hybrid/scaled would not scale {}: use 'pair_style hybrid/overlay', with "
               "a species file of kA, kP, tension and adhesion times the factor",
               what);
  };
  for (const FixDeformableWall *wall : walls)
    refuse_with(fmt::format("the forces of fix {} deformable/wall", wall->id));
  for (const Fix *fix : modify->get_fix_by_style(FixDeformableFriction::STYLE))
    refuse_with(fmt::format("the forces of fix {} deformable/friction", fix->id));
  for (const FixDeformableProliferate *fix : proliferations)
    if (fix->has_pressure())
      refuse_with(fmt::format("the pressures of fix {} deformable/proliferate", fix->id));
  if (adhesions.any()) refuse_with("the energy that films of adhesion lose");
}

double PairDeformable::init_one(int i, int j)
{
  if (setflag[i][j] == 0) error->all(FLERR, "All pair coeffs are not set");
  return (1.0 + reach) * (radius[i] + radius[j]);
}

void PairDeformable::begin_call(int eflag, int vflag)
{
  ev_init(eflag, vflag);
  // a minimization that has ended with an error did not say so, and 'run N pre no' may follow
  if (update->whichflag != 2) accept_imbalance(0.0);
  beyond_model = 0;
  recording = has_computes || std::any_of(proliferations.begin(), proliferations.end(),
                                          [](const auto *fix) { return fix->needs_contacts(); });
  recorded.clear();
  materials.species = species.data();
  materials.type = atom->type;
  loaded.clear();
  if (neighbor->ago == 0) {
    refusals.collect([this] { check_contacts(lmp, *list, species); });
    if (atom->radius_flag && !radius_by_atom && !warned_unused_radii)
      warned_unused_radii = warn_unused_radii(lmp, *list, species);
    bulge_over_reach = 0.0;
  }
  if (neighbor->ago == 0 || radius_by_atom) {
    radii.resize(atom->nlocal + atom->nghost);
    for (std::size_t i = 0; i < radii.size(); ++i)
      radii[i] = radius_by_atom ? atom->radius[i] : radius[atom->type[i]];
  }
  if (radius_by_atom) refusals.collect([this] { check_radii(); });
  if (neighbor->ago == 0 || radius_by_atom) refusals.agree();
  if (neighbor->ago == 0) smallest = smallest_radius();
  for (FixDeformableWall *wall : walls) wall->begin_call(this);

  if (!results.requested) return;
  results.resize(atom->nmax);
  if (list->inum < atom->nlocal) results.clear(atom->nlocal);    // particles of other pair styles
}

ForceCall PairDeformable::force_call()
{
  ForceCall call;
  call.list = list;
  call.materials = &materials;
  call.radius = radii.data();
  call.radii_vary = radius_by_atom;
  call.walls = &walls;
  call.reach = reach;
  call.smallest = smallest;
  call.new_list = neighbor->ago == 0;
  call.tallies = vflag_either || eflag_atom;
  call.refusals = &refusals;
  return call;
}

/* ----------------------------------------------------------------------
   Compute pair sums pvector over ranks. Ranks compare their values only when
   the neighbor list is new, so that other steps need no communication.
------------------------------------------------------------------------- */

void PairDeformable::end_call()
{
  // laws whose ranks do not share forces have not agreed on anything yet
  if (whole_list || eflag_global || neighbor->ago == 0) refusals.agree();
  if (vflag_fdotr) virial_fdotr_compute();

  // also at the end of each run, after which particles may be written to a file
  const bool output = eflag_global && update->whichflag == 1;
  if (dimension == 2 && !warned_out_of_plane && (neighbor->ago == 0 || output))
    warned_out_of_plane = warn_out_of_plane(lmp, *list);

  pvector[0] = beyond_model;
  if (neighbor->ago != 0) return;
  double local[2] = {bulge_over_reach, static_cast<double>(beyond_model)}, largest[2];
  MPI_Allreduce(local, largest, 2, MPI_DOUBLE, MPI_MAX, world);
  pvector[1] = comm->me == 0 ? largest[0] : 0.0;
  if (largest[1] > 0.0 && !warned_beyond_model) {
    warned_beyond_model = true;
    int all = 0;
    MPI_Reduce(&beyond_model, &all, 1, MPI_INT, MPI_SUM, 0, world);
    if (comm->me == 0)
      error->warning(FLERR,
                     "{} of {} particles are beyond the model: {} energy and forces continue the "
                     "law without a known error. 'compute ID all pair' counts them",
                     all, atom->natoms, what_is_beyond());
  }
}

void PairDeformable::refuse_behind_center(int i, int j, double dx, double dy)
{
  if (!std::isfinite(dx + dy))
    refuse("The positions of atoms {} and {} are no numbers any more: the motion before was too "
           "fast for its timestep, or beyond the model. Use a smaller timestep",
           atom->tag[i], atom->tag[j]);
  refuse("The contact line of atoms {} and {} does not lie well in front of the center of atom {}: "
         "their distance is {:.6g}, their radii are {:.6g} and {:.6g}. Separate particles that "
         "overlap first, start from a less compressed state, or take smaller steps or a smaller "
         "timestep",
         atom->tag[i], atom->tag[j], atom->tag[i], std::hypot(dx, dy), radii[i], radii[j]);
}

void PairDeformable::check_own_image(int i, int j)
{
  if (atom->tag[j] != atom->tag[i] || atom->tag[i] == 0) return;
  refuse("Atom {} of radius {:.6g} has no area left between its own images: the box, {:.6g} "
         "x {:.6g}, is too small for it",
         atom->tag[i], radii[i], domain->xprd, domain->yprd);
}

/* ----------------------------------------------------------------------
   Contacts without length and force, which the outline does not touch, are
   left out.
------------------------------------------------------------------------- */

void PairDeformable::record(int i, int partner, const Contact &contact, double length, double force,
                            const Vector2 &push, double distance, const RecordedLine &line)
{
  if (!recording || (length == 0.0 && force == 0.0)) return;
  const double height = radii[i] - contact.indentation;
  const double *x = atom->x[i];
  recorded.push_back({i, partner < 0 ? wall_code(wall_of(partner), 0) : atom->tag[partner],
                      contact.indentation, length, force, x[0] + height * contact.nx,
                      x[1] + height * contact.ny, contact.angle, distance, line, push});
}

void PairDeformable::list_contacts(int groupbit, std::vector<double> &rows) const
{
  for (const RecordedContact &contact : recorded) {
    if (!(atom->mask[contact.atom] & groupbit)) continue;
    rows.insert(rows.end(),
                {static_cast<double>(atom->tag[contact.atom]), static_cast<double>(contact.partner),
                 contact.indentation, contact.length, contact.force, contact.x, contact.y,
                 contact.angle, contact.distance, contact.line.tilt, contact.line.half_angle,
                 contact.push.x, contact.push.y, contact.line.contact_angle,
                 contact.line.attached});
  }
}

/* ----------------------------------------------------------------------
   The lines of the closed polygon, counterclockwise.
------------------------------------------------------------------------- */

void PairDeformable::list_outlines(int groupbit, int points, std::vector<double> &rows) const
{
  std::vector<std::vector<RecordedContact>> of_atom(atom->nlocal);
  for (const RecordedContact &contact : recorded) of_atom[contact.atom].push_back(contact);
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    if (!(atom->mask[i] & groupbit)) continue;
    Outline outline;
    outline_of(i, of_atom[i], points, outline);
    const std::size_t size = outline.pieces.size();
    for (std::size_t k = 0; k < size; ++k) {
      const Piece &piece = outline.pieces[k];
      const double *const one = &outline.xy[2 * k], *const other =
                                                        &outline.xy[2 * (k + 1) % (2 * size)];
      const tagint partner = piece.contact == Outline::FREE ? 0 : of_atom[i][piece.contact].partner;
      const double *const x = atom->x[i];
      rows.insert(rows.end(),
                  {static_cast<double>(atom->tag[i]), static_cast<double>(atom->type[i]),
                   static_cast<double>(partner), x[0] + one[0], x[1] + one[1], x[0] + other[0],
                   x[1] + other[1], piece.turn});
    }
  }
}

bool PairDeformable::is_by_atom(int iarg, char **arg) const
{
  const std::string choice = arg[iarg];
  if (choice != "type" && choice != "atom")
    error->all(FLERR_WORD(iarg), "pair_style deformable/* {} '{}' is neither 'type' nor 'atom'",
               arg[iarg - 1], choice);
  return choice == "atom";
}

PairDeformable::Balance PairDeformable::read_balance(const std::string &style, int iarg,
                                                     char **arg) const
{
  Balance given;
  given.tolerance = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
  given.evaluations = utils::inumeric(FLERR, arg[iarg + 2], false, lmp);
  if (!(given.tolerance > 0.0 && given.tolerance < 1.0))
    error->all(FLERR_WORD(iarg + 1),
               "pair_style {} balance: the tolerance {} must lie between 0 and 1", style,
               arg[iarg + 1]);
  if (given.evaluations < 2)    // forces change after the first one
    error->all(FLERR_WORD(iarg + 2),
               "pair_style {} balance: {} evaluations are too few, give 2 or more", style,
               arg[iarg + 2]);
  return given;
}

int PairDeformable::read_threads(const std::string &style, const char *value) const
{
  if (!strcmp(value, "auto")) return DualSolver::ALL_CORES;
  if (!utils::is_integer(value) || utils::inumeric(FLERR, value, false, lmp) < 1)
    error->all(FLERR, "pair_style {} threads {} must be 'auto', or a number from 1 on", style,
               value);
  return utils::inumeric(FLERR, value, false, lmp);
}

void PairDeformable::check_ramped_species() const
{
  for (const Species &s : species) {
    if (s.name.empty()) continue;
    const std::string problem = invalid_values(s);
    if (!problem.empty()) error->all(FLERR, "Species {} in a run: {}", s.name, problem);
    check_species(s);
  }
}

/* ----------------------------------------------------------------------
   Values that fix adapt has set since the last call.
------------------------------------------------------------------------- */

bool PairDeformable::take_ramps()
{
  const std::string odd = ramps.of_two_types(species);
  if (!odd.empty())
    error->all(FLERR,
               "A fix adapt sets {}, but stiffnesses and tensions belong to one type: give it the "
               "same type twice",
               odd);
  const bool new_species = ramps.take(species), new_adhesion = adhesions.take();
  unchecked |= new_species || new_adhesion;
  if (!unchecked) return false;
  ramps.fill(species);
  check_ramped_species();
  const std::string problem = adhesions.problem(species);
  if (!problem.empty()) error->all(FLERR, "Adhesion in a run: {}", problem);
  check_films(species, adhesions);
  check_lines_bend("Species", adhesions.any());
  if (bends_lines()) find_films();
  unchecked = false;
  number_definition();
  return true;
}

/* ----------------------------------------------------------------------
   A wall with adhesion touches the species of the atoms in its group.
------------------------------------------------------------------------- */

std::string PairDeformable::invalid_at_wall(double adhesion, int i) const
{
  return invalid_for_adhesion(adhesion, stiffness_of(i), species[atom->type[i]].skin);
}

void PairDeformable::check_adhesive_walls()
{
  for (const FixDeformableWall *wall : walls) {
    if (wall->adhesion() == 0.0) continue;
    for (int ii = 0; ii < list->inum; ++ii) {
      const int i = list->ilist[ii];
      if (!(atom->mask[i] & wall->groupbit)) continue;
      const Species &s = species[atom->type[i]];
      const std::string problem = invalid_at_wall(wall->adhesion(), i);
      if (!problem.empty())
        refuse("Fix {} deformable/wall: atom {} of species {}: {}", wall->id, atom->tag[i], s.name,
               problem);
    }
  }
}

// The memory of attached pairs outlives this pair style: another one may continue the run.
void PairDeformable::find_films()
{
  bool sticks = adhesions.any();
  for (const FixDeformableWall *wall : walls) sticks |= wall->adhesion() > 0.0;
  if (!sticks && !films) return;
  const std::string name = FixDeformableFilms::ID;
  Fix *fix = modify->get_fix_by_id(name);
  if (!fix && films)
    error->all(FLERR,
               "Fix {} was deleted, which knew the attached pairs: define the pair_style again. "
               "'fix_modify {} attached none' lets them go",
               name, name);
  if (!fix) fix = modify->add_fix(fmt::format("{} all deformable/films", name));
  if (!films) use_films();
  films = dynamic_cast<FixDeformableFilms *>(fix);
  if (!films) error->all(FLERR, "A fix has the ID {}, which contacts that stick need", name);
}

/* ----------------------------------------------------------------------
   Radii may change between runs and in a run, but must not exceed the radius
   of the species, which sets the cutoff. Data files round them to 16 digits.
------------------------------------------------------------------------- */

void PairDeformable::check_radii()
{
  constexpr double ROUNDING = 1.0 + 1e-12;
  int largest = -1;    // of the atoms whose radius is too large
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    const double r = radii[i];
    const Species &s = species[atom->type[i]];
    if (r > s.skin && r <= s.radius * ROUNDING) {
      const std::string unstable = unstable_radius(r - s.skin, stiffness_of(i));
      if (unstable.empty()) continue;
      refuse("Atom {} of species {}: {}", atom->tag[i], s.name, unstable);
    }
    if (!(r > 0.0)) refuse("Atom {} has a radius of {:.6g}: it must be positive", atom->tag[i], r);
    if (r <= s.skin)
      refuse("Atom {} has a radius of {:.6g}: it must be larger than the skin of species {}, "
             "which is {}",
             atom->tag[i], r, s.name, s.skin);
    if (largest < 0 || r > radii[largest]) largest = i;
  }
  if (largest < 0) return;
  const Species &s = species[atom->type[largest]];
  refuse("Atom {} has a radius of {:.6g}, but species {} allows {} at most: set the radius in "
         "the species file to the largest one of its atoms",
         atom->tag[largest], radii[largest], s.name, s.radius);
}

double PairDeformable::smallest_radius() const
{
  double here = std::numeric_limits<double>::infinity();
  for (int ii = 0; ii < list->inum; ++ii) here = std::min(here, radii[list->ilist[ii]]);
  return smallest_of_ranks(world, here);
}

void PairDeformable::list_springs(double gap, std::vector<Spring> &springs) const
{
  const double *const *const x = atom->x;
  const bool in_space = dimension == 3;
  springs.clear();
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii], *const neighbors = list->firstneigh[i];
    for (int jj = 0; jj < list->numneigh[i]; ++jj) {
      const int j = neighbors[jj] & NEIGHMASK;
      if (j < i) continue;    // whole lists have both sides
      const Vector3 d = {x[j][0] - x[i][0], x[j][1] - x[i][1], in_space ? x[j][2] - x[i][2] : 0.0};
      const double sum = radii[i] + radii[j], distance = length(d);
      if (distance < (1.0 + gap) * sum && distance > 0.0)
        springs.push_back({i, j, (1.0 / distance) * d, distance, sum - distance});
    }
    visit_walls(walls, i, radii[i], gap, [&](int, const SurfacePoint &point) {
      springs.push_back({i, -1, point.n, point.height, radii[i] - point.height});
    });
  }
}

double PairDeformable::memory_usage()
{
  return Pair::memory_usage() + bytes_of(recorded, loaded, radii) + results.bytes();
}

/* ----------------------------------------------------------------------
   What another program, such as the Python package, asks of a pair style to
   know whether it still is the one that it defined, and what else acts on its
   contacts. LAMMPS' library passes it on (extract_pair). And what a restart
   file tells.
------------------------------------------------------------------------- */

void PairDeformable::number_definition()
{
  static double last = 0.0;
  asked.definition = ++last;
}

void *PairDeformable::extract(const char *name, int &dim)
{
  dim = 0;
  if (!strcmp(name, "definition")) return &asked.definition;
  if (!strcmp(name, "walls")) {
    asked.walls = static_cast<double>(modify->get_fix_by_style(FixDeformableWall::STYLE).size());
    return &asked.walls;
  }
  if (!strcmp(name, "friction")) {
    asked.friction =
        static_cast<double>(modify->get_fix_by_style(FixDeformableFriction::STYLE).size());
    return &asked.friction;
  }
  if (!strcmp(name, "exclusions")) {
    asked.exclusions = neighbor->exclude;
    return &asked.exclusions;
  }
  // the number of the first fix whose forces minimizers pass over, or 0; fixes that Python makes do not count
  if (!strcmp(name, "forces of motion")) {
    asked.forces_of_motion = 0.0;
    for (int n = modify->nfix - 1; n >= 0; --n) {
      const int mask = modify->fmask[n];
      const bool passed = (mask & FixConst::POST_FORCE && !(mask & FixConst::MIN_POST_FORCE)) ||
                          (mask & FixConst::PRE_REVERSE && !(mask & FixConst::MIN_PRE_REVERSE));
      if (passed && !utils::strmatch(modify->fix[n]->id, "^deformable_"))
        asked.forces_of_motion = n + 1.0;
    }
    return &asked.forces_of_motion;
  }
  // what the species file says, by atom type: "species radius"
  if (!utils::strmatch(name, "^species ")) return nullptr;
  asked.by_type.clear();
  for (const Species &s : species)
    for (const auto &[of_species, value] : numbers_of(s))
      if (name == "species " + of_species) asked.by_type.push_back(value);
  if (asked.by_type.empty()) return nullptr;
  dim = 1;
  return asked.by_type.data();
}

void *PairDeformable::extract_peratom(const char *name, int &ncol)
{
  ncol = 0;
  return results.extract(name);
}

/* ----------------------------------------------------------------------
   Values of pair_coeff, which fix adapt may change later.
------------------------------------------------------------------------- */

void PairDeformable::describe_species()
{
  defined.clear();
  for (std::size_t type = 1; type < species.size(); ++type) {
    const Species &s = species[type];
    if (s.name.empty()) continue;
    std::string text = s.name;
    for (const auto &[name, value] : numbers_of(s)) text += fmt::format(" {} {}", name, value);
    defined[fmt::format("type {}", type)] = text;
    for (std::size_t other = type; other < species.size(); ++other)
      if (const double w = adhesions.between(static_cast<int>(type), static_cast<int>(other)))
        defined[fmt::format("adhesion of types {} and {}", type, other)] = fmt::format("{}", w);
  }
}

std::map<std::string, std::string> PairDeformable::description() const
{
  std::map<std::string, std::string> all = defined;
  const std::string of_atoms = radius_by_atom ? " radius atom" : "";
  for (std::size_t type = 1; type < species.size(); ++type)
    if (!species[type].name.empty()) all[fmt::format("law of type {}", type)] = law() + of_atoms;
  return all;
}

std::vector<PairDeformable *> deformable::require_deformable_pairs(LAMMPS *lmp,
                                                                   const std::string &command)
{
  const char *const style = lmp->force->pair_style;
  std::vector<PairDeformable *> pairs = deformable_pairs(*lmp->force);
  if (pairs.empty())
    lmp->error->all(FLERR,
                    "{} needs pair_style deformable/ring, deformable/sector or deformable/droplet, "
                    "but pair_style is {}",
                    command, style ? style : "none");
  return pairs;
}

double *ParticleResults::extract(const char *name)
{
  const char *const *const names = dimension == 2 ? NAMES : NAMES_OF_SURFACE;
  const int size = dimension == 2 ? SIZE : SIZE_OF_SURFACE;
  for (int k = 0; k < size; ++k)
    if (std::strcmp(name, names[k]) == 0) {
      requested = true;
      return values[k].data();
    }
  return nullptr;
}

void ParticleResults::resize(std::size_t particles)
{
  for (std::vector<double> &v : values)
    if (v.size() < particles) v.resize(particles);
}

void ParticleResults::clear(std::size_t particles)
{
  for (std::vector<double> &v : values) std::fill_n(v.begin(), particles, 0.0);
}

void ParticleResults::store_shape(int i, double radius, int contacts, const Shape &shape,
                                  double pressure)
{
  int active = 0;
  double length = 0.0;
  for (int c = 0; c < contacts; ++c) {
    active += shape.contact[c].length != 0.0;
    length += shape.contact[c].length;
  }
  values[AREA][i] = PI * radius * radius - shape.area_deficit;
  values[PERIMETER][i] = 2.0 * PI * radius + shape.perimeter_excess;
  values[CONTACTS][i] = active;
  values[PRESSURE][i] = pressure;
  values[ARC_RADIUS][i] = shape.arc_radius;
  values[CONTACT_LENGTH][i] = length;
}

void ParticleResults::store_circle(int i, double radius, double pressure)
{
  values[AREA][i] = PI * radius * radius;
  values[PERIMETER][i] = 2.0 * PI * radius;
  values[CONTACTS][i] = values[CONTACT_LENGTH][i] = 0.0;
  values[PRESSURE][i] = pressure;
  values[ARC_RADIUS][i] = radius;
}

void ParticleResults::store_surface(int i, const Surface &surface)
{
  values[AREA][i] = surface.area;
  values[CONTACTS][i] = surface.contacts;
  values[PRESSURE][i] = surface.pressure;
  values[CONTACT_AREA][i] = surface.contact_area;
  values[LOAD][i] = surface.load;
}

double ParticleResults::bytes() const
{
  double sum = 0.0;
  for (const std::vector<double> &v : values) sum += bytes_of(v);
  return sum;
}
