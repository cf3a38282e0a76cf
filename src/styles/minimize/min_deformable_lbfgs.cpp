#include "styles/minimize/min_deformable_lbfgs.h"

#ifdef DEFORMABLE_HAS_MIN

#include "kernels/large_vector.h"
#include "styles/all_ranks.h"
#include "styles/lammps_release.h"

#include "atom.h"
#include "comm.h"
#include "compute.h"
#include "error.h"
#include "fix.h"
#include "force.h"
#include "modify.h"
#include "output.h"
#include "timer.h"
#include "update.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

using namespace LAMMPS_NS;
using namespace deformable;

static constexpr int MOST_TRIALS = 12;     // of a line search
static constexpr int MOST_FAILURES = 4;    // searches in a row
static constexpr int RENEWAL = 100;        // iterations
static constexpr int LOOK = 10;            // iterations between looks at the contacts
static constexpr int RESCALING = 3;        // iterations from one gamma to the next one
static constexpr double CHANGED = 0.05;    // part of contacts
static constexpr double GAP = 0.1;         // of pairs with a spring, over both radii
// of a spring: at a gap of ten median overlaps
static constexpr double LEAST_WEIGHT = 0.0025;
static constexpr double EPSILON = 0.003;      // of P [0.001, 0.01]
static constexpr double FIRST_STEP = 0.02;    // over the longest one
// imbalance of contacts over the largest force on a particle [1e-4, 0.1]
static constexpr double LOOSE = 1e-3;

// All vectors are gone through piece by piece, each small enough for the cache.
static constexpr int PIECE = 1024;

static double product(const double *a, const double *b, int size)
{
  constexpr int LANES = 8;
  double parts[LANES] = {}, rest = 0.0;
  int n = 0;
  for (; n + LANES <= size; n += LANES)
    for (int k = 0; k < LANES; ++k) parts[k] += a[n + k] * b[n + k];
  for (; n < size; ++n) rest += a[n] * b[n];
  for (const double part : parts) rest += part;
  return rest;
}

static void add(double *__restrict__ sum, double factor, const double *__restrict__ v, int size)
{
  for (int n = 0; n < size; ++n) sum[n] += factor * v[n];
}

template <class Work> static void for_each_piece(int size, Work &&work)
{
  for (int begin = 0; begin < size; begin += PIECE) work(begin, std::min(PIECE, size - begin));
}

MinDeformableLbfgs::MinDeformableLbfgs(LAMMPS *lmp) : Min(lmp)
{
  laid_out_as_declared = dmax == 0.1 && delaystep == 20 && dtgrow == 1.1 && tmin == 0.02 &&
                         max_vdotf_negatif == 2000 && nextra_global == 0 && !fextra &&
                         nextra_atom == 0 && !requestor;
  searchflag = 1;
  dmax = std::numeric_limits<double>::quiet_NaN();    // not given
}

bool MinDeformableLbfgs::fits(LAMMPS *lmp)
{
  return MinDeformableLbfgs(lmp).laid_out_as_declared;
}

int MinDeformableLbfgs::modify_param(int narg, char **arg)
{
  const std::string word = arg[0];
  if (word != "memory" && word != "precondition") return 0;
  if (narg < 2) utils::missing_cmd_args(FLERR, "min_modify " + word, error);
  if (word == "memory") {
    const int given = utils::inumeric(FLERR, arg[1], false, lmp);
    if (given < 1 || given > 100)
      error->all(FLERR, "min_modify memory {}: the steps that L-BFGS remembers are 1 to 100",
                 arg[1]);
    memory = given;
  } else {
    const std::string value = arg[1];
    if (value == "springs")
      precondition = SPRINGS;
    else if (value == "none")
      precondition = NONE;
    else
      error->all(FLERR, "min_modify precondition '{}': it must be 'springs' or 'none'", value);
  }
  return 2;
}

void MinDeformableLbfgs::init()
{
  Min::init();
  if (dmax <= 0.0)
    error->all(FLERR, "min_modify dmax {}: the longest step of a coordinate must be positive",
               dmax);
  fix_minimize->maxexchange = 3 * (3 + 2 * memory) + 2;

  pair = dynamic_cast<PairDeformable *>(force->pair);
  preconditioned = pair && precondition != NONE;
  if (precondition == SPRINGS && !pair)
    error->all(FLERR,
               "min_modify precondition springs: only the pair styles deformable/ring, "
               "deformable/sector and deformable/droplet, without hybrid, know their contacts: use "
               "'precondition none'");
  // those that ask to be called in minimizations, but for those that measure
  others_push = false;
  for (Fix *fix : modify->get_fix_list()) {
    bool pushes = modify->get_fix_mask(fix) & FixConst::MIN_POST_FORCE;
    for (const char *style : {"^enforce2d", "^pair$", "^store/force$", "^numdiff"})
      pushes = pushes && !utils::strmatch(fix->style, style);
    others_push |= pushes;
  }
  // their forces have lost a direction that springs do not know
  for (const char *style : {"aveforce", "lineforce", "planeforce"}) {
    const auto fixes = modify->get_fix_by_style(fmt::format("^{}", style));
    if (fixes.empty() || !preconditioned) continue;
    if (precondition == SPRINGS)
      error->all(FLERR,
                 "min_modify precondition springs does not know which motions fix {} {} leaves: "
                 "use 'precondition none'",
                 fixes[0]->id, style);
    preconditioned = false;
  }
}

void MinDeformableLbfgs::setup_style()
{
  if (nextra_global)
    error->all(FLERR, "Min style deformable/lbfgs does not change the box: use 'min_style cg' with "
                      "fix box/relax");
  if (nextra_atom)
    error->all(FLERR,
               "Min style deformable/lbfgs moves atoms only, but pair style {} has further "
               "unknowns: use 'min_style cg'",
               force->pair_style);
  for (int n = 0; n < 3 + 2 * memory; ++n) fix_minimize->add_vector(3);
  fix_minimize->add_vector(2);
  s.resize(memory);
  y.resize(memory);
  sy.assign(memory * memory, 0.0);
  sf.assign(memory, 0.0);
}

// Atoms have other indices, or their arrays have moved.
void MinDeformableLbfgs::reset_vectors()
{
  nvec = 3 * atom->nlocal;
  if (nvec) xvec = atom->x[0];
  if (nvec) fvec = atom->f[0];
  x0 = fix_minimize->request_vector(0);
  f0 = fix_minimize->request_vector(1);
  q = fix_minimize->request_vector(2);
  for (int n = 0; n < memory; ++n) {
    s[n] = fix_minimize->request_vector(3 + 2 * n);
    y[n] = fix_minimize->request_vector(4 + 2 * n);
  }
  origin = fix_minimize->request_vector(3 + 2 * memory);
  moved = true;
  then.resize(atom->nlocal);
  for (int i = 0; i < atom->nlocal; ++i)
    then[i] = origin[2 * i + 1] == comm->me ? static_cast<int>(origin[2 * i]) : -1;
  solved.resize(nvec);
}

double MinDeformableLbfgs::evaluate()
{
  ecurrent = energy_force(1);
  energy = pe_compute->scalar;
  ++neval;
  return energy;
}

// Far from rest contact forces need not balance better than to a part of the forces on particles: energies are wrong by its
// square.
void MinDeformableLbfgs::balance_loosely()
{
  if (!may_be_loose) return;
  accepted = LOOSE * std::sqrt(fnorm_max());
  pair->accept_imbalance(accepted);
}

void MinDeformableLbfgs::balance_fully()
{
  if (accepted == 0.0) return;
  accepted = 0.0;
  pair->accept_imbalance(0.0);
  evaluate();
}

bool MinDeformableLbfgs::is_at_rest()
{
  if (!is_converged()) return false;
  balance_fully();
  return is_converged();
}

bool MinDeformableLbfgs::is_converged()
{
  if (!(update->ftol > 0.0)) return false;
  const double squared = normstyle == MAX   ? fnorm_max()
                         : normstyle == INF ? fnorm_inf()
                                            : fnorm_sqr();
  return squared < update->ftol * update->ftol;
}

int MinDeformableLbfgs::iterate(int maxiter)
{
  const int stop = descend(maxiter);
  balance_fully();
  return stop;
}

int MinDeformableLbfgs::descend(int maxiter)
{
  known.clear();
  outdated = true;
  energy = pe_compute->scalar;
  energy_follows = true;
  follows_again = false;
  int failures = 0;

  may_be_loose = pair != nullptr;

  if (is_at_rest()) return FTOL;
  for (int iter = 0; iter < maxiter; ++iter) {
    if (timer->check_timeout(niter)) return TIMEOUT;
    const bigint step = ++update->ntimestep;
    ++niter;
    eprevious = ecurrent;

    const int age = niter - renewed;
    if (outdated || age >= std::max(RENEWAL, interval) ||
        (age % interval == 0 && contacts_have_changed()))
      renew();
    double slope = find_direction();
    if (!(slope < 0.0) && !known.empty()) {
      known.clear();
      slope = find_direction();
    }
    if (!(slope < 0.0)) return ZEROFORCE;

    double part = 1.0;
    if (search(slope, part)) {
      failures = 0;
      alpha_final = part;
      remember(part);
      if (is_at_rest()) return FTOL;
      if (std::fabs(ecurrent - eprevious) <
          update->etol * 0.5 * (std::fabs(ecurrent) + std::fabs(eprevious) + 1e-8))
        return ETOL;
    } else {
      known.clear();
      outdated = true;
      may_be_loose = false;
      alpha_final = 0.0;
      if (++failures == MOST_FAILURES) return ZEROALPHA;
    }
    if (neval >= update->max_eval) return MAXEVAL;

    if (iter + 1 == maxiter) balance_fully();    // LAMMPS writes no further row
    if (output->next == step) {
      timer->stamp();
      output->write(step);
      timer->stamp(Timer::OUTPUT);
    }
  }
  return MAXITER;
}

/* ----------------------------------------------------------------------
   The step q of the two-loop recursion, no longer than allowed. Returns its
   slope. All sums of earlier vectors are known; those of y and P^-1 q make one
   sum over ranks.
------------------------------------------------------------------------- */

double MinDeformableLbfgs::find_direction()
{
  const int pairs = static_cast<int>(known.size());
  std::vector<double> down(pairs), up(pairs), yq(pairs + 1);
  for (int a = pairs - 1; a >= 0; --a) {
    double sq = sf[known[a]];
    for (int b = a + 1; b < pairs; ++b) sq -= down[b] * dot_sy(known[a], known[b]);
    down[a] = sq / dot_sy(known[a], known[a]);
  }
  for_each_piece(nvec, [&](int begin, int size) {
    std::copy_n(fvec + begin, size, q + begin);
    for (int a = 0; a < pairs; ++a) add(q + begin, -down[a], y[known[a]] + begin, size);
  });
  solve(q, q);
  if (pairs > 0) {
    const int newest = known.back();
    if (gamma == 0.0) {
      solve(y[newest], solved.data());
      yq[pairs] = product(y[newest], solved.data(), nvec);
    }
    for_each_piece(nvec, [&](int begin, int size) {
      for (int a = 0; a < pairs; ++a) yq[a] += product(y[known[a]] + begin, q + begin, size);
    });
    MPI_Allreduce(MPI_IN_PLACE, yq.data(), pairs + 1, MPI_DOUBLE, MPI_SUM, world);
    if (gamma == 0.0) gamma = dot_sy(newest, newest) / yq[pairs];
    for (int a = 0; a < pairs; ++a) {
      double rest = gamma * yq[a];
      for (int b = 0; b < a; ++b) rest += up[b] * dot_sy(known[b], known[a]);
      up[a] = down[a] - rest / dot_sy(known[a], known[a]);
    }
    for_each_piece(nvec, [&](int begin, int size) {
      for (int n = begin; n < begin + size; ++n) q[n] *= gamma;
      for (int a = 0; a < pairs; ++a) add(q + begin, up[a], s[known[a]] + begin, size);
    });
  }

  double here = 0.0;
  for (int n = 0; n < nvec; ++n) here = std::max(here, std::fabs(q[n]));
  const double longest = largest_of_ranks(world, here);
  if (!(longest > 0.0)) return 0.0;
  double scale = std::min(1.0, limit / longest);
  if (pairs == 0) scale = FIRST_STEP * limit / longest;
  for (int n = 0; n < nvec; ++n) q[n] *= scale;
  return -sum_of_ranks(world, product(fvec, q, nvec));
}

bool MinDeformableLbfgs::law_changes() const
{
  bool found = false;
  for (const PairDeformable *each : deformable_pairs(*force)) found |= each->law_changes();
  return found;
}

/* ----------------------------------------------------------------------
   Moves the atoms by a part of q, or leaves them where they are. Forces that
   are not derivatives of the energy, as where a fix adds some without an
   energy, are followed by their slope alone; and as long as areas give way.
------------------------------------------------------------------------- */

bool MinDeformableLbfgs::search(double slope, double &part)
{
  fix_minimize->store_box();
  std::copy_n(xvec, nvec, x0);
  std::copy_n(fvec, nvec, f0);
  const double before = energy;
  const bool changes = law_changes();
  if (follows_again && !changes) energy_follows = true;
  balance_loosely();
  const double rounding = 1e-10 * std::fabs(before);
  for (int trial = 1; trial <= MOST_TRIALS; ++trial) {
    for (int n = 0; n < nvec; ++n) xvec[n] = x0[n] + part * q[n];
    evaluate();
    const double flat = -sum_of_ranks(world, product(fvec, q, nvec)), rise = energy - before;
    if (energy_follows) {
      if (rise <= 1e-4 * part * slope) return true;
      if (std::fabs(flat) <= 0.9 * std::fabs(slope) && rise <= rounding) return true;
      if (std::fabs(flat - slope) < 0.1 * std::fabs(slope) && rise - part * slope > rounding) {
        energy_follows = false;
        follows_again = changes || law_changes();
        if (comm->me == 0 && !follows_again)
          error->warning(FLERR,
                         "Min style deformable/lbfgs: the energy rises along the forces, which are "
                         "not its derivatives, e.g. of a fix without 'fix_modify energy yes'. It "
                         "goes by forces alone from here on; else use 'min_style fire'");
        part = 1.0;
        trial = 0;
        continue;
      }
    } else if (flat <= 0.9 * std::fabs(slope)) {
      return true;
    }
    const double to_zero = part * slope / (slope - flat);
    part = std::isfinite(to_zero) ? std::clamp(to_zero, 0.1 * part, 0.6 * part) : 0.1 * part;
  }
  std::copy_n(x0, nvec, xvec);
  evaluate();
  return false;
}

/* ----------------------------------------------------------------------
   The last step, in the place of the oldest one.
------------------------------------------------------------------------- */

void MinDeformableLbfgs::remember(double part)
{
  if (static_cast<int>(known.size()) == memory) known.erase(known.begin());
  int newest = 0;    // that is not in use
  while (std::find(known.begin(), known.end(), newest) != known.end()) ++newest;
  double *const sn = s[newest], *const yn = y[newest];
  const int pairs = static_cast<int>(known.size());
  // s_a.f and s.y_a of earlier pairs; s.f, s.y, s.s and y.y
  std::vector<double> sums(2 * pairs + 4);
  for_each_piece(nvec, [&](int begin, int size) {
    for (int n = begin; n < begin + size; ++n) {
      sn[n] = part * q[n];
      yn[n] = f0[n] - fvec[n];
    }
    double *next = sums.data();
    const double *const sp = sn + begin, *const yp = yn + begin, *const fp = fvec + begin;
    for (const int a : known) *next++ += product(s[a] + begin, fp, size);
    for (const int a : known) *next++ += product(sp, y[a] + begin, size);
    *next++ += product(sp, fp, size);
    *next++ += product(sp, yp, size);
    *next++ += product(sp, sp, size);
    *next++ += product(yp, yp, size);
  });
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM,
                world);
  for (int k = 0; k < pairs; ++k) {
    const int a = known[k];
    dot_sy(a, newest) = sf[a] - sums[k];    // s_a.y, y = f0 - f
    sf[a] = sums[k];
    dot_sy(newest, a) = sums[pairs + k];
  }
  const double *const own = &sums[2 * pairs];
  sf[newest] = own[0];
  dot_sy(newest, newest) = own[1];
  if (!(own[1] > 1e-14 * std::sqrt(own[2] * own[3]))) return;
  known.push_back(newest);
  if (niter % RESCALING == 0) gamma = 0.0;
}

/* ----------------------------------------------------------------------
   P of the contacts as they are, w = (1 + o/sqrt(o^2 + 4 m^2))/2 of overlaps o
   with the median m: springs of contacts that may open, or close, are softer.
   Each rank has a P of its own particles, for which those of others stay.
   A step is not longer than three times the median overlap.
------------------------------------------------------------------------- */

void MinDeformableLbfgs::renew()
{
  outdated = moved = false;
  renewed = niter;
  interval = LOOK;
  gamma = 0.0;
  if (!pair) {
    double smallest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < atom->nlocal && atom->radius_flag; ++i)
      if (atom->radius[i] > 0.0) smallest = std::min(smallest, atom->radius[i]);
    smallest = smallest_of_ranks(world, smallest);
    if (force->pair) smallest = std::min(smallest, force->pair->cutforce);    // in any units
    limit = std::isnan(dmax) ? std::min(0.1, 0.05 * smallest) : dmax;
    return;
  }

  pair->list_springs(GAP, springs);
  std::vector<double> overlaps;
  for (const Spring &spring : springs)
    if (spring.overlap > 0.0) overlaps.push_back(spring.overlap);
  const auto middle = overlaps.begin() + overlaps.size() / 2;
  double sums[2] = {0.0, static_cast<double>(overlaps.size())};
  if (!overlaps.empty()) {
    std::nth_element(overlaps.begin(), middle, overlaps.end());
    sums[0] = sums[1] * *middle;
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, world);
  const double median = sums[1] > 0.0 ? sums[0] / sums[1] : 0.0;
  const double smallest = pair->smallest_radius();
  limit = 0.05 * smallest;
  if (median > 0.0) limit = std::min(limit, 3.0 * median);
  if (!std::isnan(dmax)) limit = dmax;
  if (!preconditioned) return;

  const int nlocal = atom->nlocal;
  std::vector<std::pair<tagint, int>> owners;    // particles of this rank, by ID
  for (int i = 0; i < nlocal && atom->tag_enable; ++i) owners.emplace_back(atom->tag[i], i);
  std::sort(owners.begin(), owners.end());
  std::vector<SpringMatrix::Element> elements;
  for (const Spring &spring : springs) {
    const double o = spring.overlap, width = std::sqrt(o * o + 4.0 * median * median);
    const double weight = width > 0.0 ? 0.5 * (1.0 + o / width) : 0.0;
    if (weight < LEAST_WEIGHT) continue;
    int j = spring.j;
    if (j >= nlocal) {
      const std::pair<tagint, int> first = {atom->tag_enable ? atom->tag[j] : 0, 0};
      const auto owner = std::lower_bound(owners.begin(), owners.end(), first);
      j = owner != owners.end() && owner->first == first.first ? owner->second : -1;
      if (j >= 0 && j <= spring.i) continue;    // an image, of which the other side is listed too
    }
    elements.push_back({spring.i, j, spring.n, weight});
  }
  for (int i = 0; i < nlocal; ++i) {
    origin[2 * i] = then[i] = i;
    origin[2 * i + 1] = comm->me;
  }
  // coordinates without a force: of particles that a fix holds, of a plane, and of rattlers
  held.resize(nvec);
  for (int n = 0; n < nvec; ++n) held[n] = fvec[n] == 0.0;
  matrix.factorize(pair->front_kernels(), domain->dimension, nlocal, xvec, held, elements, EPSILON);
  const double solves = largest_of_ranks(world, matrix.solves_per_factor());
  interval = std::max(LOOK, static_cast<int>(solves));
}

bool MinDeformableLbfgs::contacts_have_changed()
{
  if (!pair) return false;
  if (moved) return true;    // nobody knows
  const double *const *const x = atom->x;
  double counts[2] = {0.0, 0.0};
  for (const Spring &spring : springs) {
    if (spring.j < 0) continue;
    const double *const a = x[spring.i], *const b = x[spring.j];
    const Vector3 d = {b[0] - a[0], b[1] - a[1], domain->dimension == 3 ? b[2] - a[2] : 0.0};
    const bool touches = length(d) < spring.distance + spring.overlap;
    counts[0] += touches != (spring.overlap > 0.0);
    counts[1] += touches;
  }
  MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_DOUBLE, MPI_SUM, world);
  return counts[0] > CHANGED * counts[1];
}

/* ----------------------------------------------------------------------
   z = P^-1 q. Where only forces between particles act, which add up to zero,
   their center of mass stays: springs of a rank to particles of another one,
   or to rattlers, would let it drift.
------------------------------------------------------------------------- */

void MinDeformableLbfgs::solve(const double *from, double *z)
{
  if (!preconditioned) {
    if (from != z) std::copy_n(from, nvec, z);
    return;
  }
  matrix.solve(then, from, z);
  if (others_push) return;
  const auto moves = [this](int i, int axis) { return then[i] < 0 || !held[3 * then[i] + axis]; };
  double sums[6] = {};
  for (int i = 0; i < atom->nlocal; ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (moves(i, axis)) {
        sums[axis] += z[3 * i + axis];
        sums[3 + axis] += 1.0;
      }
  MPI_Allreduce(MPI_IN_PLACE, sums, 6, MPI_DOUBLE, MPI_SUM, world);
  for (int i = 0; i < atom->nlocal; ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (moves(i, axis)) z[3 * i + axis] -= sums[axis] / sums[3 + axis];
}

double MinDeformableLbfgs::memory_usage()
{
  return matrix.memory_usage() + bytes_of(springs, solved, then, held);
}

#endif
