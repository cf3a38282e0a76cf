// The choice of a level for this processor. DEFORMABLE_LEVELS: LEVEL(name) for each that is compiled, the highest one first.

#include "kernels/batch_kernels.h"
#include "kernels/processor.h"

#include <iterator>

namespace deformable {

#define LEVEL(NAME)                                                                                \
  namespace NAME {                                                                                 \
  extern const BatchKernel sector_kernels[], ring_kernels[];                                       \
  extern const ForceKernels force_kernels;                                                         \
  extern const DropletKernels droplet_kernels, sticking_droplet_kernels;                           \
  extern const FrontKernels front_kernels;                                                         \
  static const BatchKernels kernels = {                                                            \
      sector_kernels,           ring_kernels, force_kernels, droplet_kernels,                      \
      sticking_droplet_kernels, front_kernels};                                                    \
  }
DEFORMABLE_LEVELS
#undef LEVEL

struct CompiledLevel {
  Level level;
  const BatchKernels *kernels;
  const char *name() const { return LEVEL_NAMES[static_cast<int>(level)]; }
};

#define LEVEL(NAME) {Level::NAME, &NAME::kernels},
static const CompiledLevel compiled[] = {DEFORMABLE_LEVELS};
#undef LEVEL

const BatchKernels *batch_kernels(const std::string &level)
{
  for (const CompiledLevel &c : compiled)
    if (c.level <= processor_level() && (level.empty() || level == c.name())) return c.kernels;
  return nullptr;
}

std::string why_no_kernels(const char *name, const std::string &level)
{
  std::string names;
  for (const CompiledLevel &c : compiled) names = c.name() + (names.empty() ? "" : ", " + names);
  const std::string here = LEVEL_NAMES[static_cast<int>(processor_level())];
  if (!level.empty())
    return std::string(name) + " is '" + level + "': compiled are " + names +
           (std::size(compiled) < std::size(LEVEL_NAMES) ? " (-D DEFORMABLE_SIMD_LEVELS=all: all)"
                                                         : "") +
           ", of which this processor has those up to " + here;
  return "lammps-deformable was compiled for processors with " + names + ", but this one has " +
         here +
         ": compile it on this machine, or for all with -D DEFORMABLE_SIMD_LEVELS=all, see "
         "docs/install.md";
}

}    // namespace deformable
