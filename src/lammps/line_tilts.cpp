#include "line_tilts.h"

#include "tilt.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;

static constexpr double LARGEST = 0.29552020666133957;    // sine of 0.3
static constexpr double UPRIGHT = 2.0;                    // in place of a past sine

void LineTilts::predict(NearPairs &p, const double *c)
{
  for (int k = 0; k < p.size; ++k) {
    const double now = p.past_tilt[0][k], last = p.past_tilt[1][k], before = p.past_tilt[2][k];
    p.past_tilt[2][k] = last;
    p.past_tilt[1][k] = now;
    if (now == PastForces::UNKNOWN || now == UPRIGHT) continue;
    p.past_tilt[0][k] = std::clamp(c[0] * now + c[1] * last + c[2] * before, -LARGEST, LARGEST);
  }
}

void LineTilts::start(NearPairs &p)
{
  next.assign(p.size, 0.0);
  upright.assign(p.size, 0);
  for (int k = 0; k < p.wall; ++k) {
    const double sine = p.past_tilt[0][k];
    upright[k] = sine == UPRIGHT;
    if (sine != UPRIGHT && sine != PastForces::UNKNOWN) next[k] = sine;
  }
  turn(p);
}

// Rings at rest: the sum of L n vanishes.
void LineTilts::find_rates(const ForceBatches &b, const NearPairs &p)
{
  using deformable::LANES;
  rate.resize(b.indentation.size());
  for (int batch = 0; batch < b.batches; ++batch)
    for (int m = 0; m < b.size[batch]; ++m)
      for (int w = 0; w < LANES; ++w) {
        const int ring = batch * LANES + w, c = b.first[batch] + m * LANES + w;
        const double per_pressure = b.per_pressure[ring];
        rate[c] = deformable::slope_rate(b.total[ring] * per_pressure, 0.0,
                                         b.indentation[c] + b.expansion[ring],
                                         p.force[b.seat[c] >> 1] * per_pressure);
      }
}

double LineTilts::find_torques(NearPairs &p, const std::vector<double> &slope)
{
  constexpr double STABLE = 0.3;    // the least part of the stiffness that is left by the outlines
  double worst = 0.0;
  for (int k = 0; k < p.wall; ++k) {
    const int first = p.side[0][k], second = p.side[1][k];
    const double force = p.force[k], sine = p.tilt[k], per_d = p.per_distance[k];
    const double cosine = std::sqrt(1.0 - sine * sine);
    const double off = (slope[first] + slope[second]) * per_d - sine;
    const double stiffness = 1.0 - (rate[first] + rate[second]) * per_d / cosine;
    const double better = sine + off / std::max(stiffness, STABLE);
    next[k] = std::clamp(better, -LARGEST, LARGEST);
    if (!(force > 0.0)) {
      upright[k] = 0;
      continue;
    }
    if (std::fabs(better) > LARGEST && std::fabs(sine) == LARGEST) upright[k] = 1;
    if (upright[k]) next[k] = 0.0;
    worst = std::max(worst, force * std::fabs(upright[k] ? sine : off));
  }
  return worst;
}

void LineTilts::keep_upright(NearPairs &p, int k)
{
  for (std::vector<double> &past : p.past_tilt) past[k] = UPRIGHT;
}

void LineTilts::remember(NearPairs &p) const
{
  for (int k = 0; k < p.wall; ++k) {
    const double sine = upright[k] ? UPRIGHT : next[k];
    const auto is_other = [sine](double past) {
      return past == PastForces::UNKNOWN || (past == UPRIGHT) != (sine == UPRIGHT);
    };
    const bool is_new = is_other(p.past_tilt[0][k]);
    for (int n = 1; n < 3; ++n)
      if (is_new || is_other(p.past_tilt[n][k])) p.past_tilt[n][k] = sine;
    p.past_tilt[0][k] = sine;
  }
}
