// Threads of one process that share the work of a force call. What they compute does not depend on their number: each has a range
// of blocks, pairs or particles, and sums are by block.
//
// They sleep between calls. They belong to the process that has started them: after a fork the child does all work alone.

#ifndef DEFORMABLE_THREADS_H
#define DEFORMABLE_THREADS_H

#include <memory>
#include <type_traits>

namespace deformable {

class Threads {
 public:
  Threads();
  ~Threads();

  // The caller included, of this process.
  int count() const;
  void set_count(int);    // starts or ends threads
  // That this process may use, alone or beside others. More threads than that wait for each other.
  static int usable_cores();

  // work(thread) on each thread, 0 is the caller. Returns when all are done.
  template <class Work> void run(Work &&work)
  {
    run_all(
        [](void *of, int thread) { (*static_cast<std::remove_reference_t<Work> *>(of))(thread); },
        &work);
  }
  // Within run: until all threads have come here.
  void wait_for_all();

  // work(begin, end) or work(begin, end, thread) for parts of [0, size), one for each thread.
  template <class Work> void share(int size, Work &&work)
  {
    const int parts = count();
    run([&](int thread) {
      const int begin = part_begin(size, thread, parts), end = part_begin(size, thread + 1, parts);
      if (begin >= end) return;
      if constexpr (std::is_invocable_v<Work, int, int, int>)
        work(begin, end, thread);
      else
        work(begin, end);
    });
  }

 private:
  using Call = void (*)(void *of, int thread);
  struct Team;
  std::unique_ptr<Team> team;    // null: only the caller

  void run_all(Call, void *of);

  // Parts begin at whole lines of a cache, also of bytes.
  static int part_begin(int size, int part, int parts)
  {
    constexpr int LINE = 64;
    return part == parts ? size : static_cast<int>(1LL * size * part / parts) / LINE * LINE;
  }
};

}    // namespace deformable

#endif
