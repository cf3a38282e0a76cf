// Prints the level of SIMD instructions of this processor.

#include "../src/kernels/processor.h"

#include <cstdio>

int main()
{
  std::fputs(deformable::LEVEL_NAMES[static_cast<int>(deformable::processor_level())], stdout);
}
