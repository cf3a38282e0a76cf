#include "solver/droplet_solver.h"

#include "laws/droplet.h"

#include "comm.h"
#include "update.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

void DropletSolver::sum(double *values, int count, MPI_Op operation) const
{
  if (comm->nprocs > 1) MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, operation, world);
}

/* ---------------------------------------------------------------------- */

void DropletSolver::begin_call()
{
  predictor.begin_call(update->ntimestep);
  const deformable::Extrapolation by = predictor.next(update->whichflag == 2, 0.0);
  take_past();
  if (by.slope == 0.0) return;
  DropletPairs &p = *pairs;
  for (int k = 0; k < p.size; ++k) {
    if (p.past[k] == deformable::UNKNOWN_FORCE) continue;
    const double last = p.earlier[0][k], second = p.earlier[1][k], bend = last - second,
                 twist = bend - (second - p.earlier[2][k]);
    const double change = by.slope * last + by.bend * bend + by.twist * twist;
    p.force[k] = std::max(p.past[k] - change, 0.0);
  }
}

void DropletSolver::take_past()
{
  DropletPairs &p = *pairs;
  for (int k = 0; k < p.size; ++k)
    p.force[k] = p.past[k] == deformable::UNKNOWN_FORCE ? alone(k, p.overlap[k], 0.0)
                                                        : std::max(p.past[k], 0.0);
}

// A pair that bears no force is remembered with a negative one, in proportion to its residual. So its past has hardly any
// kink where it opens or closes, and predictions see both coming.
void DropletSolver::remember()
{
  constexpr double SLOPE = 10.0;    // own_slope() at f = 2e-4
  DropletPairs &p = *pairs;
  for (int k = 0; k < p.size; ++k) {
    p.earlier[2][k] = p.earlier[1][k];
    p.earlier[1][k] = p.earlier[0][k];
    const double now = p.force[k] > 0.0 ? p.force[k] : residuals[k] / (SLOPE * softness[k]);
    p.earlier[0][k] = p.past[k] == deformable::UNKNOWN_FORCE ? 0.0 : p.past[k] - now;
    p.past[k] = now;
  }
}

// Both ranks of a pair begin with the same force. Else predictions would make rounding errors grow, which residuals do not show.
void DropletSolver::agree()
{
  DropletPairs &p = *pairs;
  const int *const side = sides[0].data() + p.remote, places = first[batches] * deformable::LANES;
  for (int k = p.remote; k < p.wall; ++k) indentations[side[k - p.remote]] = p.force[k];
  remote->exchange(side, places, indentations.data());
  for (int k = p.remote; k < p.wall; ++k)
    p.force[k] = 0.5 * (p.force[k] + indentations[places + k - p.remote]);
}

/* ---------------------------------------------------------------------- */

bool DropletSolver::solve()
{
  if (comm->nprocs > 1) agree();
  const bool minimizing = update->whichflag == 2;
  // beyond the model there may be no solution: so many steps that do not halve the imbalance are enough
  constexpr int STUCK = 50;
  // and after so many, Newton's method may go around in circles
  constexpr int CIRCLE = 6;
  int since = 0;
  State now = evaluate();
  double halved = now.imbalance;
  for (steps = 0; steps < most_steps && std::isfinite(now.imbalance); ++steps) {
    // The forces of a minimizer vanish. Those of contacts go on with them below the tolerance if each call corrects them.
    if (now.balanced(minimizing && steps == 0 ? 0.0 : tolerance)) {
      if (rounding <= precision() * now.force) break;
      now = evaluate();
      continue;
    }
    if (steps < since + CIRCLE)
      correct(now);
    else
      relax();
    const double along = slope();
    take_steps();
    now = search(after_step(now), now, along);
    if (now.imbalance < 0.5 * halved) {
      halved = now.imbalance;
      since = steps;
    } else if (steps > since + STUCK) {
      break;
    }
  }
  last = now;
  imbalance = now.force > 0.0 ? now.imbalance / now.force : 0.0;
  return now.balanced(tolerance);
}

DropletSolver::State DropletSolver::evaluate()
{
  kernels.evaluate(arrays(), pairs->forces(), 0, batches);
  rounding = 0.0;
  return look();
}

// How much rounding of forces may pass, over the largest one. Energies change with rounding in first order, with an imbalance in
// second order only, and line searches of minimizers fail where an energy is off by 1e-12.
double DropletSolver::precision() const
{
  constexpr double OF_TOLERANCE = 0.1, OF_ENERGIES = 1e-13;
  const double usual = OF_TOLERANCE * tolerance;
  return update->whichflag == 2 ? std::min(usual, OF_ENERGIES) : usual;
}

// A step of single precision is as good as one of double precision where it is small.
DropletSolver::State DropletSolver::after_step(const State &before)
{
  constexpr double PRECISION = 3e-8;
  float largest = 0.0f;
  for (int k = 0; k < pairs->size; ++k) largest = std::max(largest, std::fabs(step[k]));
  double of_all = largest;
  sum(&of_all, 1, MPI_MAX);
  rounding += PRECISION * of_all;
  if (!(rounding <= precision() * before.force)) return evaluate();
  kernels.adapt(arrays(), pairs->forces(), step.data(), 0, batches);
  return look();
}

// Residuals, and which pairs take part in a step. One closes where its own indentation, F (C + s), is less than what is
// missing.
DropletSolver::State DropletSolver::look()
{
  DropletPairs &p = *pairs;
  remote->exchange(sides[0].data() + p.remote, first[batches] * deformable::LANES,
                   indentations.data(), compliance.data());
  const int *const side[] = {sides[0].data(), sides[1].data()};
  const double *const a = indentations.data(), *const f = p.force.data(),
                      *const overlap = p.overlap.data();
  const float *const c = compliance.data(), *const soft = softness.data();
  double *const left_over = residuals.data(), largest[3] = {0.0, 0.0, 0.0};
  float *const w = weight.data();
  for (int k = 0; k < p.size; ++k) {
    const int one = side[0][k], other = side[1][k];
    const double r = overlap[k] - (a[one] + a[other]);
    // the compliance of a force alone is of no use beyond f = 2, far beyond the model
    const float stiff = 1.0f / std::max(c[one] + c[other], 0.5f * soft[k]);
    const double error = r * stiff;
    left_over[k] = r;
    largest[1] = std::max(largest[1], f[k]);
    if (f[k] > 0.0 && -error < f[k] * (1.0f + soft[k] * stiff)) {
      w[k] = stiff;
      largest[0] = std::max(largest[0], std::fabs(error));
      if (is_bent(f[k], error)) largest[2] = 1.0;
    } else {
      w[k] = 0.0f;
      if (!(r <= 0.0) || f[k] > 0.0) {
        largest[0] = std::max(largest[0], f[k] > 0.0 ? f[k] : alone(k, r, load_logarithm(k)));
        largest[2] = 1.0;
      }
    }
    if (!(std::fabs(r) < HUGE_VAL)) largest[0] = HUGE_VAL;
  }
  sum(largest, 3, MPI_MAX);
  return {largest[0], largest[1], largest[2] > 0.0};
}

// By C: product_of() a pair is what the step takes from its residual.
void DropletSolver::multiply(const LargeVector<float> &of)
{
  kernels.multiply(arrays(), of.data(), product.data(), 0, batches);
  remote->exchange(sides[0].data() + pairs->remote, first[batches] * deformable::LANES,
                   product.data());
}

// A step of Newton's method: C step = r. Errors are imbalances over the largest force, and that after a step is about the square
// of that before. A step is long where this is not enough, and bends if it is not too far.
void DropletSolver::correct(const State &from)
{
  // the next error over the square of this one, less for steps that bend; and what single precision knows
  constexpr double STRAIGHT = 0.3, BENT = 0.01, SINGLE = 1e-5, BEFORE_BENDING = 0.01;
  // of farther steps bends are mere guesses, which beyond the model lead in circles
  constexpr double FAR = 0.1;
  const double error = from.imbalance / from.force;
  const bool is_long = error * error > tolerance && error < FAR;
  const double accuracy =
      std::max({0.1 * tolerance / error, (is_long ? BENT : STRAIGHT) * error, SINGLE});
  for (int k = 0; k < pairs->size; ++k) {
    left[k] = static_cast<float>(residuals[k]);
    step[k] = 0.0f;
    moved[k] = 0.0f;
  }
  if (from.switches) switch_pairs();
  if (!is_long) {
    conjugate_gradients(accuracy);
    return;
  }
  const double start = conjugate_gradients(BEFORE_BENDING);
  if (start == 0.0) return;
  bend_steps();
  conjugate_gradients(accuracy, start);
}

/* ----------------------------------------------------------------------
   Adds to the step until the norm of what is left is this part of that at the
   start, which is returned: squared, as all norms here. 0: the start is now.
   Returns 0 beyond the model, where a direction has no curvature.
------------------------------------------------------------------------- */

double DropletSolver::conjugate_gradients(double accuracy, double start)
{
  constexpr int MOST = 100;
  const DropletPairs &p = *pairs;
  for (int k = 0; k < p.size; ++k) direction[k] = weight[k] * left[k];
  for (int n = 0; n < MOST; ++n) {
    multiply(direction);
    // ranks wait for each other once: the next norm follows from these sums, with the rounding of one iteration only
    double sums[4] = {0.0, 0.0, 0.0, 0.0};
    for (int k = 0; k < p.size; ++k) {
      const float c = product_of(k), weighted = weight[k] * c;
      change[k] = c;
      const double part = p.part(k);
      sums[0] += part * (direction[k] * c);
      sums[1] += part * (weight[k] * left[k] * left[k]);
      sums[2] += part * (left[k] * weighted);
      sums[3] += part * (c * weighted);
    }
    sum(sums, 4, MPI_SUM);
    const auto [curvature, norm, turned, square] = sums;
    if (norm <= accuracy * accuracy * start) break;    // the rest is rounding
    if (!(curvature > 0.0)) {    // not along this direction, if there is another step
      for (int k = 0; k < p.size && n == 0 && start == 0.0; ++k) step[k] += direction[k];
      return 0.0;
    }
    if (start == 0.0) start = norm;
    const double length = norm / curvature, next = norm - length * (2.0 * turned - length * square);
    const float by = static_cast<float>(length), conjugate = static_cast<float>(next / norm);
    for (int k = 0; k < p.size; ++k) {
      step[k] += by * direction[k];
      left[k] -= by * change[k];
      direction[k] = weight[k] * left[k] + conjugate * direction[k];
    }
    if (next <= accuracy * accuracy * start) break;
  }
  return start;
}

// The change of the dual energy along the step, to first order.
double DropletSolver::slope() const
{
  double all = 0.0;
  for (int k = 0; k < pairs->size; ++k) all += pairs->part(k) * (residuals[k] * step[k]);
  sum(&all, 1, MPI_SUM);
  return all;
}

// The dual energy is concave along the step: where its slope is much smaller than zero at the end, the step was too long.
DropletSolver::State DropletSolver::search(State now, const State &before, double along)
{
  constexpr double OVERSHOT = -0.5;
  constexpr int MOST = 10;
  for (int n = 0; n < MOST; ++n) {
    if (now.imbalance <= before.imbalance || slope() >= OVERSHOT * along) break;
    DropletPairs &p = *pairs;
    for (int k = 0; k < p.size; ++k) {
      step[k] *= -0.5f;
      p.force[k] = std::max(p.force[k] + step[k], 0.0);
    }
    now = after_step(now);
    for (int k = 0; k < p.size; ++k) step[k] = -step[k];
    along *= 0.5;
  }
  return now;
}
