// What formulas need that are the same for one number and for several side by side: T is double, or a vector type of GCC and Clang.
// A condition is a bool, or a mask, which is -1 (true) or 0 in each place.

#ifndef DEFORMABLE_NUMBERS_H
#define DEFORMABLE_NUMBERS_H

#include <type_traits>
#include <utility>

namespace deformable {

// For functions that must not be linked into code for other processors, and for loops of short lengths that the
// compiler unrolls for each length.
#define DEFORMABLE_INLINE inline __attribute__((always_inline))
#define DEFORMABLE_LANE_LAMBDA __attribute__((always_inline))

template <class T> constexpr bool IS_ONE = std::is_arithmetic_v<T>;

// The vector of value(w). Written out, because compilers turn loops over lanes into instructions that gather and scatter, which
// are slow.
template <class T, class Value, int... LANE>
DEFORMABLE_INLINE T each_of(Value &&value, std::integer_sequence<int, LANE...>)
{
  return T{value(LANE)...};
}
template <class T> constexpr int SIZE_OF = sizeof(T) / sizeof(T{}[0]);
template <class T, class Value> DEFORMABLE_INLINE T each_of(Value &&value)
{
  return each_of<T>(value, std::make_integer_sequence<int, SIZE_OF<T>>());
}

template <class M, class T> DEFORMABLE_INLINE T select(M m, T yes, T no)
{
  return m ? yes : no;
}

template <class M> DEFORMABLE_INLINE bool any(M m)
{
  if constexpr (IS_ONE<M>) {
    return m;
  } else {
    long long found = 0;
    for (int w = 0; w < SIZE_OF<M>; ++w) found |= m[w];
    return found != 0;
  }
}

template <class M> DEFORMABLE_INLINE bool all_true(M m)
{
  return !any(!m);
}

template <class T> DEFORMABLE_INLINE T root(T x)
{
  if constexpr (IS_ONE<T>)
    return __builtin_sqrt(x);
  else
    return each_of<T>([&](int w) DEFORMABLE_LANE_LAMBDA { return __builtin_sqrt(x[w]); });
}

template <class T> DEFORMABLE_INLINE T magnitude(T x)
{
  if constexpr (IS_ONE<T>)
    return __builtin_fabs(x);
  else
    return (T)((decltype(x < x))x & 0x7fffffffffffffffLL);
}

template <class T> DEFORMABLE_INLINE T with_sign_of(T x, T sign)
{
  if constexpr (IS_ONE<T>) {
    return __builtin_copysign(x, sign);
  } else {
    using Bits = decltype(x < x);
    constexpr long long BIT = -0x7fffffffffffffffLL - 1;
    return (T)(((Bits)x & ~BIT) | ((Bits)sign & BIT));
  }
}

template <class T> DEFORMABLE_INLINE T larger(T a, T b)
{
  return a < b ? b : a;
}

template <class T> DEFORMABLE_INLINE T smaller(T a, T b)
{
  return b < a ? b : a;
}

}    // namespace deformable

#endif
