#include "styles/memory/fix_partner_memory.h"

#include "styles/walls/fix_deformable_wall.h"

#include "atom.h"
#include "fmt/format.h"
#include "modify.h"

#include <algorithm>
#include <sstream>

namespace deformable {

NewIDs::NewIDs(LAMMPS *lmp, const std::vector<double> &own)
{
  const tagint *const tag = lmp->atom->tag;
  std::vector<double> here;
  for (int i = 0; i < lmp->atom->nlocal; ++i)
    if (own[i] != static_cast<double>(tag[i]))
      here.insert(here.end(), {own[i], static_cast<double>(tag[i])});
  const std::vector<double> all = of_all_ranks(lmp, here);
  for (std::size_t n = 0; n < all.size(); n += 2) {
    if (all[n] != 0.0) changed[all[n]] = all[n + 1];
    taken.insert(all[n + 1]);
  }
}

double NewIDs::of(double id) const
{
  const auto found = changed.find(id);
  if (found != changed.end()) return found->second;
  return taken.count(id) ? 0.0 : id;
}

WallNames WallNames::present(LAMMPS *lmp)
{
  WallNames names;
  for (const Fix *fix : lmp->modify->get_fix_by_style(FixDeformableWall::STYLE))
    names.walls.push_back({fix->id, static_cast<const FixDeformableWall *>(fix)->feature_names()});
  return names;
}

bool WallNames::has(double code) const
{
  const std::size_t wall = wall_of(static_cast<int>(code));
  if (wall >= walls.size()) return false;
  const std::vector<std::string> &features = walls[wall].features;
  return features.empty() ||
         wall_feature_of(static_cast<int>(code)) < static_cast<int>(features.size());
}

double WallNames::code_in(const WallNames &there, double code) const
{
  if (!has(code)) return 0.0;
  const Wall &here = walls[wall_of(static_cast<int>(code))];
  const auto same = std::find_if(there.walls.begin(), there.walls.end(),
                                 [&](const Wall &other) { return other.id == here.id; });
  if (same == there.walls.end()) return 0.0;
  int feature = wall_feature_of(static_cast<int>(code));
  const bool is_only = here.features.size() == 1 && same->features.size() == 1;
  if (!here.features.empty() && !same->features.empty() && !is_only) {
    const auto found =
        std::find(same->features.begin(), same->features.end(), here.features[feature]);
    if (found == same->features.end()) return 0.0;
    feature = static_cast<int>(found - same->features.begin());
  }
  const double found = wall_code(static_cast<int>(same - there.walls.begin()), feature);
  return there.has(found) ? found : 0.0;
}

std::string WallNames::name_of(double code) const
{
  if (!has(code)) return fmt::format("{:g}", code);
  const Wall &wall = walls[wall_of(static_cast<int>(code))];
  if (wall.features.size() < 2) return "fix " + wall.id;
  return fmt::format("'{}' of fix {}", wall.features[wall_feature_of(static_cast<int>(code))],
                     wall.id);
}

std::string WallNames::text() const
{
  std::string text = "\n";
  for (const Wall &wall : walls) {
    text += wall.id;
    for (const std::string &feature : wall.features) text += '\t' + feature;
    text += '\n';
  }
  return text;
}

WallNames WallNames::from_text(const std::string &text)
{
  WallNames names;
  std::istringstream lines(text);
  names.counted = lines.peek() != '\n';
  if (!names.counted) lines.get();
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    Wall wall;
    std::getline(words, wall.id, '\t');
    for (std::string feature; std::getline(words, feature, '\t');) wall.features.push_back(feature);
    names.walls.push_back(wall);
  }
  return names;
}

double WallNames::from_file(double code) const
{
  if (!counted || walls.empty()) return code;
  const int index = static_cast<int>(-1.0 - code), count = static_cast<int>(walls.size());
  return wall_code(index % count, index / count);
}

}    // namespace deformable
