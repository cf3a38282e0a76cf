#include "styles/friction/fix_deformable_friction.h"

#include "laws/trigonometry.h"
#include "styles/lammps_release.h"
#include "styles/pair/pair_deformable.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "input.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using namespace FixConst;
using deformable::Friction;
using deformable::Rub;

// Between runs the elastic force of a contact may change by this part of it, as contacts are balanced to 1e-8.
static constexpr double BALANCED = 1e-6;

/* ---------------------------------------------------------------------- */

FixDeformableFriction::FixDeformableFriction(LAMMPS *lmp, int narg, char **arg)
    : FixPartnerMemory(lmp, narg, arg, STYLE),
      words(utils::join_words({arg + std::min(3, narg), arg + narg}, " ")),
      coefficients(lmp, narg, arg),
      box_rate(lmp)
{
  scalar_flag = vector_flag = extscalar = extvector = 1;
  size_vector = OUTPUTS;
  global_freq = 1;
  ecouple_flag = 1;
  energy_global_flag = 1;    // see FixDeformableWall
  virial_global_flag = virial_peratom_flag = thermo_virial = 1;
  local_flag = local_freq = 1;
  size_local_cols = COLUMNS;
  size_local_rows = 0;    // until the first run
  comm_reverse = 6;
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
  if (utils::strmatch(update->integrate_style, "^respa"))
    error->all(FLERR, "Fix {} deformable/friction cannot be used with run_style respa", id);
  if (thermo_energy)
    error->all(FLERR,
               "Fix {} deformable/friction: 'fix_modify {} energy yes' would count its losses as "
               "potential energy. Use the thermo keyword econserve, or f_{}[1] for the springs",
               id, id, id);
  pairs = deformable_pairs(*force);
  if (pairs.empty())
    error->all(FLERR,
               "Fix {} deformable/friction needs pair_style deformable/ring, but pair_style is {}",
               id, force->pair_style ? force->pair_style : "none");
  for (const PairDeformable *pair : pairs)
    if (!pair->slips())
      error->all(FLERR,
                 "Fix {} deformable/friction needs contacts that slip, but those of pair_style "
                 "deformable/sector stick: use deformable/ring",
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
  if (told) return;
  told = true;
  if (comm->me != 0) return;
  if (!atom->omega_flag || !atom->torque_flag) {
    utils::logmesg(
        lmp,
        "Fix {} deformable/friction: atoms of atom_style {} have no spins, so that they "
        "only translate. For rotation use 'atom_style sphere' and 'fix nve/sphere disc'\n",
        id, atom->get_style());
    return;
  }
  const std::vector<Fix *> &fixes = modify->get_fix_list();
  const bool any = std::any_of(fixes.begin(), fixes.end(), [](const Fix *fix) {
    return utils::strmatch(fix->style, "sphere") || utils::strmatch(fix->style, "^rigid");
  });
  if (!any)
    error->warning(FLERR,
                   "Fix {} deformable/friction: no fix turns the particles, so that their spins do "
                   "not change. Use 'fix nve/sphere disc' or another style with 'sphere'",
                   id);
}

void FixDeformableFriction::check_box()
{
  if (told_box || !domain->deform_flag || domain->deform_vremap) return;
  told_box = true;
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
    if (atom->mask[i] & groupbit)
      least = std::min(least, atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]]);
  MPI_Allreduce(&least, &lightest, 1, MPI_DOUBLE, MPI_MIN, world);
}

void FixDeformableFriction::check_time_step() const
{
  if (update->whichflag != 1) return;             // minimizers pass over friction
  constexpr double SPHERE = 3.5;                  // 1 + m R^2/I; 3 of a disk
  const double mass = lightest / force->ftm2v;    // force time^2/distance units
  const double longest = coefficients.largest_time_step(mass, atom->omega_flag ? SPHERE : 1.0);
  if (update->dt > longest)
    error->all(FLERR,
               "Fix {} deformable/friction: the time step {:.6g} is too long for these stiffnesses "
               "and particles of mass {:.6g}: use {:.3g} or less, or smaller kt, gt or damp",
               id, update->dt, lightest, longest);
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
  for (PairDeformable *pair : pairs)
    for (const LoadedContact &contact : pair->loaded) rub(contact);
  sweep();
  if (vflag_atom) comm->reverse_comm(this);

  size_local_rows = static_cast<int>(values.size());
  rows.resize(size_local_rows + 1);
  for (int r = 0; r < size_local_rows; ++r) rows[r] = values[r].data();
  array_local = rows.data();
}

/* ----------------------------------------------------------------------
   Whether this rank and this fix are in charge. Of two images of a particle in
   its own box, (i, j) is as good as (j, i).
------------------------------------------------------------------------- */

bool FixDeformableFriction::find_sides(const LoadedContact &c, Sides &sides,
                                       ContactPlace &place) const
{
  const double *const xi = atom->x[c.i];
  if (!(atom->mask[c.i] & groupbit)) return false;
  sides = {c.i, c.j, c.i};
  place = {0.0,  0.0, c.height * c.nx - c.shift * c.ny, c.height * c.ny + c.shift * c.nx,
           c.nx, c.ny};
  if (c.j < 0) return true;
  if (!(atom->mask[c.j] & groupbit)) return false;
  place.x = atom->x[c.j][0] - xi[0];
  place.y = atom->x[c.j][1] - xi[1];
  if (c.one_side || atom->tag[c.i] <= atom->tag[c.j]) return true;
  sides = {c.j, c.i, c.second};
  place = place.from_partner();
  return c.second >= 0;
}

// Of the half step before.
FixDeformableFriction::Velocity FixDeformableFriction::velocity(const Sides &s) const
{
  const double *const *const v = atom->v, *const *const omega = atom->omega;
  const double *const own = v[s.particle];
  Velocity w = {-own[0], -own[1], 0.0, 0.0};
  if (atom->omega_flag) w.spin = omega[s.particle][2];
  if (s.partner < 0) return w;
  w.x += v[s.partner][0];
  w.y += v[s.partner][1];
  if (atom->omega_flag) w.other_spin = omega[s.partner][2];
  return w;
}

/* ----------------------------------------------------------------------
   At the middle of a contact: with its present place, or with that at the
   begin of the step, its age.
------------------------------------------------------------------------- */

inline FixDeformableFriction::Speeds FixDeformableFriction::speeds(const Sides &s,
                                                                   const Velocity &w,
                                                                   const ContactPlace &p,
                                                                   double age) const
{
  const double vx = w.x + w.spin * p.by - w.other_spin * (p.by - p.y);
  const double vy = w.y - w.spin * p.bx + w.other_spin * (p.bx - p.x);
  Speeds found = {p.nx * vy - p.ny * vx, p.nx * vx + p.ny * vy, 0.0, 0.0};
  if (s.partner < 0 && dt > 0.0 && pairs.front()->has_wall(s.partner)) {
    const double *const x = atom->x[s.particle], *const v = atom->v[s.particle];
    const deformable::Point way = pairs.front()->wall(s.partner).way(
        pairs.front()->wall_feature(s.partner), x[0] + p.bx - age * v[0], x[1] + p.by - age * v[1]);
    found.wall_along = (p.nx * way.y - p.ny * way.x) / dt;
    found.wall_normal = (p.nx * way.x + p.ny * way.y) / dt;
    found.along += found.wall_along;
    found.normal += found.wall_normal;
  }
  return found;
}

// The contact with this partner whose place is the nearest one, as a small box has several images of it; or null. Between a
// particle and its own image both directions are one.
static RememberedContact *find_contact(std::vector<RememberedContact> &contacts, double partner,
                                       const ContactPlace &place, bool own_image)
{
  const auto square = [](double x, double y) { return x * x + y * y; };
  double nearest = square(place.x, place.y);
  RememberedContact *found = nullptr;
  for (RememberedContact &c : contacts) {
    if (c.partner != partner) continue;
    double distance = square(c.place.x - place.x, c.place.y - place.y);
    if (own_image) distance = std::min(distance, square(c.place.x + place.x, c.place.y + place.y));
    if (distance > nearest) continue;
    nearest = distance;
    found = &c;
  }
  return found;
}

/* ---------------------------------------------------------------------- */

void FixDeformableFriction::rub(const LoadedContact &contact)
{
  Sides sides;
  ContactPlace place;
  if (!find_sides(contact, sides, place)) return;
  const bool is_wall = sides.partner < 0;
  const int i = sides.rememberer, *const type = atom->type;
  const double partner =
      is_wall ? pairs.front()->wall_key(sides.partner) : atom->tag[sides.partner];
  const bool own_image = !is_wall && atom->tag[sides.partner] == atom->tag[i];

  Friction c =
      coefficients.between(type[i], is_wall ? FrictionCoefficients::WALL : type[sides.partner]);
  const double part = contact.one_side ? 0.5 : 1.0;
  c.kt *= part;
  c.gt *= part;
  c.gn *= part;

  std::vector<RememberedContact> &contacts = particles[i].rows;
  RememberedContact *remembered = find_contact(contacts, partner, place, own_image);
  const bool is_new = !remembered;
  if (is_new) {
    remember(i, {partner, c.kt, place, 0.0, 0.0, 0.0, 0.0, 0.0});
    remembered = &contacts.back();
  }
  RememberedContact &m = *remembered;
  const Velocity w = velocity(sides);
  const Speeds now = speeds(sides, w, place, 0.0);
  const double most = deformable::most_friction(c.mu, contact.force);
  Rub rubbed = {m.xi, 0.0, false};
  double damping = 0.0;
  if (dt > 0.0) {
    const Speeds before = is_new ? now : speeds(sides, w, m.place, dt);
    rubbed = deformable::rub(c, m.xi, 0.5 * dt * (before.along + now.along), dt, contact.force);
    damping = deformable::damping(c.gn, 0.5 * dt * (before.normal + now.normal), dt, contact.force);
    lose(sides, m, 0.5 * (m.kt + c.kt), rubbed, damping, before, now);
  } else {
    rubbed.force = std::clamp(is_new ? c.gt * now.along : m.force, -most, most);
    damping = std::min(is_new ? c.gn * now.normal : m.damping, std::max(contact.force, 0.0));
    rubbed.slides = std::fabs(rubbed.force) >= (1.0 - BALANCED) * most;
  }
  m = {partner, c.kt, place, rubbed.xi, rubbed.force, damping, contact.one_side ? 1.0 : 0.0, 1.0};
  push(sides, place, {rubbed.force, damping});

  output[CONTACTS] += part;
  if (rubbed.slides) output[SLIDES] += part;
  const double *const x = atom->x[sides.particle];
  values.push_back({static_cast<double>(atom->tag[i]), is_wall ? 0.0 : partner, x[0] + place.bx,
                    x[1] + place.by, deformable::angle_of(place.nx, place.ny), contact.force,
                    rubbed.force, damping, rubbed.xi, rubbed.slides ? 1.0 : 0.0,
                    is_wall ? partner : 0.0});
}

/* ----------------------------------------------------------------------
   Of a step between two forces on this contact. If kt changes it is the mean
   one: what the change itself does to the spring is no loss.
------------------------------------------------------------------------- */

void FixDeformableFriction::lose(const Sides &sides, const RememberedContact &m, double kt,
                                 const Rub &rubbed, double damping, const Speeds &before,
                                 const Speeds &now)
{
  const double half = 0.5 * dt;
  const deformable::RubLoss loss =
      deformable::loss(kt, {m.xi, m.force, false}, rubbed, half * (before.along + now.along));
  output[SLIDING] += loss.sliding;
  output[DASHPOTS] += loss.dashpot;
  output[DAMPING] += half * (m.damping * before.normal + damping * now.normal);
  if (sides.partner >= 0 || !pairs.front()->has_wall(sides.partner)) return;
  pairs.front()
      ->wall(sides.partner)
      .do_work(-half * (m.force * before.wall_along + m.damping * before.wall_normal +
                        rubbed.force * now.wall_along + damping * now.wall_normal));
}

/* ----------------------------------------------------------------------
   The force on the particle at the middle of the contact, the opposite one on
   its partner.
------------------------------------------------------------------------- */

void FixDeformableFriction::push(const Sides &s, const ContactPlace &p, const Pushes &force)
{
  const double fx = force.normal * p.nx - force.along * p.ny;
  const double fy = force.normal * p.ny + force.along * p.nx;
  double *const *const f = atom->f, *const *const torque = atom->torque;
  const bool spins = atom->torque_flag;
  if (spins) torque[s.particle][2] += p.bx * fy - p.by * fx;
  if (s.partner < 0)
    return pairs.front()->wall(s.partner).add_friction(s.particle, fx, fy, p.bx, p.by);
  f[s.particle][0] += fx;
  f[s.particle][1] += fy;
  f[s.partner][0] -= fx;
  f[s.partner][1] -= fy;
  if (spins) torque[s.partner][2] -= (p.bx - p.x) * fy - (p.by - p.y) * fx;
  if (!evflag) return;
  int both[] = {s.particle, s.partner};
  double v[] = {-p.x * fx, -p.y * fy, 0.0, -0.5 * (p.x * fy + p.y * fx), 0.0, 0.0};
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
        stored += 0.5 * m.kt * m.xi * m.xi;
        ++c;
        continue;
      }
      if (dt > 0.0) end(i, m);
      m = contacts.back();
      contacts.pop_back();
    }
  }
  output[STORED] = stored;
}

// Across a sheared boundary images of a partner have velocities of their own.
void FixDeformableFriction::end(int i, const RememberedContact &m)
{
  int partner = static_cast<int>(m.partner);
  if (m.partner > 0.0) {
    const double *const x = atom->x[i], there[] = {x[0] + m.place.x, x[1] + m.place.y, x[2]};
    partner = domain->closest_image(there, atom->map(static_cast<tagint>(m.partner)));
    if (partner < 0) return;    // it is gone
  }
  const Sides sides = {i, partner, i};
  const Speeds before = speeds(sides, velocity(sides), m.place, dt);
  lose(sides, m, m.kt, {0.0, 0.0, false}, 0.0, before, before);
}

/* ----------------------------------------------------------------------
   The scalar is the energy stored and lost. The vector has its parts, the
   number of contacts, and how many of them slide.
------------------------------------------------------------------------- */

double FixDeformableFriction::total(int n) const
{
  double here = output[n], all;    // MPI of LAMMPS' stubs takes no constants
  MPI_Allreduce(&here, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

double FixDeformableFriction::compute_scalar()
{
  return total(STORED) + total(SLIDING) + total(DASHPOTS) + total(DAMPING);
}

double FixDeformableFriction::compute_vector(int n)
{
  return total(n);
}

/* ---------------------------------------------------------------------- */

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

/* ---------------------------------------------------------------------- */

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
   The same from a text: fix_modify ID springs none, or springs I J x y xi f_t f_d ...,
   and fix_modify ID lost E_sliding E_dashpots E_damping
------------------------------------------------------------------------- */

int FixDeformableFriction::modify_param(int narg, char **arg)
{
  constexpr int LOSSES = 3, WORDS = 7;
  const std::string word = arg[0];
  const auto number = [&](int n) { return utils::numeric(FLERR, arg[n], false, lmp); };
  if (word == "lost" && narg > LOSSES) {
    for (int n = 0; n < LOSSES; ++n) output[SLIDING + n] = comm->me == 0 ? number(1 + n) : 0.0;
    return 1 + LOSSES;
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
  std::vector<double> words, partners;
  for (int n = 1; n < narg; ++n) words.push_back(number(n));
  for (std::size_t n = 0; n < words.size(); n += WORDS)
    partners.insert(partners.end(), {words[n], words[n + 1]});
  require_partners(partners, command);
  const std::unordered_map<double, int> here = local_indices();
  for (std::size_t n = 0; n < words.size(); n += WORDS) {
    const auto found = here.find(words[n]);    // or another rank has it
    if (found != here.end()) give_spring(found->second, &words[n]);
  }
  return narg;
}

// With contact radical both particles of a pair have a spring: a row that begins with the larger ID is such a spring.
void FixDeformableFriction::give_spring(int i, const double *words)
{
  RememberedContact m = {};
  m.partner = words[1];
  m.place.x = words[2];
  m.place.y = words[3];
  m.xi = words[4];
  m.force = words[5];
  m.damping = words[6];
  m.one_side = m.partner > 0.0 && m.partner < words[0] ? 1.0 : 0.0;
  remember(i, m);
}

/* ----------------------------------------------------------------------
   Stresses of particles, ghosts included.
------------------------------------------------------------------------- */

int FixDeformableFriction::pack_reverse_comm(int n, int first, double *buffer)
{
  for (int i = first; i < first + n; ++i) buffer = std::copy_n(vatom[i], 6, buffer);
  return 6 * n;
}

void FixDeformableFriction::unpack_reverse_comm(int n, int *list, double *buffer)
{
  for (int k = 0; k < n; ++k)
    for (int c = 0; c < 6; ++c) vatom[list[k]][c] += *buffer++;
}

/* ---------------------------------------------------------------------- */

bool BoxRate::Box::operator==(const Box &other) const
{
  return std::equal(low, low + 3, other.low) && std::equal(h, h + 6, other.h);
}

BoxRate::Box BoxRate::present() const
{
  Box box{};
  std::copy_n(domain->boxlo, 3, box.low);
  std::copy_n(domain->h, 6, box.h);
  return box;
}

void BoxRate::remember()
{
  before = present();
  step = update->ntimestep;
}

void BoxRate::end_run()
{
  at_end = present();
}

// A run that goes on where the last one ended knows the change of the box after its last step.
void BoxRate::begin_run()
{
  if (step != update->ntimestep || !(present() == at_end)) remember();
}

/* ----------------------------------------------------------------------
   Of each fix deform the sides and tilts that it changes. A box that it has not
   changed yet keeps LAMMPS' rates.
------------------------------------------------------------------------- */

void BoxRate::measure()
{
  if (!domain->deform_vremap || step != update->ntimestep - 1) return;
  const int changes[] = {Fix::BOX_CHANGE_X,  Fix::BOX_CHANGE_Y,  Fix::BOX_CHANGE_Z,
                         Fix::BOX_CHANGE_YZ, Fix::BOX_CHANGE_XZ, Fix::BOX_CHANGE_XY};
  const Box now = present();
  if (now == before) return;
  for (const Fix *fix : modify->get_fix_by_style("^deform")) {
    if (step % fix->nevery != 0) continue;
    const double time = fix->nevery * update->dt;
    for (int k = 0; k < 6; ++k) {
      if (!(fix->box_change & changes[k])) continue;
      domain->h_rate[k] = (now.h[k] - before.h[k]) / time;
      if (k < 3) domain->h_ratelo[k] = (now.low[k] - before.low[k]) / time;
    }
  }
}

/* ---------------------------------------------------------------------- */

FrictionCoefficients::FrictionCoefficients(LAMMPS *lmp, int narg, char **arg)
    : Pointers(lmp),
      id(arg[0]),
      types(atom->ntypes + 1),
      table(types * types)
{
  if (narg < 6) utils::missing_cmd_args(FLERR, "fix deformable/friction", error);
  Rule all = {{WALL, WALL}, {types - 1, types - 1}};
  for (int n = 0; n < 3; ++n) all.of_friction[n] = read(arg[3 + n]);
  int iarg = 6;
  if (iarg < narg && std::string(arg[iarg]) == "damp") {
    if (iarg + 1 == narg) utils::missing_cmd_args(FLERR, "fix deformable/friction damp", error);
    all.of_friction[3] = read(arg[iarg + 1]);
    iarg += 2;
  }
  rules.push_back(all);
  for (; iarg < narg; iarg += 7) {
    if (std::string(arg[iarg]) != "types")
      error->all(FLERR_WORD(iarg),
                 "Fix {} deformable/friction: unknown word '{}': after mu, kt and gt come 'damp' "
                 "and its value, then any number of 'types'",
                 id, arg[iarg]);
    if (iarg + 6 >= narg) utils::missing_cmd_args(FLERR, "fix deformable/friction types", error);
    read_types(arg + iarg + 1);
  }
  for (const Rule &rule : rules) {
    for (const Coefficient &c : rule.of_friction) varying |= !c.variable.empty();
    apply(rule);
  }
}

/* ----------------------------------------------------------------------
   I J mu kt gt gn: types or ranges of them; J may be the word wall.
------------------------------------------------------------------------- */

void FrictionCoefficients::read_types(char **arg)
{
  Rule rule = {{WALL, WALL}, {WALL, WALL}};
  for (int n = 0; n < 2; ++n)
    if (n == 0 || std::string(arg[n]) != "wall")
      utils::bounds(FLERR, arg[n], 1, types - 1, rule.first[n], rule.last[n], error);
  for (int n = 0; n < 4; ++n) rule.of_friction[n] = read(arg[2 + n]);
  rules.push_back(rule);
}

FrictionCoefficients::Coefficient FrictionCoefficients::read(char *word) const
{
  if (utils::strmatch(word, "^v_.")) return {0.0, word + 2};
  if (std::string(word) == "inf") return {std::numeric_limits<double>::infinity(), ""};
  return {utils::numeric(FLERR, word, false, lmp), ""};
}

/* ---------------------------------------------------------------------- */

void FrictionCoefficients::find_variables()
{
  for (Rule &rule : rules)
    for (Coefficient &c : rule.of_friction) {
      if (c.variable.empty()) continue;
      c.index = input->variable->find(c.variable.c_str());
      if (c.index < 0 || !input->variable->equalstyle(c.index))
        error->all(FLERR,
                   "Fix {} deformable/friction: v_{} needs an equal-style variable: use "
                   "'variable {} equal ...'",
                   id, c.variable, c.variable);
    }
}

void FrictionCoefficients::evaluate()
{
  modify->clearstep_compute();
  for (Rule &rule : rules) {
    for (Coefficient &c : rule.of_friction)
      if (c.index >= 0) c.value = input->variable->compute_equal(c.index);
    apply(rule);
  }
  modify->addstep_compute(update->ntimestep + 1);
}

void FrictionCoefficients::apply(const Rule &rule)
{
  const auto &[mu, kt, gt, gn] = rule.of_friction;
  const Friction c = {mu.value, kt.value, gt.value, gn.value};
  const std::string problem = deformable::invalid_friction(c);
  if (!problem.empty()) error->all(FLERR, "Fix {} deformable/friction: {}", id, problem);
  for (int a = rule.first[0]; a <= rule.last[0]; ++a)
    for (int b = rule.first[1]; b <= rule.last[1]; ++b)
      table[a * types + b] = table[b * types + a] = c;
}

double FrictionCoefficients::largest_time_step(double mass, double lever) const
{
  double least = std::numeric_limits<double>::infinity();
  for (const Friction &c : table)
    least = std::min(least, deformable::largest_time_step(c, mass, lever));
  return least;
}
