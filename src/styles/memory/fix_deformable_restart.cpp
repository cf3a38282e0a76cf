#include "styles/memory/fix_deformable_restart.h"

#include "styles/friction/fix_deformable_friction.h"
#include "styles/pair/pair_deformable.h"
#include "styles/walls/fix_deformable_wall.h"

#include "comm.h"
#include "error.h"
#include "group.h"
#include "modify.h"

#include <cstdio>
#include <cstdlib>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

using namespace LAMMPS_NS;
using namespace deformable;

FixDeformableRestart::FixDeformableRestart(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  if (narg != 3) error->all(FLERR, "Fix deformable/restart has no arguments");
  delete[] style;
  style = utils::strdup(STYLE);
  restart_global = nevery = 1;
}

// Numbers may be written in several ways.
static std::string plain(const std::string &words)
{
  std::vector<std::string> all = utils::split_words(words);
  for (std::string &word : all)
    if (utils::is_double(word)) word = fmt::format("{}", std::atof(word.c_str()));
  return utils::join_words(all, " ");
}

FixDeformableRestart::Words FixDeformableRestart::now() const
{
  Words words;
  for (const PairDeformable *pair : deformable_pairs(*force))
    for (const auto &entry : pair->description()) words.insert(entry);
  const auto add = [&](const Fix *fix, const char *name, const std::string &arguments) {
    words[fmt::format("fix {} {} {}", fix->id, group->names[fix->igroup], name)] = plain(arguments);
  };
  for (const Fix *fix : modify->get_fix_by_style(FixDeformableFriction::STYLE))
    add(fix, "deformable/friction", static_cast<const FixDeformableFriction *>(fix)->words);
  for (const Fix *fix : modify->get_fix_by_style(FixDeformableWall::STYLE))
    add(fix, "deformable/wall", static_cast<const FixDeformableWall *>(fix)->words);
  return words;
}

void FixDeformableRestart::end_of_step()
{
  for (const PairDeformable *pair : pairs) pair->check_state();
}

void FixDeformableRestart::init()
{
  pairs = deformable_pairs(*force);
  if (then.empty()) return;
  Words before = std::exchange(then, {}), here = now();
  std::set<std::string> names;
  for (const Words *const words : {&before, &here})
    for (const auto &entry : *words) names.insert(entry.first);
  std::string differences;
  const auto shown = [](const std::string &words) { return words.empty() ? "none" : words; };
  for (const std::string &name : names)
    if (before[name] != here[name])
      differences += fmt::format("{}{} was '{}', is '{}'", differences.empty() ? "" : "; ", name,
                                 shown(before[name]), shown(here[name]));
  if (!differences.empty() && comm->me == 0)
    error->warning(FLERR, "The restart file is of another problem: {}", differences);
}

void FixDeformableRestart::write_restart(FILE *file)
{
  if (comm->me != 0) return;
  std::string text;
  for (const auto &[name, words] : now()) text += name + '\n' + words + '\n';
  const int bytes = static_cast<int>(text.size()) + 1;
  std::fwrite(&bytes, sizeof bytes, 1, file);
  std::fwrite(text.c_str(), 1, text.size() + 1, file);
}

void FixDeformableRestart::restart(char *buffer)
{
  std::istringstream lines(buffer);
  for (std::string name, words; std::getline(lines, name) && std::getline(lines, words);)
    then[name] = words;
}
