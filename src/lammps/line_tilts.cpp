#include "line_tilts.h"

#include "tilt.h"

#include <algorithm>

using namespace LAMMPS_NS;
using deformable::LARGEST_SINE;

static constexpr double UPRIGHT = 2.0;    // in place of a past sine

void LineTilts::predict(NearPairs &p, const double *c)
{
  for (int k = 0; k < p.size; ++k) {
    const double now = p.past_tilt[0][k], last = p.past_tilt[1][k], before = p.past_tilt[2][k];
    p.past_tilt[2][k] = last;
    p.past_tilt[1][k] = now;
    if (now == PastForces::UNKNOWN || now == UPRIGHT) continue;
    p.past_tilt[0][k] =
        std::clamp(c[0] * now + c[1] * last + c[2] * before, -LARGEST_SINE, LARGEST_SINE);
  }
}

void LineTilts::start(NearPairs &p, ForceBatches &b, const deformable::ForceKernels &kernels)
{
  next.assign(p.size, 0.0);
  turns.assign(p.size, 1.0);
  rate.assign(b.indentation.size(), 0.0);
  for (int k = 0; k < p.wall; ++k) {
    const double sine = p.past_tilt[0][k];
    if (sine == UPRIGHT)
      turns[k] = 0.0;
    else if (sine != PastForces::UNKNOWN)
      next[k] = sine;
  }
  turn(p, b, kernels);
}

deformable::LineArrays LineTilts::arrays(NearPairs &p, ForceBatches &b)
{
  return {
      p.touching.data(), p.per_distance.data(), p.force.data(), p.side[0].data(), p.side[1].data(),
      b.product.data(),  rate.data(),           p.tilt.data(),  next.data(),      turns.data(),
      p.overlap.data(),  p.angle.data(),        p.nx.data(),    p.ny.data()};
}

double LineTilts::find(NearPairs &p, ForceBatches &b, const deformable::ForceKernels &kernels)
{
  return kernels.find_tilts(arrays(p, b), 0, p.wall);
}

void LineTilts::turn(NearPairs &p, ForceBatches &b, const deformable::ForceKernels &kernels)
{
  kernels.turn_lines(arrays(p, b), 0, p.wall);
}

void LineTilts::keep_upright(NearPairs &p, int k)
{
  for (std::vector<double> &past : p.past_tilt) past[k] = UPRIGHT;
}

void LineTilts::remember(NearPairs &p) const
{
  for (int k = 0; k < p.wall; ++k) {
    const double sine = is_upright(k) ? UPRIGHT : next[k];
    const auto is_other = [sine](double past) {
      return past == PastForces::UNKNOWN || (past == UPRIGHT) != (sine == UPRIGHT);
    };
    const bool is_new = is_other(p.past_tilt[0][k]);
    for (int n = 1; n < 3; ++n)
      if (is_new || is_other(p.past_tilt[n][k])) p.past_tilt[n][k] = sine;
    p.past_tilt[0][k] = sine;
  }
}
