#include "line_tilts.h"

#include "tilt.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using deformable::LARGEST_SINE;

// From three past tilts: without the twist.
void LineTilts::predict(NearPairs &p, const deformable::Extrapolation &by)
{
  const double *const now = p.past_tilt[0].data(), *const last = p.past_tilt[1].data();
  double *const before = p.past_tilt[2].data();
  for (int k = 0; k < p.size; ++k)
    if (now[k] == deformable::UNKNOWN_FORCE) {
      before[k] = now[k];
    } else {
      const double change = now[k] - last[k], bend = change - (last[k] - before[k]);
      before[k] = now[k] + by.slope * change + by.bend * bend;
    }
  std::swap(p.past_tilt[1], p.past_tilt[2]);
  std::swap(p.past_tilt[0], p.past_tilt[1]);
}

void LineTilts::start(NearPairs &p, ForceBatches &b, const deformable::ForceKernels &kernels)
{
  part = 1.0;
  last_imbalance = 0.0;
  next.resize(p.size);
  rate.resize(b.indentation.size());
  for (int k = 0; k < p.size; ++k) {
    const double sine = p.past_tilt[0][k];
    const bool is_known = sine != deformable::UNKNOWN_FORCE;
    next[k] = is_known ? std::clamp(sine, -LARGEST_SINE, LARGEST_SINE) : 0.0;
  }
  turn(p, b, kernels);
}

deformable::LineArrays LineTilts::arrays(NearPairs &p, ForceBatches &b)
{
  return {p.per_distance.data(),
          p.force.data(),
          p.side[0].data(),
          p.side[1].data(),
          b.slope.data(),
          rate.data(),
          p.tilt.data(),
          next.data(),
          p.overlap.data(),
          p.angle.data(),
          p.nx.data(),
          p.ny.data(),
          part};
}

double LineTilts::find(NearPairs &p, ForceBatches &b, const deformable::ForceKernels &kernels)
{
  return kernels.find_tilts(arrays(p, b), 0, p.wall);
}

// Forces respond to tilts, which Newton's method for each line alone does not know. Beyond the model the response may be
// so strong that full steps oscillate.
void LineTilts::adapt(double imbalance)
{
  constexpr double NOT_LESS = 0.9, LEAST = 0.05;
  const bool falls = last_imbalance == 0.0 || imbalance < NOT_LESS * last_imbalance;
  part = falls ? std::min(1.0, 1.5 * part) : std::max(LEAST, 0.5 * part);
  last_imbalance = imbalance;
}

void LineTilts::turn(NearPairs &p, ForceBatches &b, const deformable::ForceKernels &kernels)
{
  kernels.turn_lines(arrays(p, b), 0, p.wall);
}

void LineTilts::remember(NearPairs &p)
{
  double *const now = p.past_tilt[0].data(), *const last = p.past_tilt[1].data();
  double *const before = p.past_tilt[2].data();
  for (int k = 0; k < p.wall; ++k) {
    const double sine = next[k];
    const bool is_new = now[k] == deformable::UNKNOWN_FORCE;
    now[k] = sine;
    last[k] = is_new || last[k] == deformable::UNKNOWN_FORCE ? sine : last[k];
    before[k] = is_new || before[k] == deformable::UNKNOWN_FORCE ? sine : before[k];
  }
  const auto count = [&p](int begin, int end) {
    int found = 0;
    for (int k = begin; k < end; ++k)
      found += std::fabs(p.tilt[k]) >= LARGEST_SINE && p.force[k] > 0.0;
    return found;
  };
  limited = count(0, p.remote) + 0.5 * count(p.remote, p.wall);
}
