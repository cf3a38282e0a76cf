// Steps of pairs for themselves: what a force does to its own indentation is not linear.

#include "solver/droplet_solver.h"

#include "laws/droplet.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

// A force may more than double by this f at most: far beyond the model steps are too long.
double DropletSolver::most_force(int k, double before) const
{
  constexpr double MOST = 0.5;
  return 2.0 * before + MOST / unit[k];
}

// Of the indentation F (l - 5/6) that a force alone makes: its derivative, not below 1.
static double own_slope(double f)
{
  return std::max(deformable::LOG_8_PI - std::log(f) - 11.0 / 6.0, 1.0);
}

// The force F with  r = s F (l - 5/6 + L),  l = ln(8 pi/f): of a contact that opens, at these loads. By Newton's method.
double DropletSolver::alone(int k, double residual, double logarithm) const
{
  if (!(residual > 0.0)) return 0.0;
  const double scaled = residual / softness[k];
  double found = 0.2 * scaled;
  for (int n = 0; n < 4; ++n) {
    const double l = deformable::LOG_8_PI - std::log(found * unit[k]) + logarithm;
    found = l > 3.0 ? (scaled - found) / (l - 11.0 / 6.0) : scaled / std::max(l - 5.0 / 6.0, 1.0);
  }
  return found;
}

// L of a pair that bears no force, from own_compliance at NO_FORCE.
double DropletSolver::load_logarithm(int k) const
{
  constexpr double REST = deformable::LOG_8_PI - deformable::LOG_NO_FORCE - 11.0 / 6.0;
  return (compliance[sides[0][k]] + compliance[sides[1][k]]) / softness[k] - REST;
}

// Of one pair, whose compliance C at the force f falls as c log f does: to the force f' with
//   C (f' - f) + s [f' - f - f' ln(f'/f)] = C step
// That is exact for a pair alone, also where its force is small and its step is not.
static double bent_step(double f, double step, double soft)
{
  constexpr double STRAIGHT = 0.01;
  const double q = step / f;
  if (std::fabs(q) < STRAIGHT)
    return f + step * (1.0 + soft * q * (0.5 + q * (0.5 * soft - 1.0 / 6.0)));
  if (q <= -1.0 - soft) return 0.0;
  double ratio = std::max(1.0 + q, 0.05);
  for (int n = 0; n < 6; ++n) {
    const double l = std::log(ratio), slope = std::max(1.0 - soft * l, 0.1);
    ratio = std::max(ratio - ((1.0 + soft) * (ratio - 1.0) - soft * ratio * l - q) / slope,
                     0.01 * ratio);
  }
  return f * ratio;
}

// To this force, with the compliance there. Only the sum of both sides counts: each has a half.
void DropletSolver::move_alone(int k, double next, double own_compliance)
{
  DropletPairs &p = *pairs;
  moved[k] += static_cast<float>(next - p.force[k]);
  p.force[k] = next;
  weight[k] = next > 0.0 ? static_cast<float>(1.0 / own_compliance) : 0.0f;
  const float of_each = static_cast<float>(k < p.wall ? 0.5 * own_compliance : own_compliance);
  compliance[sides[0][k]] = of_each;
  if (k < p.remote) compliance[sides[1][k]] = of_each;
}

void DropletSolver::open_alone(int k, double residual)
{
  const double next = std::min(alone(k, residual, load_logarithm(k)), most_force(k, 0.0));
  if (next > 0.0) move_alone(k, next, softness[k] * own_slope(next * unit[k]));
}

// Pairs that open, close or change by much of their force take a step alone, and what is left then. The correction starts from
// there, with their compliance there.
void DropletSolver::switch_pairs()
{
  const DropletPairs &p = *pairs;
  for (int k = 0; k < p.size; ++k) {
    const double f = p.force[k], r = residuals[k], own = weight[k] * r;
    if (f == 0.0) {
      open_alone(k, r);
    } else if (weight[k] == 0.0f) {
      move_alone(k, 0.0, 0.0);
    } else if (is_bent(f, own)) {
      const double soft = softness[k], stiff = weight[k],
                   next = std::min(bent_step(f, own, soft * stiff), most_force(k, f)),
                   bend = next > 0.0 ? std::log(next / f) : 0.0;
      move_alone(k, next, soft * std::max(1.0 / (soft * stiff) - bend, 1.0));
    }
  }
  multiply(moved);
  for (int k = 0; k < p.size; ++k) {
    const bool alone = moved[k] != 0.0f && weight[k] > 0.0f;
    left[k] = (alone ? moved[k] / weight[k] : left[k]) - product_of(k);
  }
}

// The force to which its step leads.
double DropletSolver::force_after(int k) const
{
  const double f = pairs->force[k];
  const double next = weight[k] > 0.0f ? bent_step(f, step[k], softness[k] * weight[k])
                                       : std::max(f + step[k], 0.0);
  return std::min(next, most_force(k, f - moved[k]));
}

// What the bends of steps take from other pairs; that of a pair itself makes its own indentation what it should be. Pairs that
// bear nothing open where the others leave them an overlap.
void DropletSolver::bend_steps()
{
  const DropletPairs &p = *pairs;
  for (int k = 0; k < p.size; ++k) {
    direction[k] = 0.0f;
    if (weight[k] > 0.0f) {
      direction[k] = static_cast<float>(force_after(k) - p.force[k] - step[k]);
    } else if (moved[k] == 0.0f && left[k] > 0.0f) {
      open_alone(k, left[k]);
      direction[k] = static_cast<float>(p.force[k]);
      left[k] = 0.0f;
    }
  }
  multiply(direction);
  for (int k = 0; k < p.size; ++k)
    left[k] -= product_of(k) - (weight[k] > 0.0f ? direction[k] / weight[k] : 0.0f);
}

void DropletSolver::take_steps()
{
  DropletPairs &p = *pairs;
  for (int k = 0; k < p.size; ++k) {
    const double before = p.force[k] - moved[k];
    p.force[k] = force_after(k);
    step[k] = static_cast<float>(p.force[k] - before);
  }
}

// A step that is uphill on the dual energy, where those of Newton's method may not be: each pair for itself, by half.
void DropletSolver::relax()
{
  const DropletPairs &p = *pairs;
  for (int k = 0; k < p.size; ++k) {
    const double f = p.force[k], r = residuals[k];
    const double own = weight[k] > 0.0f ? weight[k] * r
                       : f > 0.0        ? -f
                                        : alone(k, r, load_logarithm(k));
    step[k] = static_cast<float>(0.5 * own);
    moved[k] = 0.0f;
  }
}
