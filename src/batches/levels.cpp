// The choice of a level for this processor.

#include "batch_kernels.h"

#include <cstring>

namespace deformable {

namespace plain {
extern const BatchKernels kernels;
}
#ifdef DEFORMABLE_X86_LEVELS
namespace avx2 {
extern const BatchKernels kernels;
}
namespace avx512 {
extern const BatchKernels kernels;
}
#endif

const BatchKernels *batch_kernels(const char *level)
{
  struct Level {
    const BatchKernels *kernels;
    bool runs;
  };
  const Level levels[] = {
#ifdef DEFORMABLE_X86_LEVELS
      {&avx512::kernels, __builtin_cpu_supports("x86-64-v4") != 0},
      {&avx2::kernels, __builtin_cpu_supports("x86-64-v3") != 0},
#endif
      {&plain::kernels, true}};
  for (const Level &l : levels)
    if (l.runs && (level[0] == 0 || std::strcmp(level, l.kernels->level) == 0)) return l.kernels;
  return nullptr;
}

}    // namespace deformable
