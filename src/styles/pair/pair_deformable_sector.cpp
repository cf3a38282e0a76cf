#include "styles/pair/pair_deformable_sector.h"

#include "styles/lammps_release.h"
#include "styles/refusals.h"

#include "laws/parameter_rules.h"

#include "comm.h"
#include "error.h"
#include "fix.h"
#include "modify.h"
#include "update.h"

#include <numeric>

using namespace LAMMPS_NS;
using namespace deformable;

PairDeformableSector::PairDeformableSector(LAMMPS *lmp) : PairDeformable(lmp)
{
  comm_forward = 1;
}

/* ----------------------------------------------------------------------
   After an error that the caller has caught all is as before.
------------------------------------------------------------------------- */

void PairDeformableSector::settings(int narg, char **arg)
{
  bool by_atom = false;
  for (int iarg = 0; iarg < narg; iarg += 2) {
    if (std::string(arg[iarg]) != "radius")
      error->all(FLERR_WORD(iarg),
                 "Unknown pair_style deformable/sector keyword '{}': it must be 'radius'",
                 arg[iarg]);
    if (iarg + 1 >= narg)
      utils::missing_cmd_args(FLERR, "pair_style deformable/sector radius", error);
    by_atom = is_by_atom(iarg + 1, arg);
  }
  number_definition();
  radius_by_atom = by_atom;
  if (std::string(update->unit_style) != "lj" && comm->me == 0)
    error->warning(
        FLERR,
        "Pair style deformable/sector: the energy of a contact that is the only one of a "
        "particle has the number of kA, or kP, as its stiffness, whatever the unit of "
        "length. Use 'units lj' with radii of about 1, or deformable/ring in units {}",
        update->unit_style);
}

void PairDeformableSector::check_species(const Species &s) const
{
  const std::string problem = invalid_for_sectors(s.stiffness, s.skin);
  if (!problem.empty())
    error->all(FLERR,
               "Species {} cannot be used with pair_style deformable/sector: {}. "
               "pair_style deformable/ring has no such limit",
               s.name, problem);
}

void PairDeformableSector::init_style()
{
  PairDeformable::init_style();
  bool moves = false;
  for (const Fix *fix : modify->get_fix_list()) moves |= fix->time_integrate != 0;
  if (moves && update->whichflag == 1 && comm->me == 0)
    error->warning(FLERR,
                   "The energy of pair style deformable/sector jumps where contacts appear: a run "
                   "does not conserve it. Use deformable/ring for dynamics");
}

void PairDeformableSector::compute(int eflag, int vflag)
{
  begin_call(eflag, vflag);
  ncontacts.resize(atom->nmax);
  if (list->inum < atom->nlocal)    // particles of other pair styles have none
    std::fill_n(ncontacts.begin(), atom->nlocal, 0.0);
  singles.clear();
  refusals.collect([this] {
    blocks.for_each(
        kernels->sector,
        [this](BlockParticle &p) {
          ncontacts[p.name] = p.active;
          if (p.active == 1) set_aside(p);
        },
        sector_group,
        [this](BlockParticle &p, const Contacts &contacts) { return deform(p, contacts); },
        [](const BlockParticle &) {});
  });

  comm->forward_comm(this);
  for (const SingleContact &single : singles) repel(single);
  end_call();
}

/* ----------------------------------------------------------------------
   Takes the contact of a particle with a single one out of the block.
------------------------------------------------------------------------- */

void PairDeformableSector::set_aside(BlockParticle &p)
{
  blocks.check_lines(p);
  const Place &place = blocks.block.places[p.first];
  const PlacedLine line = line_of(p, place);
  singles.push_back({p.name, blocks.partner_of(place), line.contact,
                     (place.partner < 0 ? 0.5 : 1.0) / line.per_distance});
  p.active = 0;
}

/* ----------------------------------------------------------------------
   Shape and energy of a particle with two contacts or more.
------------------------------------------------------------------------- */

Energy PairDeformableSector::deform(BlockParticle &p, const Contacts &contacts)
{
  by_angle.resize(contacts.size);
  std::iota(by_angle.begin(), by_angle.end(), 0);
  const Stiffness &k = p.stiffness;
  const bool conserves_perimeter = std::isinf(k.kP);
  if (conserves_perimeter)
    sector_shape(p.radius, contacts, by_angle.data(), shape);
  else if (!area_sector_shape(p.radius, contacts, by_angle.data(), shape))
    refuse("Atom {} has no shape that keeps the area of each of its sectors: its {} contacts "
           "leave no room. Compress less, or conserve the perimeter (kP = inf)",
           atom->tag[p.name], contacts.size);
  const double change = conserves_perimeter ? shape.area_deficit : shape.perimeter_excess;
  if (!std::isfinite(change))
    refuse("Atom {} has two contacts in the same direction, which leaves no sector between "
           "them: use pair_style deformable/ring",
           atom->tag[p.name]);

  const Energy energy = harmonic(conserves_perimeter ? k.kA : k.kP, change);
  p.pressure = energy.derivative;
  if (!conserves_perimeter) {    // each arc has its own pressure, tension/radius: take the mean over contacts
    double force = 0.0, length = 0.0;
    for (int c = 0; c < contacts.size; ++c) {
      force += energy.derivative * shape.contact[c].d_indentation;
      length += shape.contact[c].length;
    }
    p.pressure = length > 0.0 ? force / length : 0.0;
  }
  return energy;
}

/* ----------------------------------------------------------------------
   U = k/2 (1 - d/(R_i + R_j))^2 for a pair. If both particles have a single
   contact, each adds one half. For a wall, U = k/2 (1 - h/R)^2.
------------------------------------------------------------------------- */

void PairDeformableSector::repel(const SingleContact &single)
{
  const int i = single.atom, j = single.partner;
  const double ri = radii[i], distance = single.distance;
  const double nx = single.contact.nx, ny = single.contact.ny;
  const auto stiffness = [this](int atom_index) {
    const Stiffness &s = species[atom->type[atom_index]].stiffness;
    return std::isinf(s.kA) ? s.kP : s.kA;
  };

  const auto load = [&](double force) {
    if (rubbing)
      loaded.push_back({i,
                        j,
                        -1,
                        {nx, ny, 0.0},
                        middle_of(nx, ny, ri - single.contact.indentation, 0.0),
                        force,
                        0.0,
                        j >= 0});
  };

  if (j < 0) {
    const Energy energy = harmonic(stiffness(i), 1.0 - distance / ri);
    const double force = energy.derivative / ri;
    load(force);
    push_wall(i, j, -force * nx, -force * ny, single.contact, 0.0);
    record(i, j, single.contact, 0.0, force, {-force * nx, -force * ny}, distance);
    if (eflag_global) eng_vdwl += energy.value;
    if (eflag_atom) eatom[i] += energy.value;
    return;
  }

  const double sum = ri + radii[j];
  const double share = ncontacts[j] == 1.0 ? 0.5 : 1.0;
  const Energy energy = harmonic(0.5 * share * (stiffness(i) + stiffness(j)), 1.0 - distance / sum);
  const double force_per_distance = energy.derivative / (sum * distance);
  const double dx = -distance * nx, dy = -distance * ny;    // from the partner to i
  load(force_per_distance * distance);
  record(i, j, single.contact, 0.0, force_per_distance * distance / share,
         {force_per_distance * dx, force_per_distance * dy}, distance);
  double *const *const f = atom->f;
  f[i][0] += force_per_distance * dx;
  f[i][1] += force_per_distance * dy;
  f[j][0] -= force_per_distance * dx;
  f[j][1] -= force_per_distance * dy;
  if (evflag) ev_tally(i, j, atom->nlocal, 1, energy.value, 0.0, force_per_distance, dx, dy, 0.0);
}

void PairDeformableSector::outline_of(int i, const std::vector<RecordedContact> &of_particle,
                                      int points, Outline &outline) const
{
  std::vector<Contact> lines;
  for (const RecordedContact &at : of_particle)
    lines.push_back({at.angle, std::cos(at.angle), std::sin(at.angle), at.indentation});
  std::vector<int> order(lines.size());
  std::iota(order.begin(), order.end(), 0);
  const Contacts contacts = {static_cast<int>(lines.size()), lines.data()};
  if (std::isinf(species[atom->type[i]].stiffness.kP))
    sector_outline(radii[i], contacts, order.data(), points, outline,
                   [](const Opening &o, double ai, double ak) {
                     return sector(sector_coefficients(o), ai, ak);
                   });
  else
    sector_outline(radii[i], contacts, order.data(), points, outline,
                   [&](const Opening &o, double ai, double ak) {
                     return area_sector(radii[i], o, ai, ak).part;
                   });
}

int PairDeformableSector::pack_forward_comm(int n, int *owned, double *buf, int, int *)
{
  for (int k = 0; k < n; ++k) buf[k] = ncontacts[owned[k]];
  return n;
}

void PairDeformableSector::unpack_forward_comm(int n, int first, double *buf)
{
  for (int k = 0; k < n; ++k) ncontacts[first + k] = buf[k];
}

double PairDeformableSector::memory_usage()
{
  return PairDeformable::memory_usage() + blocks.bytes() + bytes_of(by_angle, singles, ncontacts);
}
