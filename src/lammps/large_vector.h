// Vectors of many numbers. Linux gives them large pages if it may: with small ones a virtual machine spends a tenth of the
// time of balanced contacts on addresses, from some ten thousand particles on.

#ifndef DEFORMABLE_LARGE_VECTOR_H
#define DEFORMABLE_LARGE_VECTOR_H

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace LAMMPS_NS {

template <class T> struct LargePages {
  using value_type = T;

  LargePages() = default;
  template <class U> LargePages(const LargePages<U> &) {}

  // The rest of a vector, less than a large page, stays on small ones: no memory is wasted.
  T *allocate(std::size_t n)
  {
    const std::size_t bytes = n * sizeof(T);
#ifdef __linux__
    constexpr std::size_t PAGE = 1 << 21;
    const std::size_t paged = bytes / PAGE * PAGE;
    if (paged > 0) {
      void *const memory = std::aligned_alloc(PAGE, (bytes + PAGE - 1) / PAGE * PAGE);
      if (!memory) throw std::bad_alloc();
      madvise(memory, paged, MADV_HUGEPAGE);    // if that fails, pages are small
      return static_cast<T *>(memory);
    }
#endif
    void *const memory = std::malloc(bytes);
    if (!memory) throw std::bad_alloc();
    return static_cast<T *>(memory);
  }
  void deallocate(T *memory, std::size_t) { std::free(memory); }

  bool operator==(const LargePages &) const { return true; }
  bool operator!=(const LargePages &) const { return false; }
};

template <class T> using LargeVector = std::vector<T, LargePages<T>>;

}    // namespace LAMMPS_NS

#endif
