#include "styles/motion/fix_deformable_propel.h"

#include "laws/vector3.h"
#include "styles/lammps_release.h"
#include "styles/motion/counted_random.h"
#include "styles/refusals.h"

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

using namespace LAMMPS_NS;
using namespace deformable;
using namespace FixConst;

namespace {

// How directions in space diffuse in a time step: n turns by the angle theta toward any side, with the density of
// cos(theta)
//   kappa exp(kappa (cos(theta) - 1))/(1 - exp(-2 kappa)),   <cos(theta)> = coth(kappa) - 1/kappa = exp(-dt/tau),
// so that <n(t).n(0)> is that of diffusion for any dt. <(3 (n(t).n(0))^2 - 1)/2> decays at its rate 3/tau to the
// order (dt/tau)^2.
// Source: R. A. Fisher, Proc. R. Soc. Lond. A 217, 295 (1953).
class TurnInSpace {
 public:
  explicit TurnInSpace(double persisted)
  {
    const double less = -std::expm1(-persisted), c = 1.0 - less;
    kappa = std::max(c * (3.0 - c * c) / (less * (1.0 + c)), 1e-8);    // to a few per cent
    if (kappa > 50.0) {
      kappa = 1.0 / less;    // coth = 1
      return;
    }
    constexpr int STEPS = 6;    // of Newton's method; four are enough
    constexpr double SMALL = 1e-2;
    for (int n = 0; n < STEPS && kappa > SMALL; ++n) {
      const double over = 1.0 / kappa, rise = 1.0 / std::sinh(kappa);
      kappa += (c - 1.0 / std::tanh(kappa) + over) / (over * over - rise * rise);
    }
  }

  Vector3 operator()(const Vector3 &n, CountedRandom &random) const
  {
    const double less = -std::log1p(std::expm1(-2.0 * kappa) * random.uniform()) / kappa,
                 angle = 2.0 * PI * random.uniform();
    const Vector3 axis = std::fabs(n.x) < 0.5 ? Vector3{1, 0, 0} : Vector3{0, 1, 0};
    const Vector3 out = across(axis, n), beside = cross(n, out);
    const double sine = std::sqrt(std::max(less * (2.0 - less), 0.0)) / length(out);
    const Vector3 turned =
        (1.0 - less) * n + sine * (std::cos(angle) * out + std::sin(angle) * beside);
    return (1.0 / length(turned)) * turned;
  }

 private:
  double kappa;
};

}    // namespace

FixDeformablePropel::FixDeformablePropel(LAMMPS *lmp, int narg, char **arg)
    : FixMemory(lmp, narg, arg, "propel/active")
{
  if (narg < 6) utils::missing_cmd_args(FLERR, "fix deformable/propel", error);
  if (narg > 6)
    error->all(FLERR_WORD(6), "Unknown fix deformable/propel argument '{}' after the seed", arg[6]);
  strength = utils::numeric(FLERR, arg[3], false, lmp);
  if (!(strength > 0.0))
    error->all(FLERR_WORD(3), "Fix deformable/propel: f is '{}': it must be positive", arg[3]);
  const bool stay = !std::strcmp(arg[4], "inf");    // which LAMMPS does not take for a number
  persistence = stay ? HUGE_VAL : utils::numeric(FLERR, arg[4], false, lmp);
  if (!(persistence > 0.0))
    error->all(FLERR_WORD(4), "Fix deformable/propel: tau is '{}': it must be positive", arg[4]);
  const int number = utils::inumeric(FLERR, arg[5], false, lmp);
  if (number < 0)
    error->all(FLERR_WORD(5), "Fix deformable/propel: the seed is '{}': it must not be negative",
               arg[5]);
  seed = static_cast<std::uint64_t>(number);
  if (!atom->tag_enable)
    error->all(FLERR,
               "Fix {} deformable/propel needs atom IDs, without which no random number "
               "belongs to an atom: use 'atom_modify id yes'",
               id);

  peratom_flag = 1;
  size_peratom_cols = columns = domain->dimension;
  peratom_freq = 1;
  dynamic_group_allow = 1;
  begin();
  for (int i = 0; i < atom->nlocal; ++i) direction_of(i);
}

int FixDeformablePropel::setmask()
{
  return POST_FORCE;
}

void FixDeformablePropel::init()
{
  refuse_respa(lmp, id, "deformable/propel");
}

/* ----------------------------------------------------------------------
   A step has the directions at its end: a run begins with the directions that
   the last run has left.
------------------------------------------------------------------------- */

void FixDeformablePropel::setup(int)
{
  push(0.0);
}

void FixDeformablePropel::post_force(int)
{
  push(update->dt / persistence);
}

/* ----------------------------------------------------------------------
   Turn for this time over tau, then push. In the plane the angle changes by a
   normal deviate.
------------------------------------------------------------------------- */

void FixDeformablePropel::push(double persisted)
{
  const bool in_space = columns == 3;
  const double angle_per_deviation = std::sqrt(2.0 * persisted);
  const TurnInSpace turned(persisted > 0.0 ? persisted : 1.0);
  for (int i = 0; i < atom->nlocal; ++i) {
    if (!(atom->mask[i] & groupbit)) continue;
    double *const n = direction_of(i);
    if (persisted > 0.0) {
      CountedRandom random(seed, atom->tag[i], update->ntimestep);
      if (in_space) {
        const Vector3 now = turned({n[0], n[1], n[2]}, random);
        std::copy_n(&now.x, 3, n);
      } else {
        const double angle = std::atan2(n[1], n[0]) + angle_per_deviation * random.gaussian();
        n[0] = std::cos(angle);
        n[1] = std::sin(angle);
      }
    }
    for (int k = 0; k < columns; ++k) atom->f[i][k] += strength * n[k];
  }
}

/* ----------------------------------------------------------------------
   A particle that is new gets one, which depends on its ID alone.
------------------------------------------------------------------------- */

double *FixDeformablePropel::direction_of(int i)
{
  double *const n = of(i);
  if (std::any_of(n, n + columns, [](double component) { return component != 0.0; })) return n;
  CountedRandom random(seed, atom->tag[i], ~std::uint64_t{0});
  const double angle = 2.0 * PI * random.uniform();
  const double height = columns == 3 ? 2.0 * random.uniform() - 1.0 : 0.0;
  const double out = std::sqrt(1.0 - height * height);
  const double first[] = {out * std::cos(angle), out * std::sin(angle), height};
  std::copy_n(first, columns, n);
  return n;
}

// For the output of each particle.
void FixDeformablePropel::grow_arrays(int size)
{
  FixMemory::grow_arrays(size);
  rows.resize(size);
  for (int i = 0; i < size; ++i) rows[i] = of(i);
  array_atom = rows.data();
}
