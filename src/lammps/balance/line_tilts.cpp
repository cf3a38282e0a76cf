#include "line_tilts.h"

#include "tilt.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using deformable::LARGEST_SINE;

void LineTilts::arrange(ForceBatches &b, NearPairs &p, RemoteSides &r)
{
  pairs = &p;
  batches = &b;
  remote = &r;
}

// From three past tilts: without the twist.
void LineTilts::predict(const deformable::Extrapolation &by)
{
  NearPairs &p = *pairs;
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

void LineTilts::begin()
{
  const NearPairs &p = *pairs;
  part = 1.0;
  last_imbalance = 0.0;
  next.resize(p.size);
  rate.resize(batches->indentation.size());
  for (int k = 0; k < p.size; ++k) {
    const double sine = p.past_tilt[0][k];
    const bool is_known = sine != deformable::UNKNOWN_FORCE;
    next[k] = is_known ? std::clamp(sine, -LARGEST_SINE, LARGEST_SINE) : 0.0;
  }
  turn();
}

deformable::LineArrays LineTilts::arrays()
{
  NearPairs &p = *pairs;
  deformable::LineArrays a;
  a.per_distance = p.per_distance.data();
  a.force = p.force.data();
  a.first = p.side[0].data();
  a.second = p.side[1].data();
  a.slope = batches->slope.data();
  a.slope_rate = rate.data();
  a.sine = p.tilt.data();
  a.next = next.data();
  a.overlap = p.overlap.data();
  a.angle = p.angle.data();
  a.nx = p.nx.data();
  a.ny = p.ny.data();
  a.part = part;
  return a;
}

double LineTilts::imbalance()
{
  kernels.slopes(batches->arrays(), pairs->directions(), rate.data());
  remote->exchange(pairs->side[0].data() + pairs->remote, batches->contacts, batches->slope.data(),
                   rate.data());
  return remote->largest(kernels.find_tilts(arrays(), 0, pairs->wall));
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

void LineTilts::turn()
{
  kernels.turn_lines(arrays(), 0, pairs->wall);
}

void LineTilts::remember()
{
  NearPairs &p = *pairs;
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
