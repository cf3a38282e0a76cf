// See kernels.h.

#define DEFORMABLE_LEVEL plain
#define DEFORMABLE_LANES 2
#include "kernels.h"
