#include "styles/pair/pair_deformable_ring.h"

#include "styles/lammps_release.h"
#include "styles/refusals.h"

#include "laws/contact.h"
#include "laws/parameter_rules.h"
#include "laws/support.h"

#include "comm.h"
#include "error.h"
#include "force.h"
#include "modify.h"
#include "neighbor.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

using namespace LAMMPS_NS;
using namespace deformable;

// A ring of constant perimeter, even pressed flat, bulges by (pi/2 - 1) R. Far more than this is not an outline,
// and its candidates overflow the neighbor list.
static constexpr double LARGEST_REACH = 3.0;

/* ---------------------------------------------------------------------- */

void PairDeformableRing::settings(int narg, char **arg)
{
  number_definition();
  reach = 0.0;
  radius_by_atom = kA_by_atom = tension_by_atom = false;
  std::string law = "balanced";
  int balance_keyword = -1;
  double tolerance = 1e-8;
  int max_evaluations = 1000;
  for (int iarg = 0; iarg < narg;) {
    const std::string keyword = arg[iarg];
    const int values = keyword == "balance" ? 2 : 1;
    bool *const by_atom = keyword == "radius"    ? &radius_by_atom
                          : keyword == "kA"      ? &kA_by_atom
                          : keyword == "tension" ? &tension_by_atom
                                                 : nullptr;
    if (keyword != "contact" && keyword != "balance" && keyword != "reach" && !by_atom)
      error->all(FLERR_WORD(iarg),
                 "Unknown pair_style deformable/ring keyword '{}': it must be 'contact', "
                 "'balance', 'reach', 'radius', 'kA' or 'tension'",
                 keyword);
    if (iarg + values >= narg)
      utils::missing_cmd_args(FLERR, "pair_style deformable/ring " + keyword, error);
    if (keyword == "contact") {
      law = arg[iarg + 1];
      if (law != "radical" && law != "balanced" && law != "curved")
        error->all(
            FLERR_WORD(iarg + 1),
            "pair_style deformable/ring contact '{}' is not 'balanced', 'curved' or 'radical'",
            law);
    } else if (keyword == "balance") {
      balance_keyword = iarg;
      tolerance = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
      max_evaluations = utils::inumeric(FLERR, arg[iarg + 2], false, lmp);
      if (!(tolerance > 0.0 && tolerance < 1.0))
        error->all(FLERR_WORD(iarg + 1),
                   "pair_style deformable/ring balance: the tolerance {} must lie between 0 and 1",
                   arg[iarg + 1]);
      if (max_evaluations < 2)    // forces change after the first one
        error->all(FLERR_WORD(iarg + 2),
                   "pair_style deformable/ring balance: {} evaluations are too few, give 2 or more",
                   arg[iarg + 2]);
    } else if (by_atom) {
      *by_atom = is_by_atom(iarg + 1, arg);
    } else {
      reach = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
      if (!(reach > 0.0))
        error->all(FLERR_WORD(iarg + 1), "pair_style deformable/ring reach {} must be positive",
                   arg[iarg + 1]);
      if (reach > LARGEST_REACH)
        error->all(FLERR_WORD(iarg + 1),
                   "pair_style deformable/ring reach {} must be {} at most: no outline bulges "
                   "farther",
                   arg[iarg + 1], LARGEST_REACH);
    }
    iarg += 1 + values;
  }
  const bool radical = law == "radical";
  if (reach == 0.0)
    reach = radical ? 0.3 : 0.6;    // a list of near pairs makes the larger one free
  if (radical && balance_keyword >= 0)
    error->all(FLERR_WORD(balance_keyword),
               "pair_style deformable/ring balance is for 'contact balanced' and 'curved' only");
  balanced.reset(
      radical ? nullptr
              : new RingSolver(lmp, kernels->forces, law == "curved", tolerance, max_evaluations));
  films = nullptr;
  whole_list = radical;
}

/* ---------------------------------------------------------------------- */

std::string PairDeformableRing::law() const
{
  const char *const contact = !balanced                  ? "radical"
                              : balanced->pairs().curved ? "curved"
                                                         : "balanced";
  return fmt::format("deformable/ring contact {}{}{}", contact, kA_by_atom ? " kA atom" : "",
                     tension_by_atom ? " tension atom" : "");
}

void PairDeformableRing::init_style()
{
  PairDeformable::init_style();
  soft_since = NEVER;
  find_properties();
  if (balanced && !atom->tag_enable)
    error->all(FLERR, "Pair style deformable/ring needs atom IDs: use 'atom_modify id yes', or "
                      "'contact radical'");
  stick();
}

// Which pairs are attached outlives this pair style, for those that continue its run.
void PairDeformableRing::stick()
{
  bool sticks = adhesions.any();
  for (const FixDeformableWall *wall : walls) sticks |= wall->adhesion() > 0.0;
  if (!sticks && !films) return;
  const std::string name = FixDeformableFilms::ID;
  Fix *fix = modify->get_fix_by_id(name);
  if (!fix && films)
    error->all(FLERR,
               "Fix {} was deleted, which knew the attached pairs: define pair_style "
               "deformable/ring again. "
               "'fix_modify {} attached none' lets them go",
               name, name);
  if (!fix) fix = modify->add_fix(fmt::format("{} all deformable/films", name));
  if (!films) balanced->stick();
  films = dynamic_cast<FixDeformableFilms *>(fix);
  if (!films) error->all(FLERR, "A fix has the ID {}, which contacts that stick need", name);
}

void PairDeformableRing::coeff(int narg, char **arg)
{
  PairDeformable::coeff(narg, arg);
  ramps.fill(species);
  if (bends_lines()) stick();
}

void *PairDeformableRing::extract(const char *name, int &dim)
{
  if ((kA_by_atom && !strcmp(name, "kA")) || (tension_by_atom && !strcmp(name, "tension")))
    return PairDeformable::extract(name, dim);    // those of species have no effect
  take_ramps();                                   // values that no force call has seen yet
  double **const array =
      !strcmp(name, "adhesion") ? adhesions.array() : ramps.array_of(name, species);
  if (!array) return PairDeformable::extract(name, dim);
  dim = 2;
  return array;
}

/* ----------------------------------------------------------------------
   Values that fix adapt has set since the last call.
------------------------------------------------------------------------- */

bool PairDeformableRing::take_ramps()
{
  const std::string odd = ramps.of_two_types(species);
  if (!odd.empty())
    error->all(FLERR,
               "A fix adapt sets {}, but stiffnesses and tensions belong to one type: give it the "
               "same type twice",
               odd);
  const bool new_species = ramps.take(species) != 0, new_adhesion = adhesions.take();
  unchecked |= new_species || new_adhesion;
  if (!unchecked) return false;
  ramps.fill(species);
  for (const Species &s : species) {
    if (s.name.empty()) continue;
    const std::string wrong = invalid_values(s);
    if (!wrong.empty()) error->all(FLERR, "Species {} in a run: {}", s.name, wrong);
  }
  const std::string wrong = adhesions.problem(species);
  if (!wrong.empty()) error->all(FLERR, "Adhesion in a run: {}", wrong);
  check_lines_bend("Species", adhesions.any());
  stick();
  unchecked = false;
  number_definition();
  return true;
}

/* ----------------------------------------------------------------------
   Species that touch a wall with adhesion are those of the atoms in its group.
------------------------------------------------------------------------- */

void PairDeformableRing::check_sticky_walls()
{
  for (const FixDeformableWall *wall : walls) {
    if (wall->adhesion() == 0.0) continue;
    for (int ii = 0; ii < list->inum; ++ii) {
      const int i = list->ilist[ii];
      if (!(atom->mask[i] & wall->groupbit)) continue;
      const Species &s = species[atom->type[i]];
      const std::string wrong = invalid_for_adhesion(wall->adhesion(), stiffness_of(i), s.skin);
      if (!wrong.empty())
        refuse("Fix {} deformable/wall: atom {} of species {}: {}", wall->id, atom->tag[i], s.name,
               wrong);
    }
  }
}

/* ---------------------------------------------------------------------- */

void PairDeformableRing::compute(int eflag, int vflag)
{
  const bool ramped = take_ramps(), new_material = choose_yield() || ramped;
  materials.kA = kA_by_atom ? atom->dvector[kA_of_atoms] : nullptr;
  materials.tension = tension_by_atom ? atom->dvector[tension_of_atoms] : nullptr;
  begin_call(eflag, vflag);
  if (materials.vary()) refusals.check([this] { check_properties(); });
  if (films && (neighbor->ago == 0 || new_material || materials.vary()))
    refusals.check([this] { check_sticky_walls(); });
  if (neighbor->ago == 0) smallest = smallest_radius();
  if (balanced)
    evaluate_balanced(new_material);
  else
    refusals.collect([this] { evaluate_radical(); });
  end_call();
  tell_room();
}

/* ---------------------------------------------------------------------- */

void PairDeformableRing::evaluate_radical()
{
  for_each_block(
      kernels->ring, [](BlockParticle &) {}, ring_group,
      [this](BlockParticle &p, const Contacts &contacts) {
        Energy energy = shape_ring(p.name, contacts, stiffness_of(p.name));
        if (!std::isfinite(energy.derivative)) energy = shape_without_room(p.name, contacts);
        p.pressure = energy.derivative;
        return energy;
      },
      [this](const BlockParticle &p) {
        giving_way += p.stiffness.gives_way(p.pressure);
        if (neighbor->ago != 0 || p.energy == 0.0) return;
        load_shape(p);
        const Contacts contacts = load_contacts(block, p);
        if (is_within_reach(p.name, contacts)) return;
        const int partner = block.places[p.first + deepest(contacts)].partner;
        refuse_bulge(p.name, contacts, partner < 0 ? wall_contacts[-1 - partner].wall : partner);
      });
}

/* ---------------------------------------------------------------------- */

Energy PairDeformableRing::shape_ring(int i, const Contacts &contacts, const Stiffness &stiffness)
{
  is_active.assign(contacts.size, 0);
  Energy energy;
  soft_ring_shape(ring_radius_of(i), stiffness, contacts, is_active.data(), lcp, shape, energy);
  return energy;
}

/* ----------------------------------------------------------------------
   The outline bulges out of the undeformed circle and expands as a whole. The
   lines of all particles and walls within the cutoff are known; any other
   line is at least `depth` outside of the circle. The nearest of those belong
   to the smallest particles.
------------------------------------------------------------------------- */

double PairDeformableRing::depth_of_reach(int i) const
{
  const double r = radii[i], cutoff = (1.0 + reach) * (r + smallest);
  return std::min(reach * r, -contact_line(cutoff, 1.0 / cutoff, r, smallest).indentation_i);
}

bool PairDeformableRing::is_within_reach(int i, const Contacts &contacts)
{
  const double depth = depth_of_reach(i), expansion = shape.perimeter_excess / (2.0 * PI);
  if (expansion + ring_bulge_at_most(contacts, shape) <= bulge_over_reach * depth) return true;
  const double ratio = (expansion + ring_bulge(ring_radius_of(i), contacts, shape)) / depth;
  if (ratio > 1.0) return false;
  if (ratio > bulge_over_reach) bulge_over_reach = ratio;
  return true;
}

int PairDeformableRing::deepest(const Contacts &contacts)
{
  int deepest = 0;
  for (int c = 1; c < contacts.size; ++c)
    if (contacts[c].indentation > contacts[deepest].indentation) deepest = c;
  return deepest;
}

// partner: of the deepest contact
void PairDeformableRing::refuse_bulge(int i, const Contacts &contacts, int partner)
{
  const double depth = depth_of_reach(i), expansion = shape.perimeter_excess / (2.0 * PI);
  const double ratio = (expansion + ring_bulge(ring_radius_of(i), contacts, shape)) / depth;
  const std::string cause =
      partner >= 0
          ? "separate particles that overlap first"
          : fmt::format(
                "a wall of fix {} cuts it {:.4g} from its center, whose radius is {:.4g}: move "
                "one of them",
                wall_id(partner), radii[i] - contacts[deepest(contacts)].indentation, radii[i]);
  const double enough = 1.2 * ratio * reach;
  const std::string larger =
      enough <= LARGEST_REACH ? fmt::format(" or use a reach of {:.2g} or more", enough) : "";
  const char *const slower = update->whichflag == 1 ? ", slower particles or stiffer ones" : "";
  refuse("The outline of atom {} bulges by {:.6g}, but 'reach {}' covers {:.6g}: {}, take "
         "smaller steps or a smaller timestep{}{}{}",
         atom->tag[i], ratio * depth, reach, depth, cause, slower, larger.empty() ? "" : ",",
         larger);
}

/* ---------------------------------------------------------------------- */

double PairDeformableRing::memory_usage()
{
  return PairDeformable::memory_usage() + (balanced ? balanced->memory_usage() : 0.0);
}
