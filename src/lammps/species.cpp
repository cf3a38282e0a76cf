#include "species.h"

#include "parameter_rules.h"

#include "comm.h"
#include "error.h"
#include "lammps.h"
#include "platform.h"
#include "pointers.h"
#include "update.h"
#include "utils.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <limits>

using namespace LAMMPS_NS;

namespace {

// `inf` is a number; any other word that is not a finite number becomes nan.
double number_of(const std::string &word)
{
  using Limits = std::numeric_limits<double>;
  if (word == "inf" || word == "+inf") return Limits::infinity();
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

std::string read_text(LAMMPS *lmp, const std::string &file)
{
  std::string text;
  int size = -1;
  if (lmp->comm->me == 0) {
    std::string path = utils::get_potential_file_path(file);
    const bool shipped = path.empty();
    if (shipped) path = shipped_file(file);
    errno = ENOENT;
    if (FILE *fp = path.empty() ? nullptr : std::fopen(path.c_str(), "rb")) {
      if (shipped) utils::logmesg(lmp, "Species file {} comes with the package: {}\n", file, path);
      char buffer[4096];
      while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, fp)) text.append(buffer, n);
      // fopen opens a folder too, which cannot be read
      if (!std::ferror(fp)) size = static_cast<int>(text.size());
      std::fclose(fp);
    }
  }
  MPI_Bcast(&size, 1, MPI_INT, 0, lmp->world);
  if (size < 0)
    lmp->error->all(FLERR, "Cannot open the species file '{}': {}", file, utils::getsyserror());
  text.resize(size);
  MPI_Bcast(&text[0], size, MPI_CHAR, 0, lmp->world);
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

}    // namespace

std::string LAMMPS_NS::shown(const std::string &text)
{
  constexpr std::size_t LONGEST = 80;
  std::string plain = text.size() > LONGEST ? text.substr(0, LONGEST) + "..." : text;
  for (char &c : plain)
    if (c < ' ' || c > '~') c = '?';
  return plain;
}

std::vector<Species> LAMMPS_NS::read_species(LAMMPS *lmp, const std::string &file)
{
  const std::string text = read_text(lmp, file);
  Error *error = lmp->error;
  std::vector<Species> all;

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

    if (words.size() != 4 && words.size() != 5)
      error->all(
          FLERR,
          "Species file '{}', line {}: expected 'name radius kA kP [skin]', got {} words: '{}'",
          file, number, words.size(), shown(utils::trim(line)));
    const std::string name = shown(words[0]);
    const char *const names[] = {"radius", "kA", "kP", "skin"};
    double values[4] = {0.0, 0.0, 0.0, 0.0};
    for (std::size_t k = 0; k + 1 < words.size(); ++k) {
      values[k] = number_of(words[k + 1]);
      if (std::isnan(values[k]))
        error->all(FLERR,
                   "Species file '{}', line {}: {} of species {} is '{}', which is not a number",
                   file, number, names[k], name, shown(words[k + 1]));
    }
    const auto [radius, kA, kP, skin] = values;
    for (const std::string &problem :
         {deformable::invalid_radius(radius), deformable::invalid_stiffness(kA, kP),
          deformable::invalid_skin(skin, radius)})
      if (!problem.empty())
        error->all(FLERR, "Species file '{}', line {}: species {}: {}", file, number, name,
                   problem);
    for (const Species &other : all)
      if (other.name == words[0])
        error->all(FLERR, "Species file '{}', line {}: species {} is defined twice", file, number,
                   name);
    all.push_back({words[0], radius, {kA, kP}, skin});
  }
  if (all.empty()) error->all(FLERR, "Species file '{}' defines no species", file);
  return all;
}
