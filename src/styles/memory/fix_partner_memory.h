// The base of fixes whose particles remember their partners: other particles, by their IDs, and walls, by codes < 0. What they
// remember follows new IDs and other walls.
//
// Each particle also remembers its own ID. Where that has changed, the IDs of its partners may have, too: `follow` tells old
// ones from new ones.

#ifndef DEFORMABLE_FIX_PARTNER_MEMORY_H
#define DEFORMABLE_FIX_PARTNER_MEMORY_H

#include "geometry/scene.h"
#include "styles/all_ranks.h"
#include "styles/lammps_names.h"
#include "styles/memory/fix_memory.h"

#include "comm.h"
#include "error.h"
#include "lammps.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace deformable {

// Names of partners that outlive commands between runs: delete_atoms and reset_atoms give particles new IDs, fix and unfix
// give walls new codes.

// The new IDs of all particles of all ranks that have changed theirs.
class NewIDs {
 public:
  // own[i]: the ID that particle i of this rank had before, 0 if it was not there. On all ranks.
  NewIDs(LAMMPS *, const std::vector<double> &own);

  double of(double id) const;    // 0: the particle is gone

 private:
  std::unordered_map<double, double> changed;
  std::unordered_set<double> taken;    // by particles that had another ID, or none
};

// The walls of all fixes deformable/wall. A code (wall_code) depends on the order of the fixes: a wall is known by the ID of its fix
// and the name of its feature, if that has others.
class WallNames {
 public:
  static WallNames present(LAMMPS *);
  bool operator==(const WallNames &other) const { return walls == other.walls; }

  bool has(double code) const;
  // The code there of a wall that has this code here, or 0: it is gone.
  double code_in(const WallNames &there, double code) const;
  std::string name_of(double code) const;

  // As a line for each fix, after an empty one.
  std::string text() const;
  static WallNames from_text(const std::string &);
  // A code of the file that the text is from. Files without an empty line have codes -1 - (w + n feature), with n walls.
  double from_file(double code) const;

 private:
  struct Wall {
    std::string id;
    std::vector<Scene::Features> features;    // none: the region has not been read yet
    int count() const;
    bool operator==(const Wall &other) const
    {
      return id == other.id && features == other.features;
    }
  };
  std::vector<Wall> walls;
  bool counted = false;    // whether codes of the file depend on the number of walls
};

// Row: a struct of doubles that begins with `partner`.
template <class Row> struct PartnerMemory {
  double id = 0.0;          // its own, as of the last `follow`; 0: it was not there
  double is_known = 0.0;    // 0: its rows may not be all
  std::vector<Row> rows;
  std::array<double, 4> lost = {};    // energies, of a fix that counts them
};

// A record has energies where any are lost: fewer numbers than a row.
template <class Row> bool has_lost(const PartnerMemory<Row> &memory)
{
  return memory.lost != std::array<double, 4>{};
}
template <class Row> int count_of(const PartnerMemory<Row> &memory)
{
  const int rows = count_of(Row{}) * static_cast<int>(memory.rows.size());
  return 2 + rows + (has_lost(memory) ? static_cast<int>(memory.lost.size()) : 0);
}
template <class Row> void write(const PartnerMemory<Row> &memory, double *numbers)
{
  numbers[0] = memory.id;
  numbers[1] = memory.is_known;
  std::memcpy(numbers + 2, memory.rows.data(), memory.rows.size() * sizeof(Row));
  if (has_lost(memory))
    std::copy(memory.lost.begin(), memory.lost.end(),
              numbers + 2 + memory.rows.size() * count_of(Row{}));
}
template <class Row> void read(PartnerMemory<Row> &memory, const double *numbers, int count)
{
  memory.id = numbers[0];
  memory.is_known = numbers[1];
  memory.rows.resize((count - 2) / count_of(Row{}));
  std::memcpy(memory.rows.data(), numbers + 2, memory.rows.size() * sizeof(Row));
  memory.lost = {};
  const int read = 2 + count_of(Row{}) * static_cast<int>(memory.rows.size());
  std::copy(numbers + read, numbers + count, memory.lost.begin());
}

template <class Row> class FixPartnerMemory : public FixMemory<PartnerMemory<Row>> {
  using Base = FixMemory<PartnerMemory<Row>>;

 public:
  FixPartnerMemory(LAMMPS *lmp, int narg, char **arg, const char *name) : Base(lmp, narg, arg, name)
  {
    this->restart_global = this->maxexchange_dynamic = 1;
  }

  // LAMMPS makes its buffers before it sends particles along x, then y: a large one that comes along x may go on along y.
  int setmask() override { return FixConst::PRE_EXCHANGE | FixConst::MIN_PRE_EXCHANGE; }
  void init() override { make_room_everywhere(); }
  void pre_exchange() override { make_room_everywhere(); }
  void min_pre_exchange() override { make_room_everywhere(); }

  // On all ranks, where the neighbor list is new: partners get their present names. Partners that are gone are forgotten.
  void follow()
  {
    follow_walls();
    follow_particles();
    for (int i = 0; i < atom->nlocal; ++i) particles[i].id = static_cast<double>(atom->tag[i]);
    hand_over();
  }

  // After `restart`.
  void unpack_restart(int i, int fix) override
  {
    Base::unpack_restart(i, fix);
    for (Row &row : particles[i].rows)
      if (row.partner < 0.0) row.partner = walls.from_file(row.partner);
  }

  double memory_usage() override
  {
    double sum = Base::memory_usage();
    for (const PartnerMemory<Row> &particle : particles) sum += bytes_of(particle.rows);
    return sum;
  }

  // The sums of the fix, the number of particles, and the names of the walls.
  void write_restart(FILE *file) override
  {
    std::vector<double> sums = all_sums();
    sums.push_back(static_cast<double>(atom->natoms));
    const std::string names = walls.text();
    if (comm->me != 0) return;
    const int numbers = static_cast<int>(sums.size() * sizeof(double));
    const int bytes = numbers + static_cast<int>(names.size()) + 1;
    std::fwrite(&bytes, sizeof bytes, 1, file);
    std::fwrite(sums.data(), 1, numbers, file);
    std::fwrite(names.c_str(), 1, names.size() + 1, file);
  }
  void restart(char *buffer) override
  {
    std::vector<double> sums = all_sums();
    sums.push_back(0.0);
    const std::size_t numbers = sums.size() * sizeof(double);
    std::memcpy(sums.data(), buffer, numbers);
    require_all_particles(sums.back());
    sums.pop_back();
    go_on_from(sums);
    walls = WallNames::from_text(buffer + numbers);
  }

 protected:
  using Base::atom, Base::comm, Base::error, Base::id, Base::lmp, Base::particles, Base::world;

  // What the fix sums up, of all ranks, on all ranks.
  virtual std::vector<double> all_sums() = 0;
  virtual void go_on_from(const std::vector<double> &sums) = 0;

  void remember(int i, const Row &row)
  {
    particles[i].rows.push_back(row);
    this->make_room(i);
  }

  // Whether another particle remembers this now, as seen from there.
  virtual bool belongs_to_partner(int, const Row &) const { return false; }
  virtual Row from_partner(int, const Row &row) const { return row; }

  // By ID, of the particles of this rank.
  std::unordered_map<double, int> local_indices() const
  {
    std::unordered_map<double, int> indices;
    for (int i = 0; i < atom->nlocal; ++i) indices[static_cast<double>(atom->tag[i])] = i;
    return indices;
  }

  // Stops if one of these partners, which a command names on all ranks, does not exist.
  void require_partners(const std::vector<double> &partners, const std::string &command) const
  {
    const std::unordered_map<double, int> here = local_indices();
    std::vector<int> exists, anywhere(partners.size());
    for (const double partner : partners)
      exists.push_back(partner < 0.0 ? walls.has(partner) : here.count(partner) > 0);
    MPI_Allreduce(exists.data(), anywhere.data(), static_cast<int>(exists.size()), MPI_INT, MPI_MAX,
                  world);
    const auto missing = std::find(anywhere.begin(), anywhere.end(), 0);
    if (missing == anywhere.end()) return;
    const double partner = partners[missing - anywhere.begin()];
    error->all(FLERR, "{}: {:.0f} is neither the ID of an atom nor the number < 0 of a wall",
               command, partner);
  }

 private:
  // LAMMPS gives particles what the file says of them when this fix is made, by their indices at read_restart.
  void require_all_particles(double number) const
  {
    if (number != static_cast<double>(atom->natoms))
      error->all(
          FLERR,
          "Fix {}: the restart file has {:.0f} atoms, but there are {}. It would mix up what "
          "they remember: create and delete atoms after pair_coeff and this fix",
          id, number, atom->natoms);
  }

  WallNames walls;    // that the codes in rows are of

  void make_room_everywhere()
  {
    if (this->peratom_flag)    // what particles have lost
      for (int i = 0; i < atom->nlocal; ++i) this->make_room(i);
    this->maxexchange = largest_of_ranks(world, Base::maxexchange);
  }

  // Calls rename(partner), which may return 0 for one that is gone. Returns how many are.
  template <class Rename> int rename(Rename &&new_name)
  {
    int gone = 0;
    for (int i = 0; i < atom->nlocal; ++i) {
      std::vector<Row> &rows = particles[i].rows;
      for (Row &row : rows) row.partner = new_name(row.partner);
      const auto end = std::remove_if(rows.begin(), rows.end(),
                                      [](const Row &row) { return row.partner == 0.0; });
      gone += static_cast<int>(rows.end() - end);
      rows.erase(end, rows.end());
    }
    return gone;
  }

  void follow_walls()
  {
    const WallNames now = WallNames::present(lmp);
    if (now == walls) return;
    double lost = 0.0;    // code of a wall, 0: none
    const int gone = rename([&](double partner) {
      if (partner > 0.0) return partner;
      const double code = walls.code_in(now, partner);
      if (code == 0.0) lost = partner;
      return code;
    });
    double counts[] = {lost, -1.0 * gone}, of_all[2];
    MPI_Allreduce(&counts, &of_all, 2, MPI_DOUBLE, MPI_MIN, world);
    if (of_all[1] < 0.0 && comm->me == 0)
      error->warning(FLERR, "Fix {}: contacts end at walls that are not there any more, as at {}",
                     id, walls.name_of(of_all[0]));
    walls = now;
  }

  void follow_particles()
  {
    int here[] = {0, 0}, any[2];    // new IDs, rows
    std::vector<double> own(atom->nlocal);
    for (int i = 0; i < atom->nlocal; ++i) {
      own[i] = particles[i].id;
      here[0] |= own[i] != static_cast<double>(atom->tag[i]);
      here[1] |= !particles[i].rows.empty();
    }
    MPI_Allreduce(here, any, 2, MPI_INT, MPI_MAX, world);
    if (!any[0] || !any[1]) return;
    const NewIDs ids(lmp, own);
    rename([&](double partner) { return partner < 0.0 ? partner : ids.of(partner); });
    renamed = true;
  }

  // Each row to the particle that remembers it: an order of IDs may have changed.
  bool renamed = false;
  void hand_over()
  {
    if (!renamed) return;
    renamed = false;
    const int WIDTH = count_of(Row{});
    std::vector<double> here;    // IDs and rows
    for (int i = 0; i < atom->nlocal; ++i) {
      std::vector<Row> &rows = particles[i].rows;
      for (std::size_t n = 0; n < rows.size();) {
        if (!belongs_to_partner(i, rows[n])) {
          ++n;
          continue;
        }
        const Row row = from_partner(i, rows[n]);
        here.push_back(rows[n].partner);
        here.resize(here.size() + WIDTH);
        write(row, &here[here.size() - WIDTH]);
        rows.erase(rows.begin() + n);
      }
    }
    const std::vector<double> all = of_all_ranks(lmp, here);
    if (all.empty()) return;
    const std::unordered_map<double, int> index = local_indices();
    for (std::size_t n = 0; n < all.size(); n += 1 + WIDTH) {
      const auto found = index.find(all[n]);
      if (found == index.end()) continue;
      Row row;
      read(row, &all[n + 1], WIDTH);
      remember(found->second, row);
    }
  }
};

}    // namespace deformable

#endif
