#include "force_solver.h"

#include "comm.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using deformable::PairArrays;

/* ----------------------------------------------------------------------
   At successive steps forces start from an extrapolation in time: a quadratic
   one, or, where a loose tolerance leaves errors that it would amplify, one
   that is stable if each step corrects it (J. Kolafa, J. Comput. Chem. 25,
   335 (2004)). The forces of the new call take the first place among the past
   ones.
------------------------------------------------------------------------- */

void ForceSolver::begin_call(NearPairs &p)
{
  static constexpr double COEFFICIENTS[][3] = {{1, 0, 0}, {1, 0, 0}, {2, -1, 0}, {3, -3, 1}};
  static constexpr double STABLE[3] = {2.5, -2, 0.5};
  consecutive_calls = update->ntimestep == last_step + 1 ? std::min(consecutive_calls + 1, 3) : 0;
  last_step = update->ntimestep;
  const bool predicts = consecutive_calls == 3;
  must_correct = predicts && tolerance > LOOSE;
  const double *const c = must_correct ? STABLE : COEFFICIENTS[consecutive_calls];
  for (int k = 0; k < p.size; ++k) {
    const double now = p.past[0][k], last = p.past[1][k], before = p.past[2][k];
    p.past[2][k] = last;
    p.past[1][k] = now;
    p.past[0][k] = now == PastForces::UNKNOWN ? now : c[0] * now + c[1] * last + c[2] * before;
  }
  evaluations = 0;
  first_solution = true;
}

/* ---------------------------------------------------------------------- */

bool ForceSolver::solve(NearPairs &p, ForceBatches &b, RemoteSides &r)
{
  pairs = &p;
  batches = &b;
  remote = &r;
  const std::size_t one_more = p.size + 1;    // nothing happens in the last one, which stays zero
  for (std::vector<double> *v :
       {&residual, &error, &weight, &begin, &step, &left, &direction, &product})
    if (v->size() != one_more) v->assign(one_more, 0.0);
  if (comm->nprocs > 1) agree();
  for (int k = 0; k < p.size; ++k) p.force[k] = std::max(p.past[0][k], 0.0);

  if (!first_solution) --evaluations;    // of the same forces as the last one
  Evaluation now = evaluate(true);
  if (!now.exists) {
    std::fill(p.force.begin(), p.force.end(), 0.0);
    now = evaluate(false);
  }
  // A minimizer needs only a tenth of the imbalance that its last step caused: the rest vanishes as its steps do, if each
  // call corrects it, also below the tolerance.
  constexpr double TENTH = 0.1;
  const bool minimizing = update->whichflag == 2;
  if (first_solution)
    target = minimizing ? std::max(tolerance, TENTH * std::min(now.relative(), 1.0)) : tolerance;
  must_correct |= first_solution && minimizing;
  pairs_of_all = 1.0 + sum_over_pairs([](int a, int z) { return z - a; });
  first_solution = false;
  while ((now.worst > target * now.largest || (must_correct && now.worst > 0.0)) &&
         evaluations < max_evaluations) {
    newton_step(now);
    must_correct = false;
    double slope = take_step(true);
    if (!(slope > 0.0)) slope = take_step(false);
    now = line_search(now, slope);
  }
  remember();
  imbalance = now.relative();
  return now.worst <= target * now.largest;
}

/* ---------------------------------------------------------------------- */

PairArrays ForceSolver::arrays()
{
  NearPairs &p = *pairs;
  const ForceBatches &b = *batches;
  return {p.overlap.data(),     p.stiffening.data(), p.side[0].data(), p.side[1].data(),
          b.indentation.data(), b.compliance.data(), b.product.data(), p.force.data(),
          residual.data(),      error.data(),        weight.data(),    step.data(),
          left.data(),          direction.data(),    product.data()};
}

/* ----------------------------------------------------------------------
   Both ranks of a pair take the mean of their overlaps, which differ by the
   rounding of ghosts' positions, and of their first forces. Otherwise the
   residuals of both would never vanish together, and the difference of their
   forces would grow from call to call: no residual depends on it.
------------------------------------------------------------------------- */

void ForceSolver::agree()
{
  NearPairs &p = *pairs;
  const int own = batches->contacts, *const side = p.side[0].data() + p.remote;
  double *const overlap = p.overlap.data() + p.remote, *const force = p.past[0].data() + p.remote;
  // evaluate replaces them
  double *const overlaps = batches->indentation.data(), *const forces = batches->compliance.data();
  const int count = p.wall - p.remote;
  for (int c = 0; c < count; ++c) {
    overlaps[side[c]] = overlap[c];
    forces[side[c]] = force[c];
  }
  remote->exchange(side, own, overlaps, forces);
  for (int c = 0; c < count; ++c) {
    overlap[c] = 0.5 * (overlap[c] + overlaps[own + c]);
    force[c] = 0.5 * (force[c] + forces[own + c]);
  }
}

// Pairs that two ranks share count half on each.
template <class Sum> double ForceSolver::sum_over_pairs(Sum &&sum) const
{
  double part =
      sum(0, pairs->remote) + 0.5 * sum(pairs->remote, pairs->wall) + sum(pairs->wall, pairs->size);
  if (comm->nprocs == 1) return part;
  double all;
  MPI_Allreduce(&part, &all, 1, MPI_DOUBLE, MPI_SUM, world);
  return all;
}

ForceSolver::Evaluation ForceSolver::evaluate(bool new_directions)
{
  ++evaluations;
  const NearPairs &p = *pairs;
  const bool exist =
      kernels.shape(batches->arrays(), {p.force.data(), p.angle.data(), p.nx.data(), p.ny.data()},
                    new_directions);
  remote->exchange(pairs->side[0].data() + pairs->remote, batches->contacts,
                   batches->indentation.data(), batches->compliance.data());
  const deformable::Largest here = kernels.find_residuals(arrays(), 0, pairs->size);
  double largest[3] = {here.error, here.force, exist ? 0.0 : 1.0};
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, largest, 3, MPI_DOUBLE, MPI_MAX, world);
  return {largest[0], largest[1], largest[2] == 0.0};
}

/* ----------------------------------------------------------------------
   Solves C x = r on the pairs that take part. Newton's method squares its
   relative error in each step: the solution need not be better than that,
   nor than the tolerance. The first step finds which contacts open or close,
   and may be coarse.
------------------------------------------------------------------------- */

void ForceSolver::newton_step(const Evaluation &from)
{
  constexpr int MAX_ITERATIONS = 500;
  constexpr double LEAST_ACCURACY = 0.03, MARGIN = 0.3, SQUARE = 10.0;
  const PairArrays loop = arrays();
  double norm2 = sum_over_pairs([&](int a, int z) { return kernels.begin_gradients(loop, a, z); });
  const double weights =
      sum_over_pairs([&](int a, int z) { return kernels.sum(loop.weight, a, z); });
  if (!(norm2 > 0.0)) return;
  // of r, times the mean weight
  const double typical = std::sqrt(norm2 * weights) / pairs_of_all;
  const double sufficient =
      std::max(MARGIN * target * from.largest / from.worst, SQUARE * typical / from.largest);
  const double accuracy = evaluations == 1 ? LEAST_ACCURACY : std::min(LEAST_ACCURACY, sufficient);
  const double enough = accuracy * accuracy * norm2;
  for (int iteration = 0; iteration < MAX_ITERATIONS && norm2 > enough; ++iteration) {
    kernels.multiply(batches->arrays(), direction.data());
    remote->exchange(pairs->side[0].data() + pairs->remote, batches->contacts,
                     batches->product.data());
    const double curvature =
        sum_over_pairs([&](int a, int z) { return kernels.add_products(loop, a, z); });
    if (!(curvature > 0.0)) break;
    const double length = norm2 / curvature;
    const double next =
        sum_over_pairs([&](int a, int z) { return kernels.advance(loop, length, a, z); });
    kernels.turn(loop, next / norm2, 0, pairs->size);
    norm2 = next;
  }
}

/* ----------------------------------------------------------------------
   Turns the change of forces into one that leaves no force negative, and
   takes it. Without Newton's method each pair changes for itself. Returns the
   slope of the dual energy along the step.
------------------------------------------------------------------------- */

double ForceSolver::take_step(bool newton)
{
  constexpr double ALONE = 0.5;
  const double *const stiffening = pairs->stiffening.data();
  double *const force = pairs->force.data();
  if (!newton) std::copy(begin.begin(), begin.end(), pairs->force.begin());
  for (int k = 0; k < pairs->size; ++k) {
    const double f = force[k], r = residual[k];
    double next = f + (!newton ? ALONE * error[k] : weight[k] > 0.0 ? step[k] : error[k]);
    if (r > 0.0) next = std::max(next, stiffening[k] * r * r * r);
    next = std::max(next, 0.0);
    begin[k] = f;
    step[k] = next - f;
    force[k] = next;
  }
  return sum_over_pairs(
      [this](int a, int z) { return kernels.dot(residual.data(), step.data(), a, z); });
}

/* ----------------------------------------------------------------------
   The dual energy is concave along the step. A step that is much too long
   has a negative slope at its end, and the search looks for the place where
   the slope vanishes.
------------------------------------------------------------------------- */

ForceSolver::Evaluation ForceSolver::line_search(const Evaluation &from, double slope)
{
  constexpr double BETTER = 0.5, SMALL_SLOPE = 0.5;
  double low = 0.0, low_slope = slope, high = 1.0, at = 1.0;
  for (;;) {
    const Evaluation now = evaluate(false);
    const double good = std::max(BETTER * from.worst, target * now.largest);
    if (now.exists && now.worst <= good) return now;
    double here = -std::numeric_limits<double>::infinity();
    if (now.exists)
      here = sum_over_pairs(
          [this](int a, int z) { return kernels.dot(residual.data(), step.data(), a, z); });
    if (here >= -SMALL_SLOPE * slope && (at == 1.0 || here <= SMALL_SLOPE * slope)) return now;
    if (evaluations >= max_evaluations) return now;

    double next;
    if (here > 0.0) {
      low = at;
      low_slope = here;
      next = 0.5 * (low + high);
    } else {
      high = at;
      next = low + (high - low) * (std::isinf(here) ? 0.25 : low_slope / (low_slope - here));
    }
    next = std::clamp(next, low + 0.1 * (high - low), high - 0.1 * (high - low));
    if (!(next > low && next < high) || high - low < 1e-10) return now;
    at = next;
    for (int k = 0; k < pairs->size; ++k) pairs->force[k] = std::max(begin[k] + at * step[k], 0.0);
  }
}

/* ---------------------------------------------------------------------- */

void ForceSolver::remember()
{
  for (int k = 0; k < pairs->size; ++k) {
    const double f = pairs->force[k] > 0.0 ? pairs->force[k] : std::min(error[k], 0.0);
    const bool is_new = pairs->past[0][k] == PastForces::UNKNOWN;
    pairs->past[0][k] = f;
    if (is_new || pairs->past[1][k] == PastForces::UNKNOWN) pairs->past[1][k] = f;
    if (is_new || pairs->past[2][k] == PastForces::UNKNOWN) pairs->past[2][k] = f;
  }
}

double ForceSolver::memory_usage() const
{
  return bytes_of(residual, error, weight, begin, step, left, direction, product);
}
