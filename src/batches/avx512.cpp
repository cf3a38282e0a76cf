// See kernels.h.

#define DEFORMABLE_LEVEL avx512
#define DEFORMABLE_LANES 8
#include "kernels.h"
