#include "solver/pair_relaxation.h"

#include "laws/green.h"

#include <algorithm>
#include <cmath>

namespace deformable {

void PairRelaxation::arrange(const ContactBatches &b, const NearPairs &p)
{
  pairs = p.size;
  waits.assign(p.size, false);
  is_changed.assign(b.batches, 0);
  is_free.assign(b.batches, 1);
  for (int k = p.remote; k < p.wall; ++k) is_free[b.place[p.i[k]] / LANES] = 0;
}

bool PairRelaxation::begin(const Tuning &tuning, double tolerance, double largest_force)
{
  constexpr double LEAST = 3.0, MOST = 1e4, STEP = 1.25;
  if (tolerances == 0.0 || tuning.relaxed_part == 0.0)
    tolerances = tuning.relaxed;
  else if (relaxed > tuning.relaxed_part * pairs)
    tolerances = std::min(tolerances * STEP, MOST);
  else
    tolerances = std::max(tolerances / STEP, LEAST);
  relaxed = 0;
  crowd = tuning.crowd;
  of_ring = tuning.of_ring;
  limit = tolerances * tolerance * largest_force;
  most = tuning.relaxed_to * largest_force;
  return tuning.relaxed * tolerance * largest_force < most;
}

// The change of the force of a pair that balances it if all others stay.
static double change_alone(const PairArrays &a, int k)
{
  const double residual = a.residual[k], weight = std::fabs(a.weight[k]);
  return std::max(residual * weight * a.unit, least_force<double>(a, k) - a.force[k]);
}

void PairRelaxation::wait_for(const PairArrays &a, int k)
{
  if (waits[k] || !(std::fabs(change_alone(a, k)) > limit)) return;
  waits[k] = true;
  waiting.push_back(k);
}

// The residuals of all pairs of a ring after the force of its contact c has changed: those of CorrectionArrays, with C of
// ContactArrays.
void PairRelaxation::change_particle(const ContactBatches &b, const PairArrays &a, int ring, int c,
                                     float by)
{
  const int batch = ring / LANES, first = b.first[batch] + ring % LANES, m = (c - first) / LANES;
  const float *const green = b.green.data() + b.first_green[batch] + ring % LANES;
  const float *const share = b.share.data() + first;
  const int *const pair_side = b.pair_side.data() + first;
  const float along = share[m * LANES] * by;
  float of_share = b.square[ring] * along, constant = 0.0F;
  if (b.soft) {
    of_share += b.mixed[ring] * by;
    constant = b.rate[ring] * by - b.mixed[ring] * along;
  }
  const float per_p = static_cast<float>(b.per_pressure[ring] / b.scale);
  is_changed[batch] = 1;
  for (int q = 0; q < b.size[batch]; ++q) {
    const int k = pair_side[q * LANES] >> 1;
    if (k == pairs) continue;    // an empty place
    const int low = std::min(q, m), high = std::max(q, m);
    const float between = q != m          ? green[(high * (high - 1) / 2 + low) * LANES]
                          : b.own.empty() ? static_cast<float>(GREEN_AT_ZERO)
                                          : b.own[c];
    a.residual[k] -= (between * by - of_share * share[q * LANES] + constant) * per_p;
    wait_for(a, k);
  }
}

void PairRelaxation::relax(int block, const ForceKernels &kernels, const BlockLevels &blocks,
                           const NearPairs &p, const ContactBatches &b, const PairArrays &a)
{
  constexpr std::size_t OFTEN = 50, ANY = 1000;
  std::size_t of_block = 0, first_ones = 0;
  blocks.for_pairs(block, [&](int begin, int end, double) {
    if (begin >= p.remote && begin < p.wall) return;
    of_block += end - begin;
    if (waiting.size() < of_block) waiting.resize(of_block);
    first_ones += kernels.find_unbalanced(a, limit, begin, end, waiting.data() + first_ones);
  });
  waiting.resize(first_ones);
  for (const int k : waiting) waits[k] = true;
  const bool is_crowded = first_ones > crowd * of_block + 10;
  const std::size_t last = is_crowded ? 0 : OFTEN * first_ones + ANY;

  const auto may_change = [&](int ring, double by) {
    return is_free[ring / LANES] && by < of_ring * b.total[ring];
  };
  for (std::size_t next = 0; next < waiting.size(); ++next) {
    const int k = waiting[next];
    waits[k] = false;
    const double change = change_alone(a, k), size = std::fabs(change);
    if (next >= last || !(size > limit && size < most)) continue;
    const int i = b.place[p.i[k]], j = k < p.wall ? b.place[p.second(k)] : i;
    if (!may_change(i, size) || !may_change(j, size)) continue;
    ++relaxed;
    a.force[k] += change;
    const float by = static_cast<float>(change / a.unit);
    a.step[k] += by;
    change_particle(b, a, i, p.side[0][k], by);
    if (k < p.wall) change_particle(b, a, j, p.side[1][k], by);
  }
}

}    // namespace deformable
