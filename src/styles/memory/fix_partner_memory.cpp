#include "styles/memory/fix_partner_memory.h"

#include "styles/walls/fix_deformable_wall.h"

#include "atom.h"
#include "fmt/format.h"
#include "modify.h"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <sstream>
#include <utility>

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

int WallNames::Wall::count() const
{
  return std::accumulate(features.begin(), features.end(), 0,
                         [](int sum, const Scene::Features &some) { return sum + some.count; });
}

bool WallNames::has(double code) const
{
  const std::size_t wall = wall_of(static_cast<int>(code));
  if (wall >= walls.size()) return false;
  return walls[wall].features.empty() ||
         wall_feature_of(static_cast<int>(code)) < walls[wall].count();
}

// The name of a feature, and its number among those of this name.
static std::pair<std::string, int> numbered(const std::vector<Scene::Features> &features,
                                            int feature)
{
  for (const Scene::Features &some : features) {
    if (feature < some.count) return {some.name, some.first + feature};
    feature -= some.count;
  }
  return {"", 0};
}

double WallNames::code_in(const WallNames &there, double code) const
{
  if (!has(code)) return 0.0;
  const Wall &here = walls[wall_of(static_cast<int>(code))];
  const auto same = std::find_if(there.walls.begin(), there.walls.end(),
                                 [&](const Wall &other) { return other.id == here.id; });
  if (same == there.walls.end()) return 0.0;
  int feature = wall_feature_of(static_cast<int>(code));
  const bool is_only = here.count() == 1 && same->count() == 1;
  if (!here.features.empty() && !same->features.empty() && !is_only) {
    const auto [name, number] = numbered(here.features, feature);
    int before = 0;
    feature = -1;
    for (const Scene::Features &some : same->features) {
      if (some.name == name && number >= some.first && number < some.first + some.count)
        feature = before + number - some.first;
      before += some.count;
    }
    if (feature < 0) return 0.0;
  }
  const double found = wall_code(static_cast<int>(same - there.walls.begin()), feature);
  return there.has(found) ? found : 0.0;
}

std::string WallNames::name_of(double code) const
{
  if (!has(code)) return fmt::format("{:g}", code);
  const Wall &wall = walls[wall_of(static_cast<int>(code))];
  if (wall.count() < 2) return "fix " + wall.id;
  const auto [name, number] = numbered(wall.features, wall_feature_of(static_cast<int>(code)));
  return fmt::format("'{}, surface {}' of fix {}", name, number, wall.id);
}

// Features of a wall: its name, and "surface 3" or "surfaces 3 to 8".
std::string WallNames::text() const
{
  std::string text = "\n";
  for (const Wall &wall : walls) {
    text += wall.id;
    for (const auto &[name, first, count] : wall.features)
      text += count == 1 ? fmt::format("\t{}, surface {}", name, first)
                         : fmt::format("\t{}, surfaces {} to {}", name, first, first + count - 1);
    text += '\n';
  }
  return text;
}

static Scene::Features features_in(const std::string &text)
{
  const std::size_t end = text.rfind(", surface");
  int first = 0, last = 0;
  if (end == std::string::npos) return {text, 1, 1};
  if (std::sscanf(text.c_str() + end, ", surfaces %d to %d", &first, &last) == 2)
    return {text.substr(0, end), first, last - first + 1};
  std::sscanf(text.c_str() + end, ", surface %d", &first);
  return {text.substr(0, end), first, 1};
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
    for (std::string some; std::getline(words, some, '\t');)
      wall.features.push_back(features_in(some));
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
