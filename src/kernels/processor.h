// Which SIMD instructions this processor has.

#ifndef DEFORMABLE_PROCESSOR_H
#define DEFORMABLE_PROCESSOR_H

namespace deformable {

// A processor that has a level has all levels before it. avx2 is x86-64-v3, avx512 is x86-64-v4.
enum class Level { plain, avx2, avx512 };
constexpr const char *LEVEL_NAMES[] = {"plain", "avx2", "avx512"};

inline Level processor_level()
{
#ifdef __x86_64__
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma") ||
      !__builtin_cpu_supports("bmi") || !__builtin_cpu_supports("bmi2"))
    return Level::plain;
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                 __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                 __builtin_cpu_supports("avx512vl")
             ? Level::avx512
             : Level::avx2;
#else
  return Level::plain;
#endif
}

}    // namespace deformable

#endif
