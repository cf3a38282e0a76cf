// What one rank finds out stops all ranks. A rank that stopped alone would leave the others waiting for it in the next
// communication, for ever if the caller is Python.
//
// Checks of single particles call `refuse`, within the work of `collect`, which must not communicate. All ranks call `agree`
// then, or carry `any_here` in a sum of their own.

#ifndef LMP_REFUSALS_H
#define LMP_REFUSALS_H

#include "pointers.h"

#include "fmt/format.h"

#include <string>

namespace LAMMPS_NS {

struct Refused {
  std::string message;
};

template <class... Args> [[noreturn]] void refuse(const char *format, const Args &...args)
{
  throw Refused{fmt::vformat(format, fmt::make_format_args(args...))};
}

class Refusals : protected Pointers {
 public:
  explicit Refusals(class LAMMPS *lmp) : Pointers(lmp) {}

  // Keeps the message of work that refuses.
  template <class Work> void collect(Work &&work)
  {
    try {
      work();
    } catch (const Refused &refused) {
      if (message.empty()) message = refused.message;
    }
  }
  bool any_here() const { return !message.empty(); }
  // Before a run, if the last one has ended with another error.
  void forget() { message.clear(); }

  // On all ranks: stops them with the message of the first rank that has one.
  void agree();
  [[noreturn]] void stop();    // where all know that one has

  // Both.
  template <class Work> void check(Work &&work)
  {
    collect(work);
    agree();
  }

 private:
  std::string message;
};

}    // namespace LAMMPS_NS

#endif
