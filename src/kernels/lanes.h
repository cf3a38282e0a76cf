// Numbers of several particles side by side: the vector types of GCC and Clang, without intrinsics.
//
// Each level of SIMD instructions has a source file of its own, compiled for it, which defines DEFORMABLE_LEVEL
// (a namespace) and DEFORMABLE_LANES. All functions are inlined: one that is not could be linked into code that
// runs on processors without these instructions. Products and sums are neither contracted nor reordered, so that
// every level computes the same bits.

#ifndef DEFORMABLE_LANES_H
#define DEFORMABLE_LANES_H

#include "laws/numbers.h"

#include <type_traits>
#include <utility>

#define DEFORMABLE_LANE_FUNCTION static inline __attribute__((always_inline, unused))

namespace deformable::DEFORMABLE_LEVEL {

constexpr int W = DEFORMABLE_LANES;
typedef double Lanes __attribute__((vector_size(8 * W)));
typedef decltype(Lanes{} < Lanes{}) Mask;

// Action(w) for each lane, and the vector of value(w).
template <class Action, int... LANE>
DEFORMABLE_LANE_FUNCTION void for_each_of(Action &&action, std::integer_sequence<int, LANE...>)
{
  (action(LANE), ...);
}

template <class Value> DEFORMABLE_LANE_FUNCTION Lanes each_lane(Value &&value)
{
  return each_of<Lanes>(value);
}

template <class Action> DEFORMABLE_LANE_FUNCTION void for_each_lane(Action &&action)
{
  for_each_of(action, std::make_integer_sequence<int, W>());
}

DEFORMABLE_LANE_FUNCTION Lanes all(double x)
{
  return x - Lanes{};
}

// Numbers in single precision in memory, which arithmetic does not see.
typedef float Singles __attribute__((vector_size(4 * W)));

// Numbers for arithmetic in single precision: twice as many, and not more than 8, the rings of a batch.
constexpr int FLOATS = W < 4 ? 2 * W : 8;
typedef float Floats __attribute__((vector_size(4 * FLOATS)));

// One or several numbers, T is double or Lanes.

template <class T> DEFORMABLE_LANE_FUNCTION T load(const double *from)
{
  T x;
  __builtin_memcpy(&x, from, sizeof x);
  return x;
}

template <class T> DEFORMABLE_LANE_FUNCTION T load(const float *from)
{
  if constexpr (sizeof(T) == sizeof(double)) {
    return *from;
  } else if constexpr (std::is_same_v<T, Floats>) {
    Floats x;
    __builtin_memcpy(&x, from, sizeof x);
    return x;
  } else {
    Singles x;
    __builtin_memcpy(&x, from, sizeof x);
    return __builtin_convertvector(x, Lanes);
  }
}

template <class T> DEFORMABLE_LANE_FUNCTION void store(double *to, T x)
{
  __builtin_memcpy(to, &x, sizeof x);
}

DEFORMABLE_LANE_FUNCTION void store(float *to, double x)
{
  *to = static_cast<float>(x);
}

DEFORMABLE_LANE_FUNCTION void store(float *to, Lanes x)
{
  const Singles rounded = __builtin_convertvector(x, Singles);
  __builtin_memcpy(to, &rounded, sizeof rounded);
}

DEFORMABLE_LANE_FUNCTION void store_floats(float *to, Floats x)
{
  __builtin_memcpy(to, &x, sizeof x);
}

// Two numbers in single precision side by side, in the memory of one double.
template <class T> struct Both {
  T first, second;
};

typedef float TwoSingles __attribute__((vector_size(8 * W)));
typedef float TwoFloats __attribute__((vector_size(8 * FLOATS)));

template <class One, class Two> struct TwoVectors {
  static constexpr int SIZE = sizeof(One) / sizeof(float);
  template <int... N>
  DEFORMABLE_LANE_LAMBDA static Two join(One a, One b, std::integer_sequence<int, N...>)
  {
    return Two{(N % 2 == 0 ? a[N / 2] : b[N / 2])...};
  }
  template <int... N>
  DEFORMABLE_LANE_LAMBDA static One part(Two two, int odd, std::integer_sequence<int, N...>)
  {
    return odd ? One{two[2 * N + 1]...} : One{two[2 * N]...};
  }
  DEFORMABLE_LANE_LAMBDA static void store(double *to, One a, One b)
  {
    const Two two = join(a, b, std::make_integer_sequence<int, 2 * SIZE>());
    __builtin_memcpy(to, &two, sizeof two);
  }
  DEFORMABLE_LANE_LAMBDA static Both<One> load(const void *from)
  {
    Two two;
    __builtin_memcpy(&two, from, sizeof two);
    const auto each = std::make_integer_sequence<int, SIZE>();
    return {part(two, 0, each), part(two, 1, each)};
  }
};

DEFORMABLE_LANE_FUNCTION void store_both(double *to, Lanes a, Lanes b)
{
  TwoVectors<Singles, TwoSingles>::store(to, __builtin_convertvector(a, Singles),
                                         __builtin_convertvector(b, Singles));
}

DEFORMABLE_LANE_FUNCTION void store_both(double *to, double a, double b)
{
  const float both[2] = {static_cast<float>(a), static_cast<float>(b)};
  __builtin_memcpy(to, both, sizeof both);
}

DEFORMABLE_LANE_FUNCTION Both<Lanes> both_of(Lanes bits)
{
  const auto both = TwoVectors<Singles, TwoSingles>::load(&bits);
  return {__builtin_convertvector(both.first, Lanes), __builtin_convertvector(both.second, Lanes)};
}

DEFORMABLE_LANE_FUNCTION Both<double> both_of(double bits)
{
  float two[2];
  __builtin_memcpy(two, &bits, sizeof two);
  return {two[0], two[1]};
}

// x[index[w]]
DEFORMABLE_LANE_FUNCTION Floats gather_floats(const float *x, const int *index)
{
  return each_of<Floats>([&](int w) DEFORMABLE_LANE_LAMBDA { return x[index[w]]; });
}

// x[index(w)]
template <class T, class Number, class Index>
DEFORMABLE_LANE_FUNCTION T gather(const Number *x, Index &&index)
{
  const auto value = [&](int w) DEFORMABLE_LANE_LAMBDA { return x[index(w)]; };
  if constexpr (sizeof(T) == sizeof(double))
    return value(0);
  else if constexpr (sizeof(Number) == sizeof(double))
    return each_lane(value);
  else
    return __builtin_convertvector(each_of<Singles>(value), Lanes);
}

}    // namespace deformable::DEFORMABLE_LEVEL

#endif
