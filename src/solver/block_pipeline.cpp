#include "solver/block_pipeline.h"

#include "comm.h"

#include <algorithm>
#include <cmath>
#include <limits>

using namespace LAMMPS_NS;
using deformable::PairArrays;

void BlockPipeline::arrange(ForceBatches &b, NearPairs &p, RemoteSides &r)
{
  pairs = &p;
  batches = &b;
  remote = &r;
  blocks.arrange(b, p);
  relaxation.arrange(b, p);
  make_room();
  pairs_of_all = 1.0 + sum_over_pairs([](int begin, int end) { return end - begin; });
}

void BlockPipeline::begin_call()
{
  evaluations = 0;
  make_room();
}

void BlockPipeline::make_room()
{
  batches->scale = pairs->scale;
  // nothing happens in the last one, which stays zero
  const std::size_t one_more = pairs->size + 1;
  for (LargeVector<float> *v : {&residual, &weight, &step})
    if (v->size() != one_more) v->assign(one_more, 0.0F);
}

void BlockPipeline::extrapolate(const deformable::Extrapolation &by)
{
  kernels.extrapolate(arrays(), by, 0, pairs->size);
  if (!pairs->sticks) return;
  for (int k = 0; k < pairs->size; ++k)
    if (pairs->past[k] == deformable::UNKNOWN_FORCE) pairs->force[k] = 0.0;
}

void BlockPipeline::start_from_nothing()
{
  std::fill(pairs->force.begin(), pairs->force.end(), 0.0);
}

void BlockPipeline::take_past()
{
  const PairArrays a = arrays();
  for (int k = 0; k < pairs->size; ++k)
    a.force[k] = a.past[k] == deformable::UNKNOWN_FORCE
                     ? 0.0
                     : std::max(a.past[k], deformable::least_force<double>(a, k));
  --evaluations;    // the next one has the same forces as the last one
}

PairArrays BlockPipeline::arrays()
{
  NearPairs &p = *pairs;
  PairArrays a;
  a.overlap = p.overlap.data();
  a.stiffening = p.stiffening.data();
  a.first = p.side[0].data();
  a.second = p.side[1].data();
  a.indentation = batches->indentation.data();
  a.compliance = batches->compliance.data();
  a.correction = batches->step.data();
  a.force = p.force.data();
  a.residual = residual.data();
  a.weight = weight.data();
  a.step = step.data();
  a.length = p.length;
  a.unit = p.unit();
  a.past = p.past.data();
  for (int n = 0; n < 3; ++n) a.earlier[n] = p.earlier[n].data();
  a.before = a.earlier[0];
  a.least = p.least.empty() ? nullptr : p.least.data();
  return a;
}

/* ----------------------------------------------------------------------
   The overlaps of both ranks differ by the rounding of ghosts' positions, and
   their first forces by their pasts. Otherwise the residuals of both would
   never vanish together, and the difference of their forces would grow from
   call to call: no residual depends on it.
------------------------------------------------------------------------- */

void BlockPipeline::agree()
{
  if (comm->nprocs == 1) return;
  NearPairs &p = *pairs;
  const int own = batches->contacts, *const side = p.side[0].data() + p.remote;
  const int count = p.wall - p.remote;
  // an evaluation replaces them
  double *const here = batches->indentation.data(), *const there = here + own;
  const auto take_means = [&](LargeVector<double> &of_pairs) {
    double *const value = of_pairs.data() + p.remote;
    for (int c = 0; c < count; ++c) here[side[c]] = value[c];
    remote->exchange(side, own, here);
    for (int c = 0; c < count; ++c) value[c] = 0.5 * (value[c] + there[c]);
  };
  take_means(p.overlap);
  take_means(p.force);
  if (p.curved) take_means(p.per_distance);
}

/* ---------------------------------------------------------------------- */

void BlockPipeline::OfBlock::add(const deformable::Residuals &r, double part)
{
  error = std::max(error, r.error);
  force = std::max(force, r.force);
  left = std::max(left, r.left);
  norm2 += part * r.norm2;
  weights += part * r.weights;
}

Evaluation BlockPipeline::run(const Stages &stages, Evaluation *before,
                              const BlockLevels::Choice *chosen)
{
  batches->clear_none();
  const deformable::RingBatches rings = batches->arrays();
  deformable::RingBatches here = rings;    // of the block that has its turn
  const int corrections =
      static_cast<int>(std::count(stages.begin(), stages.end(), Stage::CORRECT));
  const int first = static_cast<int>(std::find(stages.begin(), stages.end(), Stage::CORRECT) -
                                     stages.begin());    // from 0; stages count from 1
  of_blocks.resize((before ? 2 : 1) * blocks.count());
  for (std::size_t block = 0; block < of_blocks.size(); ++block)
    if (!chosen || (*chosen)[block]) of_blocks[block] = {};
  bool exist = true;
  blocks.run(
      static_cast<int>(stages.size()),
      [&](int block, int stage) {
        const bool is_before = before && stage <= first;
        blocks.choose(here, block);
        work(stages[stage - 1], block, stage - first, here,
             of_blocks[is_before ? blocks.count() + block : block], exist);
      },
      [&](int stage) {
        const int *const side = pairs->side[0].data() + pairs->remote;
        const Stage done = stages[stage - 1];
        if (done == Stage::CORRECT && stage < first + corrections)
          remote->exchange(side, batches->contacts, ForceCorrector::products(rings, stage - first));
        else if (done == Stage::SHAPE || done == Stage::ADAPT)
          remote->exchange(side, batches->contacts, batches->indentation.data(),
                           batches->compliance.data());
      },
      chosen);
  if (stages.back() == Stage::LOOK) ++evaluations;
  if (before) {
    ++evaluations;
    *before = sum_up(blocks.count(), true);
  }
  return sum_up(0, exist);
}

void BlockPipeline::work(Stage stage, int block, int iteration, deformable::RingBatches &here,
                         OfBlock &found, bool &exist)
{
  const PairArrays loop = arrays();
  switch (stage) {
    case Stage::WAIT: break;
    case Stage::RELAX:
      found = {};
      relaxation.relax(block, kernels, blocks, *pairs, *batches, loop);
      break;
    case Stage::TURN:
      relaxation.take_turned(here, [&](const deformable::RingBatches &turned) {
        exist &= kernels.shape(turned, pairs->directions());
      });
      break;
    case Stage::CORRECT: corrector.iterate(here, loop, iteration); break;
    case Stage::STEP:
      blocks.for_pairs(block, [&](int begin, int end, double part) {
        found.slope += part * kernels.take_step(loop, false, begin, end);
      });
      break;
    case Stage::SHAPE: exist &= kernels.shape(here, pairs->directions()); break;
    case Stage::ADAPT:
      exist &= kernels.adapt(here, pairs->force.data(), step.data(), loop.unit);
      break;
    case Stage::LOOK:
      blocks.for_pairs(block, [&](int begin, int end, double part) {
        found.add(kernels.find_residuals(loop, begin, end), part);
      });
  }
}

// What the blocks have found, from this place on.
Evaluation BlockPipeline::sum_up(int first, bool exist) const
{
  double largest[4] = {0.0, 0.0, 0.0, exist ? 0.0 : 1.0}, sum[3] = {0.0, 0.0, 0.0};
  for (int block = first; block < first + blocks.count(); ++block) {
    const OfBlock &found = of_blocks[block];
    largest[0] = std::max(largest[0], found.error);
    largest[1] = std::max(largest[1], found.force);
    largest[2] = std::max(largest[2], found.left);
    sum[0] += found.norm2;
    sum[1] += found.weights;
    sum[2] += found.slope;
  }
  if (comm->nprocs > 1) {
    MPI_Allreduce(MPI_IN_PLACE, largest, 4, MPI_DOUBLE, MPI_MAX, world);
    MPI_Allreduce(MPI_IN_PLACE, sum, 3, MPI_DOUBLE, MPI_SUM, world);
  }
  // Overlaps are not known better than this.
  constexpr double ROUNDING = 8.0 * std::numeric_limits<double>::epsilon();
  Evaluation now;
  now.imbalance = largest[2] <= ROUNDING ? 0.0 : largest[0];
  now.force = std::max(largest[1], std::isinf(largest[2]) ? largest[2] : 0.0);
  now.exists = largest[3] == 0.0 && std::isfinite(now.force);
  now.norm2 = sum[0];
  now.weights = sum[1];
  now.slope = sum[2];
  return now;
}

// The weighted root mean square of r, times the mean weight.
double BlockPipeline::imbalance_per_pair(const Evaluation &e) const
{
  return std::sqrt(e.norm2 * e.weights) / pairs_of_all * pairs->unit();
}

/* ---------------------------------------------------------------------- */

int BlockPipeline::begin_corrections(const Evaluation &from, double accuracy)
{
  if (from.norm2 > 0.0)
    return corrector.begin(*pairs, *batches, *remote, arrays(), from.norm2, accuracy);
  std::fill(batches->step.begin(), batches->step.end(), 0.0F);
  return 0;
}

// Single precision has the smaller one of two numbers well.
void BlockPipeline::move(double from, double to, int begin, int end)
{
  const PairArrays a = arrays();
  for (int k = begin; k < end; ++k) {
    const double before = a.before[k], change = a.step[k], force = a.force[k];
    const bool is_small = std::fabs(change) < std::fabs(before);
    const double moved = is_small    ? force + (to - from) * change * a.unit
                         : to == 0.0 ? before * a.unit
                                     : (before + to * change) * a.unit;
    a.force[k] = std::max(moved, deformable::least_force<double>(a, k));
  }
}

double BlockPipeline::slope_at_end()
{
  return unit_of_energy() * sum_over_pairs([this](int begin, int end) {
           return kernels.dot(residual.data(), step.data(), begin, end);
         });
}

double BlockPipeline::step_alone()
{
  return sum_over_pairs(
      [this](int begin, int end) { return kernels.take_step(arrays(), true, begin, end); });
}

double BlockPipeline::bytes() const
{
  return bytes_of(residual, weight, step, of_blocks) + blocks.bytes() + relaxation.bytes();
}
