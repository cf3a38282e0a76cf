// The choice of a level for this processor.

#include "kernels/batch_kernels.h"

#include <cstring>

namespace deformable {

#define DEFORMABLE_KERNELS_OF(LEVEL)                                                               \
  namespace LEVEL {                                                                                \
  extern const BatchKernel sector_kernels[], ring_kernels[];                                       \
  extern const ForceKernels force_kernels;                                                         \
  extern const DropletKernels droplet_kernels;                                                     \
  static const BatchKernels kernels = {#LEVEL, sector_kernels, ring_kernels, force_kernels,        \
                                       droplet_kernels};                                           \
  }

DEFORMABLE_KERNELS_OF(plain)
#ifdef DEFORMABLE_X86_LEVELS
DEFORMABLE_KERNELS_OF(avx2)
DEFORMABLE_KERNELS_OF(avx512)
#endif

const BatchKernels *batch_kernels(const char *level)
{
  struct Level {
    const BatchKernels *kernels;
    bool runs;
  };
#ifdef DEFORMABLE_X86_LEVELS    // x86-64-v3 and x86-64-v4
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                        __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
#endif
  const Level levels[] = {
#ifdef DEFORMABLE_X86_LEVELS
      {&avx512::kernels,
       has_avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl")},
      {&avx2::kernels, has_avx2},
#endif
      {&plain::kernels, true}};
  for (const Level &l : levels)
    if (l.runs && (level[0] == 0 || std::strcmp(level, l.kernels->level) == 0)) return l.kernels;
  return nullptr;
}

}    // namespace deformable
