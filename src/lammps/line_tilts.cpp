#include "line_tilts.h"

#include "tilt.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using deformable::LARGEST_SINE;

static constexpr double UPRIGHT = 2.0;    // in place of a past sine

void LineTilts::predict(NearPairs &p, const deformable::ForceKernels &kernels, const double *c)
{
  deformable::PairArrays pasts = {};
  for (int n = 0; n < 3; ++n) pasts.past[n] = p.past_tilt[n].data();
  kernels.extrapolate(pasts, c, 0, p.size);    // leaves UPRIGHT
  std::swap(p.past_tilt[1], p.past_tilt[2]);
  std::swap(p.past_tilt[0], p.past_tilt[1]);
}

void LineTilts::start(NearPairs &p, ForceBatches &b, const deformable::ForceKernels &kernels)
{
  next.resize(p.size);
  turns.resize(p.size);
  rate.resize(b.indentation.size());
  for (int k = 0; k < p.size; ++k) {
    const double sine = p.past_tilt[0][k];
    const bool is_known = sine != UPRIGHT && sine != deformable::UNKNOWN_FORCE;
    turns[k] = sine == UPRIGHT ? 0.0 : 1.0;
    next[k] = is_known ? std::clamp(sine, -LARGEST_SINE, LARGEST_SINE) : 0.0;
  }
  turn(p, b, kernels);
}

deformable::LineArrays LineTilts::arrays(NearPairs &p, ForceBatches &b)
{
  return {
      p.per_distance.data(), p.force.data(), p.side[0].data(), p.side[1].data(), b.slope.data(),
      rate.data(),           p.tilt.data(),  next.data(),      turns.data(),     p.overlap.data(),
      p.angle.data(),        p.nx.data(),    p.ny.data()};
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

// A line that has begun or ceased to turn has no past.
void LineTilts::remember(NearPairs &p)
{
  constexpr double OTHER = 1.0;    // sines differ by less, UPRIGHT and UNKNOWN_FORCE by more
  double *const now = p.past_tilt[0].data(), *const last = p.past_tilt[1].data();
  double *const before = p.past_tilt[2].data();
  double fewest = 1.0;
  for (int k = 0; k < p.wall; ++k) {
    const double sine = is_upright(k) ? UPRIGHT : next[k];
    fewest = std::min(fewest, turns[k]);
    const bool is_new = std::fabs(now[k] - sine) > OTHER;
    now[k] = sine;
    last[k] = is_new || std::fabs(last[k] - sine) > OTHER ? sine : last[k];
    before[k] = is_new || std::fabs(before[k] - sine) > OTHER ? sine : before[k];
  }
  any_upright = fewest == 0.0;
}
