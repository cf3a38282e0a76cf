#include "styles/species.h"

#include "laws/parameter_rules.h"
#include "styles/all_ranks.h"

#include "comm.h"
#include "error.h"
#include "lammps.h"
#include "platform.h"
#include "pointers.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <limits>
#include <set>

namespace deformable {

namespace {

// `inf` is a number; any other word that is not a finite number becomes nan.
double number_of(const std::string &word)
{
  using Limits = std::numeric_limits<double>;
  const std::string lower = utils::lowercase(word);
  if (lower == "inf" || lower == "+inf") return Limits::infinity();
  const double value = utils::is_double(word) ? std::strtod(word.c_str(), nullptr) : HUGE_VAL;
  return std::isfinite(value) ? value : Limits::quiet_NaN();
}

// Folders of the species files of the package: `potentials` beside the library that this code is in, and those that
// CMake knows where it is compiled for a LAMMPS of one's own, between colons.
std::vector<std::string> shipped_folders()
{
  std::vector<std::string> folders;
  Dl_info library;
  if (dladdr(reinterpret_cast<void *>(&read_species), &library) != 0) {
    const std::string path = library.dli_fname;
    const std::size_t end = path.rfind('/');
    if (end != std::string::npos) folders.push_back(path.substr(0, end) + "/potentials");
  }
  const std::string known = DEFORMABLE_POTENTIALS;
  for (std::size_t begin = 0; begin < known.size();) {
    const std::size_t end = std::min(known.find(':', begin), known.size());
    folders.push_back(known.substr(begin, end - begin));
    begin = end + 1;
  }
  return folders;
}

// The file of this name that comes with the package; empty if there is none, and for a name with a folder, which says
// where the file is.
std::string shipped_file(const std::string &name)
{
  if (name.find('/') == std::string::npos)
    for (const std::string &folder : shipped_folders())
      if (platform::file_is_readable(folder + "/" + name)) return folder + "/" + name;
  return "";
}

// The species files of the package, as the end of an error.
std::string shipped_names()
{
  std::set<std::string> names;
  for (const std::string &folder : shipped_folders())
    for (const std::string &name : platform::list_directory(folder))
      if (utils::strmatch(name, "\\.deformable$")) names.insert(name);
  std::string text;
  for (const std::string &name : names) text += (text.empty() ? ". The package has " : ", ") + name;
  return text;
}

std::string read_text(LAMMPS *lmp, const std::string &file)
{
  std::string path, text;
  bool shipped = false;
  if (lmp->comm->me == 0) {
    path = utils::get_potential_file_path(file);
    shipped = path.empty();
    if (shipped) path = shipped_file(file);
  }
  if (!read_file(lmp, path, text)) {
    const std::string reason = utils::getsyserror();
    lmp->error->all(FLERR, "Cannot open the species file '{}': {}{}", file, reason,
                    shipped_names());
  }
  if (shipped) utils::logmesg(lmp, "Species file {} comes with the package: {}\n", file, path);
  return text;
}

// The first line of a potential file names its units and date. (LAMMPS' own reader of that line does not mask
// characters that cannot be printed.)
void check_head(LAMMPS *lmp, const std::string &file, const std::string &head)
{
  const std::vector<std::string> words = utils::split_words(head);
  const auto after = [&words](const char *tag) {
    const auto found = std::find(words.begin(), words.end(), tag);
    return found == words.end() || found + 1 == words.end() ? "" : *(found + 1);
  };
  const std::string units = after("UNITS:"), date = after("DATE:");
  if (!units.empty() && units != lmp->update->unit_style)
    lmp->error->all(FLERR, "Species file '{}' is for units {}, but units {} are in use", file,
                    shown(units), lmp->update->unit_style);
  if (!date.empty() && lmp->comm->me == 0)
    utils::logmesg(lmp, "Reading species file {} with DATE: {}\n", file, shown(date));
}

// The number that a keyword of a line sets; null if the word is none.
double *number_of_keyword(const std::string &word, Species &s)
{
  if (word == "skin") return &s.skin;
  for (int n = FIRST_KEYWORD; n < MEMBERS; ++n) {
    const Parameter &p = PARAMETERS[n];
    if (p.name && word == p.name) return &(s.stiffness.*p.of_ring);
  }
  return nullptr;
}

bool is_keyword(const std::string &word)
{
  Species any = {};
  return number_of_keyword(word, any) != nullptr;
}

// After kP a number is the skin, and keywords with a value follow in any order. Returns the first word that should be
// a keyword but is none.
std::size_t misplaced_word(const std::vector<std::string> &words)
{
  std::size_t k = 4;
  if (words.size() > k && !is_keyword(words[k]) &&
      (words.size() == 5 || !std::isnan(number_of(words[k]))))
    ++k;
  while (k < words.size() && is_keyword(words[k])) k += 2;
  return k;
}

template <class ValueOf>
void read_options(Error *error, const std::string &of_species,
                  const std::vector<std::string> &words, ValueOf &&value_of, Species &found)
{
  std::vector<std::string> seen;
  const auto see = [&](const std::string &keyword) {
    if (std::find(seen.begin(), seen.end(), keyword) != seen.end())
      error->all(FLERR, of_species + keyword + " is given twice");
    seen.push_back(keyword);
  };
  std::size_t k = 4;
  if (k < words.size() && !is_keyword(words[k])) {
    found.skin = value_of("skin", words[k]);
    see("skin");
    ++k;
  }
  for (; k < words.size(); k += 2) {
    const std::string &keyword = words[k];
    if (k + 1 == words.size()) error->all(FLERR, of_species + keyword + " has no value");
    see(keyword);
    *number_of_keyword(keyword, found) = value_of(keyword.c_str(), words[k + 1]);
  }
}

double value_of(Error *error, const std::string &place, const std::string &what,
                const std::string &word)
{
  const double value = number_of(word);
  if (std::isnan(value))
    error->all(FLERR, place + what + " is '" + shown(word) + "', which is not a number");
  return value;
}

Species read_line(Error *error, const std::string &place, const std::vector<std::string> &words,
                  const std::string &line)
{
  const std::size_t odd = misplaced_word(words);
  if (words.size() < 4 || odd < words.size())
    error->all(FLERR,
               place + "expected 'name radius kA kP [skin] [tension value]', got " +
                   std::to_string(words.size()) + " words: '" + shown(line) + "'" +
                   (words.size() < 4 ? "" : ", where '" + shown(words[odd]) + "' is no keyword"));
  const std::string name = shown(words[0]), of_species = place + "species " + name + ": ";
  const auto value = [&](const std::string &what, const std::string &word) {
    return value_of(error, place, what + " of species " + name, word);
  };
  Species found = {words[0], value("radius", words[1]), {}, 0.0};
  for (int n = 0; n < FIRST_KEYWORD; ++n) {
    const Parameter &p = PARAMETERS[n];
    found.stiffness.*p.of_ring = value(p.name, words[2 + n]);
  }
  read_options(error, of_species, words, value, found);
  const std::string problem = invalid_values(found);
  // a number without its word is taken for the skin, where a tension may be meant
  const bool unnamed = words.size() == 5 && found.stiffness.kP == 0.0;
  if (!problem.empty())
    error->all(FLERR, of_species + problem +
                          (unnamed ? ": a fifth number is the skin, and a tension is written as "
                                     "'tension " +
                                         shown(words[4]) + "'"
                                   : ""));
  return found;
}

Adhesion read_adhesion(Error *error, const std::string &place,
                       const std::vector<std::string> &words, const std::string &line, int number)
{
  if (words.size() != 4)
    error->all(FLERR, place + "expected 'adhesion species species value', got " +
                          std::to_string(words.size()) + " words: '" + shown(line) +
                          "' (no species can be called adhesion)");
  return {words[1], words[2],
          value_of(error, place, "adhesion of " + shown(words[1]) + " and " + shown(words[2]),
                   words[3]),
          number};
}

// The problem of an adhesion among all lines of the file, in a phrase; empty if there is none.
std::string problem_of(const Adhesion &adhesion, const SpeciesFile &file)
{
  const Species *of[2] = {nullptr, nullptr};
  for (const Species &s : file.species) {
    if (s.name == adhesion.first) of[0] = &s;
    if (s.name == adhesion.second) of[1] = &s;
  }
  for (int side = 0; side < 2; ++side)
    if (!of[side])
      return "species " + shown(side == 0 ? adhesion.first : adhesion.second) +
             " is not defined in this file (and no species can be called adhesion)";
  for (const Adhesion &other : file.adhesions)
    if (other.line < adhesion.line && other.is_of(adhesion.first, adhesion.second))
      return "it is given twice, in line " + std::to_string(other.line) + " too";
  return invalid_adhesion(adhesion.energy, *of[0], *of[1]);
}

}    // namespace

std::vector<std::pair<std::string, double>> numbers_of(const Species &s)
{
  std::vector<std::pair<std::string, double>> numbers = {{"radius", s.radius}};
  for (int n = 0; n < MEMBERS; ++n) {
    const Parameter &p = PARAMETERS[n];
    if (n == FIRST_KEYWORD) numbers.emplace_back("skin", s.skin);
    if (p.name) numbers.emplace_back(p.name, s.stiffness.*p.of_ring);
  }
  return numbers;
}

std::string invalid_values(const Species &s)
{
  using namespace deformable;
  for (const std::string &problem :
       {invalid_radius(s.radius), invalid_stiffness(s.stiffness), invalid_skin(s.skin, s.radius)})
    if (!problem.empty()) return problem;
  return unstable_radius(s.radius - s.skin, s.stiffness);
}

std::string invalid_adhesion(double adhesion, const Species &a, const Species &b)
{
  using namespace deformable;
  const std::string invalid = invalid_adhesion(adhesion);
  if (!invalid.empty()) return invalid;
  for (const Species *s : {&a, &b}) {
    const std::string problem = invalid_for_adhesion(adhesion, s->stiffness, s->skin);
    if (!problem.empty()) return "species " + shown(s->name) + ": " + problem;
  }
  return "";
}

std::string shown(const std::string &text)
{
  constexpr std::size_t LONGEST = 80;
  std::string plain = text.size() > LONGEST ? text.substr(0, LONGEST) + "..." : text;
  for (char &c : plain)
    if (c < ' ' || c > '~') c = '?';
  return plain;
}

SpeciesFile read_species(LAMMPS *lmp, const std::string &file)
{
  const std::string text = read_text(lmp, file);
  Error *error = lmp->error;
  SpeciesFile found;

  if (text.find('\0') != std::string::npos)
    error->all(FLERR, "Species file '{}' is not plain text, it has zero bytes: save it as UTF-8",
               file);
  check_head(lmp, file, text.substr(0, text.find('\n')));
  const std::string byte_order_mark = "\xEF\xBB\xBF";    // some editors begin a text with it

  int number = 0;
  for (std::size_t begin = text.compare(0, 3, byte_order_mark) == 0 ? 3 : 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    line.resize(std::min(line.find('#'), line.size()));
    const std::vector<std::string> words = utils::split_words(line);
    if (words.empty()) continue;

    const std::string place = fmt::format("Species file '{}', line {}: ", file, number);
    const std::string plain = utils::trim(line);
    if (words[0] == "adhesion") {
      found.adhesions.push_back(read_adhesion(error, place, words, plain, number));
      continue;
    }
    found.species.push_back(read_line(error, place, words, plain));
    for (std::size_t k = 0; k + 1 < found.species.size(); ++k)
      if (found.species[k].name == words[0])
        error->all(FLERR, place + "species " + shown(words[0]) + " is defined twice");
  }
  if (found.species.empty()) error->all(FLERR, "Species file '{}' defines no species", file);
  for (const Adhesion &a : found.adhesions) {
    const std::string problem = problem_of(a, found);
    if (!problem.empty())
      error->all(FLERR, "Species file '{}', line {}: adhesion of {} and {}: {}", file, a.line,
                 shown(a.first), shown(a.second), problem);
  }
  return found;
}

double **SpeciesRamps::array_of(const char *name, const std::vector<Species> &species)
{
  for (std::size_t k = 0; k < arrays.size(); ++k) {
    if (!PARAMETERS[k].name || std::strcmp(name, PARAMETERS[k].name) != 0) continue;
    Array &a = arrays[k];
    const std::size_t types = species.size();
    a.values.resize(types * types);
    a.rows.resize(types);
    for (std::size_t i = 0; i < types; ++i) a.rows[i] = a.values.data() + i * types;
    fill(species);
    return a.rows.data();
  }
  return nullptr;
}

void SpeciesRamps::fill(const std::vector<Species> &species)
{
  for (std::size_t k = 0; k < arrays.size(); ++k)
    for (std::size_t i = 0; i < arrays[k].rows.size(); ++i)
      for (std::size_t j = 0; j < arrays[k].rows.size(); ++j)
        arrays[k].rows[i][j] = species[i].stiffness.*PARAMETERS[k].of_ring;
}

// Wildcards of fix adapt write the value of a type to its pairs with others too.
std::string SpeciesRamps::of_two_types(const std::vector<Species> &species) const
{
  for (std::size_t k = 0; k < arrays.size(); ++k) {
    const std::vector<double *> &rows = arrays[k].rows;
    for (std::size_t i = 1; i < rows.size(); ++i)
      for (std::size_t j = i + 1; j < rows.size(); ++j) {
        const double value = rows[i][j];
        if (value != species[i].stiffness.*PARAMETERS[k].of_ring && value != rows[i][i] &&
            value != rows[j][j])
          return fmt::format("{} of types {} and {}", PARAMETERS[k].name, i, j);
      }
  }
  return "";
}

bool SpeciesRamps::take(std::vector<Species> &species) const
{
  bool changed = false;
  for (std::size_t k = 0; k < arrays.size(); ++k)
    for (std::size_t i = 1; i < arrays[k].rows.size(); ++i) {
      if (species[i].name.empty()) continue;
      double &value = species[i].stiffness.*PARAMETERS[k].of_ring;
      changed |= value != arrays[k].rows[i][i];
      value = arrays[k].rows[i][i];
    }
  return changed;
}

/* ----------------------------------------------------------------------
   Adhesions
------------------------------------------------------------------------- */

void Adhesions::set(std::size_t i, std::size_t j, double adhesion)
{
  values[i * types + j] = values[j * types + i] = adhesion;
}

void Adhesions::update()
{
  adhesive = std::any_of(values.begin(), values.end(), [](double w) { return w != 0.0; });
  std::copy_n(values.begin(), written.size(), written.begin());
}

void Adhesions::assign(const std::vector<Species> &species, const std::vector<Adhesion> &known)
{
  types = species.size();
  values.assign(types * types, 0.0);
  for (std::size_t i = 1; i < types; ++i)
    for (std::size_t j = i; j < types; ++j)
      for (const Adhesion &a : known)
        if (a.is_of(species[i].name, species[j].name)) set(i, j, a.energy);
  update();
}

double **Adhesions::array()
{
  if (types == 0) return nullptr;
  written.resize(types * types);
  rows.resize(types);
  for (std::size_t i = 0; i < types; ++i) rows[i] = written.data() + i * types;
  update();
  return rows.data();
}

bool Adhesions::take()
{
  bool changed = false;
  for (std::size_t i = 1; i < rows.size(); ++i)
    for (std::size_t j = i; j < rows.size(); ++j) {
      if (rows[i][j] == between(i, j)) continue;
      set(i, j, rows[i][j]);
      changed = true;
    }
  if (changed) update();
  return changed;
}

std::string Adhesions::problem(const std::vector<Species> &species) const
{
  for (std::size_t i = 1; i < types; ++i)
    for (std::size_t j = i; j < types; ++j) {
      const std::string wrong = invalid_adhesion(between(i, j), species[i], species[j]);
      if (!wrong.empty()) return fmt::format("Types {} and {}: {}", i, j, wrong);
    }
  return "";
}

}    // namespace deformable
