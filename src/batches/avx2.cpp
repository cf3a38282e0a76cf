// See kernels.h.

#define DEFORMABLE_LEVEL avx2
#define DEFORMABLE_LANES 4
#include "kernels.h"
