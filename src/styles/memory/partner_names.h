// Names of partners that outlive commands between runs: delete_atoms and reset_atoms give particles new IDs, fix and unfix
// give walls new codes.

#ifndef LMP_PARTNER_NAMES_H
#define LMP_PARTNER_NAMES_H

#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace LAMMPS_NS {

class LAMMPS;

// The numbers of all ranks, one rank after the other.
std::vector<double> of_all_ranks(LAMMPS *, std::vector<double> here);

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

// The walls of all fixes deformable/wall. A wall has the code -1 - (w + n feature), in the order of the n fixes (visit_walls): it
// is known by the ID of its fix and the name of its feature, if that has others.
class WallNames {
 public:
  static WallNames present(LAMMPS *);
  bool operator==(const WallNames &other) const { return walls == other.walls; }

  // The code there of a wall that has this code here, or 0: it is gone.
  double code_in(const WallNames &there, double code) const;
  bool has(double code) const;
  std::string name_of(double code) const;

  // As a line for each fix.
  std::string text() const;
  static WallNames from_text(const std::string &);

 private:
  struct Wall {
    std::string id;
    std::vector<std::string> features;    // none: the region has not been read yet
    bool operator==(const Wall &other) const
    {
      return id == other.id && features == other.features;
    }
  };
  std::vector<Wall> walls;
  int fix_of(double code) const { return static_cast<int>(-1.0 - code) % count(); }
  int feature_of(double code) const { return static_cast<int>(-1.0 - code) / count(); }
  int count() const { return static_cast<int>(walls.size()); }
};

}    // namespace LAMMPS_NS

#endif
