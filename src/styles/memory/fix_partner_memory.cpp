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

const WallNames::Wall &WallNames::wall(double code) const
{
  return walls[wall_of(static_cast<int>(code), count())];
}

int WallNames::feature_of(double code) const
{
  return wall_feature_of(static_cast<int>(code), count());
}

bool WallNames::has(double code) const
{
  if (walls.empty()) return false;
  const std::vector<std::string> &features = wall(code).features;
  return features.empty() || feature_of(code) < static_cast<int>(features.size());
}

double WallNames::code_in(const WallNames &there, double code) const
{
  if (!has(code)) return 0.0;
  const Wall &here = wall(code);
  const auto same = std::find_if(there.walls.begin(), there.walls.end(),
                                 [&](const Wall &other) { return other.id == here.id; });
  if (same == there.walls.end()) return 0.0;
  int feature = feature_of(code);
  const bool is_only = here.features.size() == 1 && same->features.size() == 1;
  if (!here.features.empty() && !same->features.empty() && !is_only) {
    const auto found =
        std::find(same->features.begin(), same->features.end(), here.features[feature]);
    if (found == same->features.end()) return 0.0;
    feature = static_cast<int>(found - same->features.begin());
  }
  const double found =
      wall_code(static_cast<int>(same - there.walls.begin()), feature, there.count());
  return there.has(found) ? found : 0.0;
}

std::string WallNames::name_of(double code) const
{
  if (walls.empty()) return fmt::format("{:g}", code);
  const Wall &named = wall(code);
  if (!has(code) || named.features.size() < 2) return "fix " + named.id;
  return fmt::format("'{}' of fix {}", named.features[feature_of(code)], named.id);
}

std::string WallNames::text() const
{
  std::string text;
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
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    Wall wall;
    std::getline(words, wall.id, '\t');
    for (std::string feature; std::getline(words, feature, '\t');) wall.features.push_back(feature);
    names.walls.push_back(wall);
  }
  return names;
}

}    // namespace deformable
