#include "styles/friction/fix_deformable_friction.h"

#include "laws/trigonometry.h"
#include "styles/lammps_release.h"
#include "styles/pair/pair_deformable.h"
#include "styles/refusals.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

using namespace LAMMPS_NS;
using namespace deformable;
using namespace FixConst;

// Between runs the elastic force of a contact may change by this part of it, as contacts are balanced to 1e-8.
static constexpr double BALANCED = 1e-6;

// A vector of LAMMPS, or of a contact: its components in the plane, or all. Backwards z is 0.
template <class V> static V vector(const double *v);
template <> Vector2 vector<Vector2>(const double *v)
{
  return {v[0], v[1]};
}
template <> Vector3 vector<Vector3>(const double *v)
{
  return {v[0], v[1], v[2]};
}
template <class V> static V narrow(const Vector3 &v)
{
  return vector<V>(&v.x);
}
static Vector3 wide(const Vector2 &v)
{
  return {v.x, v.y, 0.0};
}
static Vector3 wide(const Vector3 &v)
{
  return v;
}

// A spin, or what is along a contact: its third component in the plane, or all.
template <class V> static Along<V> along(const Vector3 &v);
template <> double along<Vector2>(const Vector3 &v)
{
  return v.z;
}
template <> Vector3 along<Vector3>(const Vector3 &v)
{
  return v;
}
static Vector3 wide(double v)
{
  return {0.0, 0.0, v};
}
template <class V> static ContactVector<Vector3> wide(const ContactVector<V> &v)
{
  return {wide(v.along), v.normal};
}
template <class V> static ContactPlace<V> narrow(const ContactPlace<Vector3> &p)
{
  return {narrow<V>(p.r), narrow<V>(p.b), narrow<V>(p.n)};
}

// Its last two words.
static bool has_ledger(LAMMPS *lmp, int narg, char **arg)
{
  return narg > 7 && std::string(arg[narg - 2]) == "ledger" &&
         utils::logical(FLERR, arg[narg - 1], false, lmp);
}
static int before_ledger(int narg, char **arg)
{
  return narg > 7 && std::string(arg[narg - 2]) == "ledger" ? narg - 2 : narg;
}

FixDeformableFriction::FixDeformableFriction(LAMMPS *lmp, int narg, char **arg)
    : FixPartnerMemory(lmp, narg, arg, STYLE),
      words(utils::join_words({arg + std::min(3, narg), arg + narg}, " ")),
      ledger(has_ledger(lmp, narg, arg)),
      coefficients(lmp, before_ledger(narg, arg), arg),
      in_plane(domain->dimension == 2),
      box_rate(lmp)
{
  scalar_flag = vector_flag = extscalar = extvector = 1;
  size_vector = OUTPUTS;
  global_freq = 1;
  ecouple_flag = 1;
  energy_global_flag = 1;    // see FixDeformableWall
  virial_global_flag = virial_peratom_flag = thermo_virial = 1;
  local_flag = local_freq = 1;
  size_local_cols = (in_plane ? 13 : 22) + (ledger ? 4 : 0);
  size_local_rows = 0;    // until the first run
  comm_reverse = 6;
  if (ledger) {
    peratom_flag = peratom_freq = 1;
    size_peratom_cols = 4;
  }
  dynamic_group_allow = 1;
  begin();
}

int FixDeformableFriction::setmask()
{
  return POST_INTEGRATE | PRE_REVERSE | FixPartnerMemory::setmask();
}

/* ----------------------------------------------------------------------
   What it needs before a run, and what it refuses.
------------------------------------------------------------------------- */

void FixDeformableFriction::init()
{
  FixPartnerMemory::init();
  refuse_respa(lmp, id, "deformable/friction");
  if (thermo_energy)
    error->all(FLERR,
               "Fix {} deformable/friction: 'fix_modify {} energy yes' would count its losses as "
               "potential energy. Use the thermo keyword econserve, or f_{}[1] for the springs",
               id, id, id);
  pairs = deformable_pairs(*force);
  if (pairs.empty())
    error->all(FLERR,
               "Fix {} deformable/friction needs pair_style deformable/ring or deformable/droplet, "
               "but pair_style is {}",
               id, force->pair_style ? force->pair_style : "none");
  for (const PairDeformable *pair : pairs)
    if (!pair->slips())
      error->all(FLERR,
                 "Fix {} deformable/friction needs contacts that slip, but those of pair_style "
                 "deformable/sector stick: use deformable/ring",
                 id);
  for (const PairDeformable *pair : pairs)
    if (coefficients.have_restitution() && !pair->knows_energy_alone())
      error->all(
          FLERR,
          "Fix {} deformable/friction: a restitution needs contacts with one force, but those "
          "of 'contact radical' have two: use 'contact balanced' or 'contact curved'",
          id);
  if (!atom->tag_enable)
    error->all(FLERR, "Fix {} deformable/friction needs atom IDs: use 'atom_modify id yes'", id);
  comm->ghost_velocity = 1;
  find_partners();
  check_spins();
  check_box();
  coefficients.find_variables();
  find_lightest();
  if (!coefficients.vary()) check_time_step();    // variables have no values before the first step
}

/* ----------------------------------------------------------------------
   Particles by their IDs: partners that are not in contact any more.
------------------------------------------------------------------------- */

void FixDeformableFriction::find_partners()
{
  if (atom->map_style != Atom::MAP_NONE) return;
  atom->map_init();
  atom->map_set();
}

/* ----------------------------------------------------------------------
   What LAMMPS does not say by itself.
------------------------------------------------------------------------- */

void FixDeformableFriction::check_spins()
{
  if (told_of_spins) return;
  told_of_spins = true;
  if (comm->me != 0) return;
  if (!atom->omega_flag || !atom->torque_flag) {
    utils::logmesg(lmp,
                   "Fix {} deformable/friction: atoms of atom_style {} have no spins, so that they "
                   "only translate. For rotation use 'atom_style sphere' and 'fix nve/sphere{}'\n",
                   id, atom->get_style(), in_plane ? " disc" : "");
    return;
  }
  const std::vector<Fix *> &fixes = modify->get_fix_list();
  for (const Fix *fix : fixes)
    if (in_plane && utils::strmatch(fix->style, "/sphere/omp$"))
      error->warning(FLERR,
                     "Fix {} deformable/friction: fix {} {} turns particles as spheres, even where "
                     "it says 'disc'. For disks write 'suffix off' before it",
                     id, fix->id, fix->style);
  const bool any = std::any_of(fixes.begin(), fixes.end(), [](const Fix *fix) {
    return utils::strmatch(fix->style, "sphere") || utils::strmatch(fix->style, "^rigid");
  });
  if (!any)
    error->warning(FLERR,
                   "Fix {} deformable/friction: no fix turns the particles, so that their spins do "
                   "not change. Use 'fix nve/sphere{}' or another style with 'sphere'",
                   id, in_plane ? " disc" : "");
}

void FixDeformableFriction::check_box()
{
  if (told_of_box || !domain->deform_flag || domain->deform_vremap) return;
  told_of_box = true;
  if (comm->me == 0)
    error->warning(
        FLERR,
        "Fix {} deformable/friction: fix deform without 'remap v' leaves its shear out of "
        "the velocities, so that contacts do not rub by it",
        id);
}

void FixDeformableFriction::find_lightest()
{
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < atom->nlocal; ++i)
    if (atom->mask[i] & groupbit) least = std::min(least, mass_of(i));
  lightest = smallest_of_ranks(world, least);
}

void FixDeformableFriction::check_time_step() const
{
  if (update->whichflag != 1) return;    // minimizers pass over friction
  const double longest = coefficients.largest_time_step(lightest, lever());
  if (update->dt > longest)
    error->all(FLERR,
               "Fix {} deformable/friction: the time step {:.6g} is too long for these stiffnesses "
               "and particles of mass {:.6g}: use {:.3g} or less, or smaller kt, gt or damp",
               id, update->dt, lightest * force->ftm2v, longest);
}

double FixDeformableFriction::mass_of(int i) const
{
  return (atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]]) / force->ftm2v;
}

double FixDeformableFriction::lever() const
{
  constexpr double SPHERE = 3.5;    // 3 of a disk
  return atom->omega_flag ? SPHERE : 1.0;
}

void FixDeformableFriction::reset_dt()
{
  check_time_step();
}

/* ----------------------------------------------------------------------
   Before the first step of a run contacts keep what they have. Snapshots of
   rerun follow the first one within a run, and do not follow from each other.
------------------------------------------------------------------------- */

void FixDeformableFriction::setup_pre_reverse(int, int vflag)
{
  if (update->ntimestep != update->firststep)
    for (int i = 0; i < atom->nlocal; ++i) particles[i].rows.clear();
  dt = 0.0;
  box_rate.begin_run();
  rub_all(vflag);
}

void FixDeformableFriction::pre_reverse(int, int vflag)
{
  dt = update->dt;
  box_rate.remember();
  rub_all(vflag);
}

void FixDeformableFriction::rub_all(int vflag)
{
  if (coefficients.vary()) {
    coefficients.evaluate();
    check_time_step();
  }
  if (neighbor->ago == 0) follow();
  v_init(vflag);
  if (vflag_atom)
    for (int i = atom->nlocal; i < atom->nlocal + atom->nghost; ++i) std::fill_n(vatom[i], 6, 0.0);
  output[CONTACTS] = output[SLIDES] = 0.0;
  values.clear();
  linear_film = largest_dashpot = 0.0;
  largest_film =
      deformable::largest_film_constant(lightest, lever(), update->dt, domain->dimension);
  if (ledger)
    for (int i = atom->nlocal; i < atom->nlocal + atom->nghost; ++i) particles[i].lost = {};
  in_plane ? rub_contacts<Vector2>() : rub_contacts<Vector3>();
  if (has_films() || coefficients.have_restitution()) check_dashpots();
  sweep();
  if (vflag_atom) comm->reverse_comm(this);
  if (ledger && dt > 0.0) {
    blaming = true;
    comm->reverse_comm(this, 4);
    blaming = false;
  }

  size_local_rows = static_cast<int>(values.size()) / size_local_cols;
  rows.resize(size_local_rows + 1);
  for (int r = 0; r < size_local_rows; ++r) rows[r] = &values[r * size_local_cols];
  array_local = rows.data();
}

template <class V> void FixDeformableFriction::rub_contacts()
{
  for (const PairDeformable *pair : pairs)
    for (const LoadedContact &contact : pair->loaded) rub<V>(*pair, contact);
}

/* ----------------------------------------------------------------------
   Whether this rank and this fix are in charge. Of two images of a particle in
   its own box, (i, j) is as good as (j, i).
------------------------------------------------------------------------- */

template <class V>
inline bool FixDeformableFriction::find_sides(const LoadedContact &c, Sides &sides,
                                              ContactPlace<V> &place) const
{
  if (!(atom->mask[c.i] & groupbit)) return false;
  sides = {c.i, c.j, c.i};
  place = {{}, narrow<V>(c.middle), narrow<V>(c.n)};
  if (c.j < 0) return true;
  if (!(atom->mask[c.j] & groupbit)) return false;
  place.r = vector<V>(atom->x[c.j]) - vector<V>(atom->x[c.i]);
  if (c.one_side || atom->tag[c.i] <= atom->tag[c.j]) return true;
  sides = {c.j, c.i, c.owned};
  place = place.from_partner();
  return c.owned >= 0;
}

// Velocities are those of the half step before.
template <class V>
inline FixDeformableFriction::Velocity<V> FixDeformableFriction::velocity(const Sides &s) const
{
  const auto spin_of = [this](int i) {
    return atom->omega_flag ? along<V>(vector<Vector3>(atom->omega[i])) : Along<V>{};
  };
  const V own = -vector<V>(atom->v[s.particle]);
  if (s.partner < 0) return {own, spin_of(s.particle), {}};
  return {own + vector<V>(atom->v[s.partner]), spin_of(s.particle), spin_of(s.partner)};
}

/* ----------------------------------------------------------------------
   At the middle of a contact: with its present place, or with that at the
   begin of the step, its age.
------------------------------------------------------------------------- */

template <class V>
inline FixDeformableFriction::Speeds<V>
FixDeformableFriction::speeds(const Sides &s, const Velocity<V> &w, const ContactPlace<V> &p,
                              double age) const
{
  const V v = w.v - cross(w.spin, p.b) + cross(w.other_spin, p.b - p.r);
  Speeds<V> found = {at_contact(p.n, v), {}};
  if (s.partner < 0 && dt > 0.0 && pairs.front()->has_wall(s.partner)) {
    const V x = vector<V>(atom->x[s.particle]) + p.b - age * vector<V>(atom->v[s.particle]);
    const Vector3 moved = pairs.front()->wall(s.partner).way(wall_feature_of(s.partner), wide(x));
    found.wall = 1.0 / dt * at_contact(p.n, narrow<V>(moved));
    found.v = found.v + found.wall;
  }
  return found;
}

// The contact with this partner whose place is the nearest one, as a small box has several images of it; or null. Between a
// particle and its own image both directions are one.
template <class V>
static RememberedContact *find_contact(std::vector<RememberedContact> &contacts, double partner,
                                       const ContactPlace<V> &place, bool own_image)
{
  const auto square = [](const V &v) { return dot(v, v); };
  double nearest = square(place.r);
  RememberedContact *found = nullptr;
  for (RememberedContact &c : contacts) {
    if (c.partner != partner) continue;
    const V r = narrow<V>(c.place.r);
    double distance = square(r - place.r);
    if (own_image) distance = std::min(distance, square(r + place.r));
    if (distance > nearest) continue;
    nearest = distance;
    found = &c;
  }
  return found;
}

// What is along a contact, after its normal has turned from n to m.
static double turn(double v, const Vector2 &, const Vector2 &)
{
  return v;
}
static Vector3 turn(const Vector3 &v, const Vector3 &n, const Vector3 &m)
{
  return turned(v, n, m);
}

// The dashpot that has this restitution, where this contact bears the force.
double FixDeformableFriction::dashpot(const PairDeformable &pair, const Sides &s, double ratio,
                                      double force)
{
  if (!(force > 0.0)) return 0.0;
  double energy = pair.energy_alone(s.particle, s.partner, force), mass = mass_of(s.particle);
  if (s.partner >= 0) {
    energy += pair.energy_alone(s.partner, s.particle, force);
    const double other = mass_of(s.partner);
    mass *= other / (mass + other);
  }
  const double found = deformable::dashpot(ratio, mass, force, energy);
  largest_dashpot = std::max(largest_dashpot, found);
  return found;
}

template <class V>
void FixDeformableFriction::rub(const PairDeformable &pair, const LoadedContact &contact)
{
  Sides sides;
  ContactPlace<V> place;
  if (!find_sides(contact, sides, place)) return;
  const bool is_wall = sides.partner < 0;
  const int i = sides.rememberer, *const type = atom->type;
  const double partner =
      is_wall ? pairs.front()->wall_key(sides.partner) : atom->tag[sides.partner];
  const bool own_image = !is_wall && atom->tag[sides.partner] == atom->tag[i];

  Friction c =
      coefficients.between(type[i], is_wall ? FrictionCoefficients::WALL : type[sides.partner]);
  const double part = contact.one_side ? 0.5 : 1.0;
  for (double *const value : {&c.kt, &c.gt, &c.gn, &c.film}) *value *= part;
  if (c.ratio > 0.0) c.gn = dashpot(pair, sides, c.ratio, contact.force);

  std::vector<RememberedContact> &contacts = particles[i].rows;
  RememberedContact *remembered = find_contact(contacts, partner, place, own_image);
  const bool is_new = !remembered;
  if (is_new) {
    remember(
        i,
        {partner, c.kt, {wide(place.r), wide(place.b), wide(place.n)}, {}, {}, {}, 0.0, 0.0, 0.0});
    remembered = &contacts.back();
  }
  RememberedContact &m = *remembered;
  ContactPlace<V> then = narrow<V>(m.place);
  if (own_image && dot(then.n, place.n) < 0.0) then = then.from_partner();
  // what it remembers turns with the contact
  const Acting<V> last = {
      {turn(along<V>(m.xi), then.n, place.n), turn(along<V>(m.force), then.n, place.n), false},
      m.damping,
      {turn(along<V>(m.film.along), then.n, place.n), m.film.normal}};
  const Velocity<V> w = velocity<V>(sides);
  const Speeds<V> now = speeds(sides, w, place, 0.0);
  const double most = deformable::most_friction(c.mu, contact.force);
  Acting<V> next = {{last.rub.xi, {}, false}, 0.0, {}};
  Losses power = {};
  if (dt > 0.0) {
    Speeds<V> before = is_new ? now : speeds(sides, w, then, dt);
    before.v.along = turn(before.v.along, then.n, place.n);
    before.wall.along = turn(before.wall.along, then.n, place.n);
    const ContactVector<V> way = 0.5 * dt * (before.v + now.v);
    next.rub = deformable::rub(c, last.rub.xi, way.along, dt, contact.force);
    next.damping = deformable::damping(c.gn, way.normal, dt, contact.force);
    if (c.film > 0.0) next.film = film_force(c, contact.size, 1.0 / dt * way);
    const Losses lost = lose(sides, last, next, 0.5 * (m.kt + c.kt), before, now);
    if (ledger)
      for (std::size_t k = 0; k < lost.size(); ++k) power[k] = lost[k] / dt;
  } else {
    Along<V> force = is_new ? c.gt * now.v.along : last.rub.force;
    const double size = deformable::size_along(force);
    if (size > most) force = most * (force / size);
    next.rub = {last.rub.xi, force, size >= (1.0 - BALANCED) * most};
    next.damping = std::min(is_new ? c.gn * now.v.normal : m.damping, std::max(contact.force, 0.0));
    next.film = last.film;
    if (is_new && c.film > 0.0) next.film = film_force(c, contact.size, now.v);
    if (ledger) power = power_of<V>(c, next, now.v);
  }
  m = {partner,
       c.kt,
       {wide(place.r), wide(place.b), wide(place.n)},
       wide(next.rub.xi),
       wide(next.rub.force),
       wide(next.film),
       next.damping,
       contact.one_side ? 1.0 : 0.0,
       1.0};
  push(sides, place, next.film + ContactVector<V>{next.rub.force, next.damping});
  output[CONTACTS] += part;
  if (next.rub.slides) output[SLIDES] += part;
  list_row(i, sides, place, next, contact.force, power);
}

/* ----------------------------------------------------------------------
   What array_local says of a contact; see the manual.
------------------------------------------------------------------------- */

template <class V>
inline void FixDeformableFriction::list_row(int i, const Sides &sides, const ContactPlace<V> &place,
                                            const Acting<V> &a, double force, const Losses &power)
{
  const V &n = place.n, x = vector<V>(atom->x[sides.particle]) + place.b;
  const double id = static_cast<double>(atom->tag[i]), slide = a.rub.slides ? 1.0 : 0.0;
  const bool is_wall = sides.partner < 0;
  const double partner = is_wall ? 0.0 : static_cast<double>(atom->tag[sides.partner]);
  const double wall = is_wall ? pairs.front()->wall_key(sides.partner) : 0.0;
  if constexpr (std::is_same_v<V, Vector2>) {
    values.insert(values.end(), {id, partner, x.x, x.y, angle_of(n.x, n.y), force, a.rub.force,
                                 a.damping, a.rub.xi, slide, wall, a.film.along, a.film.normal});
  } else {
    const V f = cross(a.rub.force, n), xi = cross(a.rub.xi, n), film = cross(a.film.along, n);
    values.insert(values.end(),
                  {id,    partner, x.x,    x.y,    x.z,       n.x,          n.y,  n.z,
                   force, f.x,     f.y,    f.z,    a.damping, xi.x,         xi.y, xi.z,
                   slide, wall,    film.x, film.y, film.z,    a.film.normal});
  }
  if (!ledger) return;
  // a second insert would be one too many for the compiler to inline: rows without a ledger would cost more
  for (const double each : power) values.push_back(each);
}

/* ----------------------------------------------------------------------
   Of a film with n = 1 the dashpot must be one that fits the time step.
------------------------------------------------------------------------- */

template <class V>
ContactVector<V> FixDeformableFriction::film_force(const Friction &c, double size,
                                                   ContactVector<V> v)
{
  if (!c.film_shears) v.along = {};
  if (!c.film_squeezes) v.normal = 0.0;
  const double g = deformable::film_constant(c, size, std::sqrt(dot(v, v)), largest_film);
  if (c.power == 1.0) linear_film = std::max(linear_film, g);
  return g * v;
}

void FixDeformableFriction::check_dashpots() const
{
  double most[] = {linear_film, largest_dashpot};
  MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, world);
  const auto [of_films, of_restitution] = most;
  if (update->whichflag != 1) return;
  const double film = largest_time_step({1.0, 0.0, of_films, of_films}, lightest, lever());
  if (update->dt > film)
    error->all(FLERR,
               "Fix {} deformable/friction: the time step {:.6g} is too long for a film with the "
               "constant {:.6g} and particles of mass {:.6g}: use {:.3g} or less, or a smaller c",
               id, update->dt, of_films, lightest * force->ftm2v, film);
  const double dashpot = largest_time_step({0.0, 0.0, 0.0, of_restitution}, lightest, lever());
  if (update->dt > dashpot)
    error->all(
        FLERR,
        "Fix {} deformable/friction: the time step {:.6g} is too long for the restitution of "
        "contacts that are pressed so hard: use {:.3g} or less, or a larger restitution",
        id, update->dt, dashpot);
}

/* ----------------------------------------------------------------------
   Of a step between two forces on this contact. If kt changes it is the mean
   one: what the change itself does to the spring is no loss. The spring of a
   contact that ends does not slide, it is let go.
------------------------------------------------------------------------- */

template <class V>
inline FixDeformableFriction::Losses
FixDeformableFriction::lose(const Sides &sides, const Acting<V> &before, const Acting<V> &now,
                            double kt, const Speeds<V> &v_before, const Speeds<V> &v_now, bool ends)
{
  const double half = 0.5 * dt;
  const Along<V> way = half * (v_before.v.along + v_now.v.along);
  const RubLoss loss = deformable::loss(kt, before.rub, now.rub, way);
  const Losses lost = {ends ? 0.0 : loss.sliding, ends ? loss.sliding + loss.dashpot : loss.dashpot,
                       half * (before.damping * v_before.v.normal + now.damping * v_now.v.normal),
                       half * (dot(before.film, v_before.v) + dot(now.film, v_now.v))};
  output[SLIDING] += lost[0];
  output[DASHPOTS] += lost[1];
  output[DAMPING] += lost[2];
  output[FILMS] += lost[3];
  if (ledger) blame(sides, lost);
  if (sides.partner >= 0 || !pairs.front()->has_wall(sides.partner)) return lost;
  const ContactVector<V> force_before =
      before.film + ContactVector<V>{before.rub.force, before.damping};
  const ContactVector<V> force_now = now.film + ContactVector<V>{now.rub.force, now.damping};
  pairs.front()
      ->wall(sides.partner)
      .do_work(-half * (dot(force_before, v_before.wall) + dot(force_now, v_now.wall)));
  return lost;
}

// By the forces and velocities now.
template <class V>
inline FixDeformableFriction::Losses
FixDeformableFriction::power_of(const Friction &c, const Acting<V> &a,
                                const ContactVector<V> &v) const
{
  const RubLoss rubs = deformable::power(c, a.rub, v.along);
  return {rubs.sliding, rubs.dashpot, a.damping * v.normal, dot(a.film, v)};
}

// Half of it to each particle; to one at a wall all.
void FixDeformableFriction::blame(const Sides &sides, const Losses &lost)
{
  const double part = sides.partner < 0 ? 1.0 : 0.5;
  for (std::size_t k = 0; k < lost.size(); ++k) {
    particles[sides.rememberer].lost[k] += part * lost[k];
    if (sides.partner >= 0) particles[sides.partner].lost[k] += part * lost[k];
  }
}

/* ----------------------------------------------------------------------
   The force on the particle at the middle of the contact, the opposite one on
   its partner.
------------------------------------------------------------------------- */

static void add(double *to, const Vector2 &v)
{
  to[0] += v.x;
  to[1] += v.y;
}
static void add(double *to, const Vector3 &v)
{
  to[0] += v.x;
  to[1] += v.y;
  to[2] += v.z;
}
static void add(double *to, double torque)
{
  to[2] += torque;
}

template <class V>
inline void FixDeformableFriction::push(const Sides &s, const ContactPlace<V> &p,
                                        const ContactVector<V> &push)
{
  const V force = from_contact(p.n, push);
  double *const *const f = atom->f, *const *const torque = atom->torque;
  const bool spins = atom->torque_flag;
  if (spins) add(torque[s.particle], cross(p.b, force));
  if (s.partner < 0)
    return pairs.front()->wall(s.partner).add_friction(s.particle, wide(force), wide(p.b));
  add(f[s.particle], force);
  add(f[s.partner], -force);
  if (spins) add(torque[s.partner], -cross(p.b - p.r, force));
  if (!evflag) return;
  int both[] = {s.particle, s.partner};
  const Vector3 r = wide(p.r), F = wide(force);
  double v[] = {-r.x * F.x,
                -r.y * F.y,
                -r.z * F.z,
                -0.5 * (r.x * F.y + r.y * F.x),
                -0.5 * (r.x * F.z + r.z * F.x),
                -0.5 * (r.y * F.z + r.z * F.y)};
  v_tally(2, both, 2.0, v);
}

/* ----------------------------------------------------------------------
   Contacts that have ended lose their springs, and the work of their last
   forces until then. Between runs nothing is counted.
------------------------------------------------------------------------- */

void FixDeformableFriction::sweep()
{
  double stored = 0.0;
  for (int i = 0; i < atom->nlocal; ++i) {
    std::vector<RememberedContact> &contacts = particles[i].rows;
    for (std::size_t c = 0; c < contacts.size();) {
      RememberedContact &m = contacts[c];
      if (m.is_here != 0.0) {
        m.is_here = 0.0;
        stored += dot(0.5 * m.kt * m.xi, m.xi);
        ++c;
        continue;
      }
      if (dt > 0.0) in_plane ? end<Vector2>(i, m) : end<Vector3>(i, m);
      m = contacts.back();
      contacts.pop_back();
    }
  }
  output[STORED] = stored;
}

// Across a sheared boundary images of a partner have velocities of their own.
template <class V> void FixDeformableFriction::end(int i, const RememberedContact &m)
{
  int partner = static_cast<int>(m.partner);
  if (m.partner > 0.0) {
    const double *const x = atom->x[i];
    const double there[] = {x[0] + m.place.r.x, x[1] + m.place.r.y, x[2] + m.place.r.z};
    partner = domain->closest_image(there, atom->map(static_cast<tagint>(m.partner)));
    if (partner < 0) return;    // it is gone
  }
  const Sides sides = {i, partner, i};
  const Speeds<V> before = speeds(sides, velocity<V>(sides), narrow<V>(m.place), dt);
  const Acting<V> last = {{along<V>(m.xi), along<V>(m.force), false},
                          m.damping,
                          {along<V>(m.film.along), m.film.normal}};
  lose(sides, last, {}, m.kt, before, before, true);
}

/* ----------------------------------------------------------------------
   The scalar is the energy stored and lost. The vector has its parts, the
   number of contacts, how many of them slide, and the loss of films.
------------------------------------------------------------------------- */

double FixDeformableFriction::compute_scalar()
{
  const std::vector<double> all = all_sums();
  return all[STORED] + all[SLIDING] + all[DASHPOTS] + all[DAMPING] + all[FILMS];
}

double FixDeformableFriction::compute_vector(int n)
{
  return sum_of_ranks(world, output[n]);
}

void FixDeformableFriction::grow_arrays(int size)
{
  FixPartnerMemory::grow_arrays(size);
  if (!ledger) return;
  of_particles.resize(size);
  for (int i = 0; i < size; ++i) of_particles[i] = particles[i].lost.data();
  array_atom = of_particles.data();
}

double FixDeformableFriction::memory_usage()
{
  return FixPartnerMemory::memory_usage() + bytes_of(values, rows);
}

/* ----------------------------------------------------------------------
   What was lost so far goes on with rank 0.
------------------------------------------------------------------------- */

std::vector<double> FixDeformableFriction::all_sums()
{
  std::vector<double> sums(OUTPUTS);
  MPI_Allreduce(output, sums.data(), OUTPUTS, MPI_DOUBLE, MPI_SUM, world);
  return sums;
}

void FixDeformableFriction::go_on_from(const std::vector<double> &sums)
{
  if (comm->me == 0) std::copy(sums.begin(), sums.end(), output);
}

bool FixDeformableFriction::belongs_to_partner(int i, const RememberedContact &contact) const
{
  return contact.one_side == 0.0 && contact.partner > 0.0 &&
         contact.partner < static_cast<double>(atom->tag[i]);
}

RememberedContact FixDeformableFriction::from_partner(int i, const RememberedContact &contact) const
{
  RememberedContact seen = contact;
  seen.partner = static_cast<double>(atom->tag[i]);
  seen.place = contact.place.from_partner();
  return seen;
}

/* ----------------------------------------------------------------------
   The same from a text: fix_modify ID springs none, or springs I J r xi f_t f_d [film] ...,
   and fix_modify ID lost E_sliding E_dashpots E_damping [E_films]. In space xi, f_t and the part of the
   film along the contact are n x that.
------------------------------------------------------------------------- */

int FixDeformableFriction::modify_param(int narg, char **arg)
{
  constexpr int LOSSES[] = {SLIDING, DASHPOTS, DAMPING, FILMS};
  const int WORDS = words_of_spring();
  const std::string word = arg[0];
  const auto number = [&](int n) { return utils::numeric(FLERR, arg[n], false, lmp); };
  if (word == "lost" && narg > 3) {
    const int losses = narg > 4 && utils::is_double(arg[4]) ? 4 : 3;
    for (int n = 0; n < losses; ++n) output[LOSSES[n]] = comm->me == 0 ? number(1 + n) : 0.0;
    return 1 + losses;
  }
  if (word != "springs" || narg < 2) return 0;
  follow();
  if (narg == 2 && std::string(arg[1]) == "none") {
    for (int i = 0; i < atom->nlocal; ++i) particles[i].rows.clear();
    return narg;
  }
  const std::string command = fmt::format("fix_modify {} springs", id);
  if ((narg - 1) % WORDS)
    error->all(FLERR, "{}: expected 'none', or {} numbers for each contact, not {} words", command,
               WORDS, narg - 1);
  std::vector<double> numbers, partners;
  for (int n = 1; n < narg; ++n) numbers.push_back(number(n));
  for (std::size_t n = 0; n < numbers.size(); n += WORDS)
    partners.insert(partners.end(), {numbers[n], numbers[n + 1]});
  require_partners(partners, command);
  const std::unordered_map<double, int> here = local_indices();
  for (std::size_t n = 0; n < numbers.size(); n += WORDS) {
    const auto found = here.find(numbers[n]);    // or another rank has it
    if (found != here.end()) give_spring(found->second, &numbers[n]);
  }
  return narg;
}

int FixDeformableFriction::words_of_spring() const
{
  return (in_plane ? 7 : 12) + (has_films() ? (in_plane ? 2 : 4) : 0);
}

// With contact radical both particles of a pair have a spring: a row that begins with the larger ID is such a spring.
void FixDeformableFriction::give_spring(int i, const double *numbers)
{
  const double *next = numbers + 2;
  const auto next_vector = [&] {
    const Vector3 v = {next[0], next[1], in_plane ? 0.0 : next[2]};
    next += in_plane ? 2 : 3;
    return v;
  };
  const auto next_along = [&] { return in_plane ? Vector3{0.0, 0.0, *next++} : next_vector(); };
  RememberedContact m = {};
  m.partner = numbers[1];
  m.place.r = next_vector();
  m.xi = next_along();
  m.force = next_along();
  m.damping = *next++;
  if (has_films()) {
    m.film.along = next_along();
    m.film.normal = *next;
  }
  m.one_side = m.partner > 0.0 && m.partner < numbers[0] ? 1.0 : 0.0;
  remember(i, m);
}

/* ----------------------------------------------------------------------
   Stresses of particles, or what they lose, ghosts included.
------------------------------------------------------------------------- */

int FixDeformableFriction::pack_reverse_comm(int n, int first, double *buffer)
{
  if (blaming) {
    for (int i = first; i < first + n; ++i)
      buffer = std::copy_n(particles[i].lost.data(), 4, buffer);
    return 4 * n;
  }
  for (int i = first; i < first + n; ++i) buffer = std::copy_n(vatom[i], 6, buffer);
  return 6 * n;
}

void FixDeformableFriction::unpack_reverse_comm(int n, int *list, double *buffer)
{
  if (blaming) {
    for (int k = 0; k < n; ++k)
      for (double &lost : particles[list[k]].lost) lost += *buffer++;
    return;
  }
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < 6; ++c) vatom[list[k]][c] += *buffer++;
}
