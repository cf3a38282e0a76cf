// The kernels of force_lanes.h for all batches, in versions for vectors of 2, 4 and 8 numbers.

#include "force_batches.h"

using namespace LAMMPS_NS;
using namespace deformable;

namespace {

DEFORMABLE_KERNEL ContactLanes from_lane(ContactLanes c, int w)
{
  c.seat += w;
  c.indentation += w;
  c.compliance += w;
  c.green += w;
  c.d_green += w;
  return c;
}

DEFORMABLE_KERNEL RingLanes from_lane(RingLanes r, int w)
{
  for (const double **p : {&r.radius, &r.kA, &r.kP}) *p += w;
  for (double **p : {&r.pressure, &r.expansion, &r.work, &r.total, &r.per_pressure, &r.mixed,
                     &r.square, &r.rate})
    *p += w;
  return r;
}

// kernel(n, contacts, rings, first contact) for each vector of rings, n a constant for the usual numbers of contacts.
template <class V, class Kernel> DEFORMABLE_KERNEL void for_all(ForceBatches &b, Kernel &&kernel)
{
  constexpr int N = sizeof(V) / 8;
  for (int batch = 0; batch < b.batches; ++batch)
    for (int w = 0; w < LANES; w += N) {
      const ContactLanes c = from_lane(b.of(batch), w);
      const RingLanes r = from_lane(b.lanes(batch), w);
      const int first = b.first[batch] + w;
      switch (c.contacts) {
        case 3: kernel(std::integral_constant<int, 3>(), c, r, first); break;
        case 4: kernel(std::integral_constant<int, 4>(), c, r, first); break;
        case 5: kernel(std::integral_constant<int, 5>(), c, r, first); break;
        case 6: kernel(std::integral_constant<int, 6>(), c, r, first); break;
        case 7: kernel(std::integral_constant<int, 7>(), c, r, first); break;
        case 8: kernel(std::integral_constant<int, 8>(), c, r, first); break;
        default: kernel(std::integral_constant<int, 0>(), c, r, first);
      }
    }
}

template <class V, bool SOFT, bool NEW>
DEFORMABLE_KERNEL bool shape_all(ForceBatches &b, const NearPairs &p)
{
  const PairArrays pairs = {p.force.data(), p.angle.data(), p.nx.data(), p.ny.data()};
  bool exist = true;
  for_all<V>(b, [&](auto n, const ContactLanes &c, const RingLanes &r, int)
                    __attribute__((always_inline)) {
                      exist &= shape_lanes<V, decltype(n)::value, SOFT, NEW>(pairs, c, r);
                    });
  return exist;
}

template <class V, bool SOFT> DEFORMABLE_KERNEL void multiply_all(ForceBatches &b, const double *x)
{
  for_all<V>(b, [&](auto n, const ContactLanes &c, const RingLanes &r, int first)
                    __attribute__((always_inline)) {
                      multiply_lanes<V, decltype(n)::value, SOFT>(x, c, r, &b.product[first]);
                    });
}

template <class V> DEFORMABLE_KERNEL void slopes_all(ForceBatches &b, const double *force)
{
  for_all<V>(b, [&](auto n, const ContactLanes &c, const RingLanes &r, int first)
                    __attribute__((always_inline)) {
                      slope_lanes<V, decltype(n)::value>(force, c, r, &b.product[first]);
                    });
}

#define DEFORMABLE_BATCH_KERNELS(NAME, TARGET, N)                                                  \
  TARGET bool shape_##NAME(ForceBatches &b, const NearPairs &p, bool fresh)                        \
  {                                                                                                \
    using V = LaneVector<N>::Type;                                                                 \
    if (b.soft) return fresh ? shape_all<V, true, true>(b, p) : shape_all<V, true, false>(b, p);   \
    return fresh ? shape_all<V, false, true>(b, p) : shape_all<V, false, false>(b, p);             \
  }                                                                                                \
  TARGET void multiply_##NAME(ForceBatches &b, const double *x)                                    \
  {                                                                                                \
    using V = LaneVector<N>::Type;                                                                 \
    b.soft ? multiply_all<V, true>(b, x) : multiply_all<V, false>(b, x);                           \
  }                                                                                                \
  TARGET void slopes_##NAME(ForceBatches &b, const double *force)                                  \
  {                                                                                                \
    slopes_all<LaneVector<N>::Type>(b, force);                                                     \
  }                                                                                                \
  constexpr ForceKernels NAME##_KERNELS = {shape_##NAME, multiply_##NAME, slopes_##NAME, #NAME};

DEFORMABLE_BATCH_KERNELS(plain, , 2)
#if defined(__x86_64__)
DEFORMABLE_BATCH_KERNELS(avx2, __attribute__((target("avx2"))), 4)
DEFORMABLE_BATCH_KERNELS(avx512, __attribute__((target("avx512f,avx512dq,avx512vl"))), 8)
#endif

const ForceKernels &chosen()
{
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return avx512_KERNELS;
  if (__builtin_cpu_supports("avx2")) return avx2_KERNELS;
#endif
  return plain_KERNELS;
}

}    // namespace

const ForceKernels &LAMMPS_NS::force_kernels()
{
  static const ForceKernels &kernels = chosen();
  return kernels;
}
