// The base of fixes that remember something of each particle, which stays with it: in LAMMPS' arrays, on other ranks, in
// restart files. A fix says only what that is.
//
// Memory: a struct of doubles, or another one with functions `count_of`, `write` and `read` beside it, as PartnerMemory. A
// particle that is new has Memory{}. On the way it is one record of doubles: their number, then the memory.
//
// Where memory is a per-atom array of the fix it is double, with `columns` of them for each particle: commands of LAMMPS know such an
// array by the place of its first number and the number of columns.

#ifndef DEFORMABLE_FIX_MEMORY_H
#define DEFORMABLE_FIX_MEMORY_H

#include "fix.h"

#include "kernels/large_vector.h"
#include "styles/all_ranks.h"
#include "styles/lammps_names.h"

#include "atom.h"

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <vector>

namespace deformable {

template <class Memory> int count_of(const Memory &)
{
  static_assert(std::is_trivially_copyable<Memory>::value && sizeof(Memory) % sizeof(double) == 0,
                "a struct of doubles");
  return sizeof(Memory) / sizeof(double);
}
template <class Memory> void write(const Memory &memory, double *numbers)
{
  std::memcpy(numbers, &memory, sizeof memory);
}
template <class Memory> void read(Memory &memory, const double *numbers, int count)
{
  std::memcpy(static_cast<void *>(&memory), numbers,
              std::min(sizeof memory, count * sizeof(double)));
}

template <class Memory> class FixMemory : public Fix {
 public:
  // `name`: the style of this object, see FixDeformableWall.
  FixMemory(LAMMPS *lmp, int narg, char **arg, const char *name) : Fix(lmp, narg, arg)
  {
    delete[] style;
    style = utils::strdup(name);
    restart_peratom = create_attribute = 1;
  }

  ~FixMemory() override
  {
    if (!begun) return;
    atom->delete_callback(id, Atom::GROW);
    if (restart_peratom) atom->delete_callback(id, Atom::RESTART);
  }

  double memory_usage() override { return bytes_of(particles); }
  void grow_arrays(int size) override { particles.resize(columns * size); }
  void copy_arrays(int from, int to, int /*delflag*/) override
  {
    std::copy_n(of(from), columns, of(to));
  }
  void set_arrays(int i) override { std::fill_n(of(i), columns, Memory{}); }

  int pack_exchange(int i, double *record) override
  {
    record[0] = size_restart(i);
    const int count = count_of(*of(i));
    for (int k = 0; k < columns; ++k) write(of(i)[k], record + 1 + k * count);
    return size_restart(i);
  }
  int unpack_exchange(int i, double *record) override
  {
    unpack(i, record);
    return size_restart(i);
  }

  int pack_restart(int i, double *record) override { return pack_exchange(i, record); }
  // Atom::extra has the records of all fixes, one after the other.
  void unpack_restart(int i, int fix) override
  {
    const double *record = atom->extra[i];
    for (int n = 0; n < fix; ++n) record += static_cast<int>(record[0]);
    unpack(i, record);
  }
  int size_restart(int i) override { return 1 + columns * count_of(*of(i)); }
  // Of all ranks: rank 0 writes into the file how much room a reader needs.
  int maxsize_restart() override
  {
    int most = 1 + columns * count_of(Memory{});
    for (int i = 0; i < atom->nlocal; ++i) most = std::max(most, size_restart(i));
    return largest_of_ranks(world, most);
  }

 protected:
  int columns = 1;    // set before `begin`, as is restart_peratom = 0 of what a run finds anew
  std::vector<Memory> particles;    // by local index, then by column
  Memory *of(int i) { return &particles[i * columns]; }

  // At the end of a constructor, which stops where words are wrong: LAMMPS does not know the fix then.
  void begin()
  {
    grow_arrays(atom->nmax);
    maxexchange = 1 + columns * count_of(Memory{});
    atom->add_callback(Atom::GROW);
    if (restart_peratom) atom->add_callback(Atom::RESTART);
    begun = true;
  }

  // Where this particle remembers more. LAMMPS' buffers have room for one particle of the largest size.
  void make_room(int i) { maxexchange = std::max(maxexchange, size_restart(i)); }

 private:
  bool begun = false;

  void unpack(int i, const double *record)
  {
    const int count = (static_cast<int>(record[0]) - 1) / columns;
    for (int k = 0; k < columns; ++k) read(of(i)[k], record + 1 + k * count, count);
    make_room(i);
  }
};

}    // namespace deformable

#endif
