// Vectors of many numbers: where they begin decides how fast a loop through several of them is.
//
// Linux gives them large pages if it may: with small ones a virtual machine spends a tenth of the time of balanced
// contacts on addresses, from some ten thousand particles on. And those that are made one after the other do not begin at
// the same place of a page, where their equal elements would compete for the same few lines of a cache.

#ifndef DEFORMABLE_LARGE_VECTOR_H
#define DEFORMABLE_LARGE_VECTOR_H

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace deformable {

// Seven lines of 64 bytes from that of the last vector: 64 of them, all lines of a small page, are different.
inline std::size_t next_shift()
{
  static std::size_t count = 0;
  return 7 * 64 * count++ % 4096;
}

template <class T> struct LargePages {
  using value_type = T;

  LargePages() = default;
  template <class U> LargePages(const LargePages<U> &) {}

  T *allocate(std::size_t n)
  {
    const std::size_t bytes = n * sizeof(T), page = page_of(bytes);
    if (page == 0) {
      void *const memory = std::malloc(bytes);
      if (!memory) throw std::bad_alloc();
      return static_cast<T *>(memory);
    }
    const std::size_t shift = next_shift(), all = (shift + bytes + page - 1) / page * page;
    void *const memory = std::aligned_alloc(page, all);
    if (!memory) throw std::bad_alloc();
#ifdef __linux__
    // The rest of a vector, less than a large page, stays on small ones: no memory is wasted.
    if (page == LARGE) madvise(memory, (shift + bytes) / page * page, MADV_HUGEPAGE);
#endif
    return reinterpret_cast<T *>(static_cast<char *>(memory) + shift);
  }
  void deallocate(T *memory, std::size_t n)
  {
    const std::size_t page = page_of(n * sizeof(T));
    const std::size_t shift = page == 0 ? 0 : reinterpret_cast<std::uintptr_t>(memory) % page;
    std::free(reinterpret_cast<char *>(memory) - shift);
  }

  bool operator==(const LargePages &) const { return true; }
  bool operator!=(const LargePages &) const { return false; }

 private:
  static constexpr std::size_t LARGE = 1 << 21, SMALL = 1 << 12;

  // that vectors of so many bytes are aligned to, but for their shift; 0: few bytes are not
  static std::size_t page_of(std::size_t bytes)
  {
    return bytes >= LARGE ? LARGE : bytes >= 4 * SMALL ? SMALL : 0;
  }
};

template <class T> using LargeVector = std::vector<T, LargePages<T>>;

// Memory that vectors hold.
template <class... Vector> double bytes_of(const Vector &...vector)
{
  return (static_cast<double>(vector.capacity() * sizeof(typename Vector::value_type)) + ... + 0.0);
}

}    // namespace deformable

#endif
