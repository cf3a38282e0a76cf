// What one rank finds out stops all ranks. A rank that stopped alone would leave the others waiting for it in the next
// communication, for ever if the caller is Python.
//
// Checks of single particles call `refuse`, within the work of `collect`, which must not communicate. All ranks call `agree`
// then, or carry `any_here` in a sum of their own.
//
// Below are the checks of what LAMMPS' other commands do.

#ifndef DEFORMABLE_REFUSALS_H
#define DEFORMABLE_REFUSALS_H

#include "styles/lammps_names.h"

#include "fmt/format.h"

#include <string>
#include <vector>

namespace deformable {

struct Refused {
  std::string message;
};

template <class... Args> [[noreturn]] void refuse(const char *format, const Args &...args)
{
  throw Refused{fmt::vformat(format, fmt::make_format_args(args...))};
}

class Refusals : protected Pointers {
 public:
  explicit Refusals(LAMMPS *lmp) : Pointers(lmp) {}

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

// Commands of LAMMPS that would make results of the deformable pair styles wrong.

struct Species;

// Refuses if special_bonds or comm_modify removes contacts of particles of these species (by type).
void check_contacts(LAMMPS *, const NeighList &, const std::vector<Species> &);

// The same for comm_modify only, which removes the ghosts of particles outside of a group.
void check_ghosts(LAMMPS *, const NeighList &);

// Refuses run_style respa, which would not call the fix.
void refuse_respa(LAMMPS *, const char *id, const char *fix);

// Refuses coefficients in a data file, which are of another pair style.
void refuse_data_coefficients(LAMMPS *);

// Warns if z or vz of a particle is not zero; whether one is, on any rank.
bool warn_out_of_plane(LAMMPS *, const NeighList &);

// Warns if the radius of a particle is not that of its species; whether one is not, on any rank.
bool warn_unused_radii(LAMMPS *, const NeighList &, const std::vector<Species> &);

}    // namespace deformable

#endif
