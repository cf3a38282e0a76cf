// The contact laws for batches of particles. Compiled for each level of SIMD instructions, see cmake/sources.cmake.

#include "kernels/batch_kernels.h"
#include "kernels/ring_batch.h"
#include "kernels/sector_batch.h"

namespace deformable::DEFORMABLE_LEVEL {

// Batches of W particles. The last one is filled up with copies of its last particle.
#define DEFORMABLE_BATCHES(NAME, BATCH)                                                            \
  template <int N>                                                                                 \
  static void NAME(BlockParticle *const *particles, int count, Place *places, bool shapes)         \
  {                                                                                                \
    for (int begin = 0; begin < count; begin += W) {                                               \
      BlockParticle *batch[W];                                                                     \
      for (int w = 0; w < W; ++w) batch[w] = particles[begin + w < count ? begin + w : count - 1]; \
      BATCH(batch, places, shapes);                                                                \
    }                                                                                              \
  }

DEFORMABLE_BATCHES(rings, (ring_batch<N, Perimeter::CONSERVED>))
DEFORMABLE_BATCHES(soft_rings, (ring_batch<N, Perimeter::SOFT>))
DEFORMABLE_BATCHES(tense_rings, (ring_batch<N, Perimeter::TENSE>))
DEFORMABLE_BATCHES(sectors, sector_batch<N>)

extern const BatchKernel sector_kernels[MOST_IN_BATCH + 1], ring_kernels[3 * MOST_IN_BATCH + 1];

const BatchKernel sector_kernels[] = {nullptr,    nullptr,    sectors<2>, sectors<3>, sectors<4>,
                                      sectors<5>, sectors<6>, sectors<7>, sectors<8>};
const BatchKernel ring_kernels[] = {
    nullptr,        rings<1>,       rings<2>,       rings<3>,       rings<4>,
    rings<5>,       rings<6>,       rings<7>,       rings<8>,       soft_rings<1>,
    soft_rings<2>,  soft_rings<3>,  soft_rings<4>,  soft_rings<5>,  soft_rings<6>,
    soft_rings<7>,  soft_rings<8>,  tense_rings<1>, tense_rings<2>, tense_rings<3>,
    tense_rings<4>, tense_rings<5>, tense_rings<6>, tense_rings<7>, tense_rings<8>};

}    // namespace deformable::DEFORMABLE_LEVEL
