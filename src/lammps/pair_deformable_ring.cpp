#include "pair_deformable_ring.h"

#include "contact.h"
#include "support.h"

#include "comm.h"
#include "error.h"
#include "neighbor.h"

#include <algorithm>
#include <cmath>
#include <string>

using namespace LAMMPS_NS;
using namespace deformable;

/* ---------------------------------------------------------------------- */

void PairDeformableRing::settings(int narg, char **arg)
{
  reach = 0.1;
  radius_by_atom = false;
  balance.reset();
  int balance_words = 0;
  double tolerance = 1e-8;
  int limit = 100;
  for (int iarg = 0; iarg < narg;) {
    const std::string keyword = arg[iarg];
    const int values = keyword == "balance" ? 2 : 1;
    if (keyword != "contact" && keyword != "balance" && keyword != "reach" && keyword != "radius")
      error->all(FLERR, iarg,
                 "Unknown pair_style deformable/ring keyword '{}': it knows 'contact', 'balance', "
                 "'reach' and 'radius'",
                 keyword);
    if (iarg + values >= narg)
      utils::missing_cmd_args(FLERR, "pair_style deformable/ring " + keyword, error);
    if (keyword == "contact") {
      const std::string where = arg[iarg + 1];
      if (where != "radical" && where != "balanced")
        error->all(FLERR, iarg + 1,
                   "pair_style deformable/ring contact '{}' is neither 'radical' nor 'balanced'",
                   where);
      balance.reset(where == "balanced" ? new ContactBalance(lmp) : nullptr);
    } else if (keyword == "balance") {
      balance_words = iarg + 1;
      tolerance = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
      limit = utils::inumeric(FLERR, arg[iarg + 2], false, lmp);
      if (!(tolerance > 0.0 && tolerance < 1.0))
        error->all(FLERR, iarg + 1,
                   "pair_style deformable/ring balance: the tolerance {} must lie between 0 and 1",
                   arg[iarg + 1]);
      if (limit < 1)
        error->all(FLERR, iarg + 2,
                   "pair_style deformable/ring balance: {} iterations are too few, give 1 or more",
                   arg[iarg + 2]);
    } else if (keyword == "radius") {
      set_radius(iarg + 1, arg);
    } else {
      reach = utils::numeric(FLERR, arg[iarg + 1], false, lmp);
      if (!(reach > 0.0))
        error->all(FLERR, iarg + 1, "pair_style deformable/ring reach {} must be positive",
                   arg[iarg + 1]);
    }
    iarg += 1 + values;
  }
  if (balance) {
    balance->tolerance = tolerance;
    balance->limit = limit;
  } else if (balance_words > 0) {
    error->all(FLERR, balance_words - 1,
               "pair_style deformable/ring balance is for 'contact balanced' only");
  }
}

/* ---------------------------------------------------------------------- */

void PairDeformableRing::init_style()
{
  PairDeformable::init_style();
  if (balance && !atom->tag_enable)
    error->all(FLERR,
               "Pair style deformable/ring contact balanced needs atom IDs: 'atom_modify id yes'");

  soft = false;
  for (const Species &s : species) soft |= s.radius > 0.0 && !s.stiffness.conserves_perimeter();
}

/* ---------------------------------------------------------------------- */

void PairDeformableRing::compute(int eflag, int vflag)
{
  if (walls.empty())
    soft ? evaluate<false, true>(eflag, vflag) : evaluate<false, false>(eflag, vflag);
  else
    soft ? evaluate<true, true>(eflag, vflag) : evaluate<true, false>(eflag, vflag);
}

/* ---------------------------------------------------------------------- */

template <bool WALLS, bool SOFT> void PairDeformableRing::evaluate(int eflag, int vflag)
{
  begin_call(eflag, vflag);
  if (neighbor->ago == 0) smallest = smallest_radius();
  if (balance)
    evaluate_balanced<WALLS, SOFT>();
  else
    for_each_particle<WALLS>([&](int i, const Contacts &contacts) {
      finish<WALLS>(i, contacts, deform<SOFT>(i, contacts));
    });
  end_call();
}

/* ---------------------------------------------------------------------- */

template <bool SOFT> Energy PairDeformableRing::deform(int i, const Contacts &contacts)
{
  const int type = atom->type[i];
  char *const carries =
      carried.of(i, contacts.size, [](char *first, char *last) { std::fill(first, last, 0); });
  if (SOFT && !species[type].stiffness.conserves_perimeter()) {
    Energy energy;
    soft_ring_shape(ring_radius_of(i), species[type].stiffness, contacts, carries, programme, shape,
                    energy);
    return energy;
  }
  ring_shape(ring_radius_of(i), contacts, carries, programme, shape);
  return harmonic(species[type].stiffness.kA, shape.area_deficit);
}

/* ---------------------------------------------------------------------- */

template <bool WALLS>
void PairDeformableRing::finish(int i, const Contacts &contacts, const Energy &energy)
{
  if (energy.derivative == 0.0) return store_circle(i);
  if (!std::isfinite(energy.derivative)) no_shape(i, contacts.size);
  apply<WALLS>(i, contacts, energy);
  store_shape(i, contacts, energy.derivative);
  if (neighbor->ago == 0) check_reach(i, contacts);
}

/* ----------------------------------------------------------------------
   Contact lines where both sides press alike. No force depends on how the
   lines follow the particles, because the energy is stationary in that.
------------------------------------------------------------------------- */

template <bool WALLS, bool SOFT> void PairDeformableRing::evaluate_balanced()
{
  gather<WALLS>();
  radical.resize(table.contact.size());
  responses.resize(table.contact.size());
  deformed.resize(atom->nlocal);
  for (std::size_t c = 0; c < radical.size(); ++c) radical[c] = table.contact[c].indentation;

  const bool settled = balance->settle(
      table, neighbor->ago == 0, [this](const char *acts) { return sweep<SOFT>(acts); },
      [this](int i) { return pressed(i); });
  if (!settled && !unbalanced) {
    unbalanced = true;
    if (comm->me == 0)
      error->warning(FLERR,
                     "Contacts are not balanced: after {} iterations forces of both sides differ "
                     "by up to {:.2g} of the largest. Allow more iterations, or more tolerance "
                     "than {:.2g} (pair_style deformable/ring balance)",
                     balance->sweeps, balance->residual, balance->tolerance);
  }

  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    const Contacts contacts = table.of(i);
    const Deformed &d = deformed[i];
    shape.reset(contacts.size, 0.0);
    shape.area_deficit = d.area_deficit;
    shape.perimeter_excess = d.perimeter_excess;
    shape.arc_radius = d.arc_radius;
    if (contacts.size > 0)
      std::copy_n(&responses[table.first(i)], contacts.size, shape.contact.begin());
    finish<WALLS>(i, contacts, d.energy);
  }
  if (comm->me != 0) return;
  pvector[2] = balance->sweeps;
  pvector[3] = balance->residual;
}

/* ---------------------------------------------------------------------- */

template <bool SOFT> ContactBalance::Load PairDeformableRing::sweep(const char *acts)
{
  ContactBalance::Load load = {0.0, 0.0};
  for (int ii = 0; ii < list->inum; ++ii) {
    const int i = list->ilist[ii];
    Deformed &d = deformed[i];
    if (!acts[i]) {
      load.energy += d.energy.value;
      load.largest = std::max(load.largest, d.largest);
      continue;
    }
    const Contacts contacts = table.of(i);
    const std::size_t first = contacts.size > 0 ? table.first(i) : 0;
    const int sides = balance->sides_of(i);
    for (int c = 0; c < sides; ++c)
      table.contact[first + c].indentation = radical[first + c] + balance->shift(i, c);

    const Energy energy = deform<SOFT>(i, contacts);
    std::copy_n(shape.contact.begin(), contacts.size, responses.begin() + first);
    double largest = 0.0;
    for (int c = 0; c < contacts.size; ++c) {
      const double force = energy.derivative * shape.contact[c].length;
      largest = std::max(largest, force);
      if (c < sides) balance->press(i, c, force);
    }
    d = {shape.area_deficit, shape.perimeter_excess, shape.arc_radius, largest, energy};
    load.energy += energy.value;
    load.largest = std::max(load.largest, largest);
  }
  return load;
}

/* ---------------------------------------------------------------------- */

PressedRing PairDeformableRing::pressed(int i) const
{
  const int type = atom->type[i];
  const Deformed &d = deformed[i];
  return {ring_radius_of(i),
          d.perimeter_excess / (2.0 * PI),
          species[type].stiffness,
          d.energy.derivative,
          table.of(i),
          &responses[table.first(i)]};
}

/* ---------------------------------------------------------------------- */

void PairDeformableRing::no_shape(int i, int contacts)
{
  error->one(FLERR,
             "Atom {} has no shape that keeps its area: its {} contacts leave no room. Compress "
             "less, or give species {} a finite kA",
             atom->tag[i], contacts, species[atom->type[i]].name);
}

/* ----------------------------------------------------------------------
   The outline reaches out of the undeformed circle where it bulges and
   because the whole ring has moved out. Within depth it meets no line that is
   not a candidate: walls, and lines with the smallest particles, which come
   nearest, lie at least as far out. Only the largest bulge is asked for.
------------------------------------------------------------------------- */

void PairDeformableRing::check_reach(int i, const Contacts &contacts)
{
  const double r = radius_of(i), cutoff = (1.0 + reach) * (r + smallest);
  const double depth =
      std::min(reach * r, -contact_line(cutoff, 1.0 / cutoff, r, smallest).indentation_i);
  const double breath = shape.perimeter_excess / (2.0 * PI);
  if (breath + ring_bulge_at_most(contacts, shape) <= bulge_over_reach * depth) return;
  const double ratio = (breath + ring_bulge(ring_radius_of(i), contacts, shape)) / depth;
  if (ratio > 1.0)
    error->one(
        FLERR,
        "The outline of atom {} bulges by {:.4g}, {:.3g} times as far as 'reach {}' looks "
        "for neighbors: use a reach of {:.2g} or more, or press it less (part particles that "
        "overlap first, take smaller steps or a smaller timestep)",
        atom->tag[i], ratio * depth, ratio, reach, 1.2 * ratio * reach);
  if (ratio > bulge_over_reach) bulge_over_reach = ratio;
}

/* ---------------------------------------------------------------------- */

double PairDeformableRing::memory_usage()
{
  return PairDeformable::memory_usage() + carried.bytes() + bytes_of(deformed, responses, radical) +
         (balance ? balance->memory_usage() : 0.0);
}
