// Random numbers by counters: each is a function of a seed, a particle and a step, so that any rank finds the same.
//
// The counters are mixed one after another by the 64-bit finalizer of the generator SplitMix64.
// Source: Steele, Lea, Flood, OOPSLA '14, 453 (2014).

#ifndef DEFORMABLE_COUNTED_RANDOM_H
#define DEFORMABLE_COUNTED_RANDOM_H

#include "laws/trigonometry.h"

#include <cmath>
#include <cstdint>

namespace deformable {

inline std::uint64_t mixed(std::uint64_t bits)
{
  bits += 0x9e3779b97f4a7c15u;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
  return bits ^ (bits >> 31);
}

// Of a particle at a step.
class CountedRandom {
 public:
  CountedRandom(std::uint64_t seed, std::uint64_t particle, std::uint64_t step)
      : state(mixed(mixed(mixed(seed) ^ particle) ^ step))
  {
  }

  // Between 0 and 1, both excluded.
  double uniform()
  {
    state = mixed(state);
    return (static_cast<double>(state >> 11) + 0.5) * 0x1p-53;
  }

  // Of mean 0 and variance 1, by Box and Muller.
  double gaussian()
  {
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    return radius * std::cos(2.0 * PI * uniform());
  }

 private:
  std::uint64_t state;
};

}    // namespace deformable

#endif
