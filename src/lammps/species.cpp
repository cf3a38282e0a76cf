#include "species.h"

#include "comm.h"
#include "error.h"
#include "lammps.h"
#include "pointers.h"
#include "utils.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

using namespace LAMMPS_NS;

namespace {

// `inf` is a number here; what is none becomes a nan.
double number_of(const std::string &word)
{
  char *end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  return *end == '\0' ? value : std::nan("");
}

std::string read_text(LAMMPS *lmp, const std::string &file)
{
  std::string text;
  int size = -1;
  if (lmp->comm->me == 0) {
    if (FILE *fp = utils::open_potential(file, lmp, nullptr)) {
      char buffer[4096];
      while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, fp)) text.append(buffer, n);
      std::fclose(fp);
      size = static_cast<int>(text.size());
    }
  }
  MPI_Bcast(&size, 1, MPI_INT, 0, lmp->world);
  if (size < 0)
    lmp->error->all(FLERR, "Cannot open the species file '{}': {}", file, utils::getsyserror());
  text.resize(size);
  MPI_Bcast(&text[0], size, MPI_CHAR, 0, lmp->world);
  return text;
}

}    // namespace

std::vector<Species> LAMMPS_NS::read_species(LAMMPS *lmp, const std::string &file)
{
  const std::string text = read_text(lmp, file);
  Error *error = lmp->error;
  std::vector<Species> all;

  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
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
          file, number, words.size(), utils::trim(line));
    const char *const names[] = {"radius", "kA", "kP"};
    double values[3];
    for (int k = 0; k < 3; ++k) {
      values[k] = number_of(words[k + 1]);
      if (!(values[k] > 0.0))
        error->all(FLERR,
                   "Species file '{}', line {}: {} of species {} is '{}': it must be a positive "
                   "number{}",
                   file, number, names[k], words[0], words[k + 1], k ? " or inf" : "");
    }
    if (std::isinf(values[0]))
      error->all(FLERR, "Species file '{}', line {}: the radius of species {} must be finite", file,
                 number, words[0]);
    if (std::isinf(values[1]) && std::isinf(values[2]))
      error->all(FLERR,
                 "Species file '{}', line {}: kA and kP of species {} are both inf, which leaves "
                 "a rigid disk: give one of them a finite value",
                 file, number, words[0]);
    const double skin = words.size() == 5 ? number_of(words[4]) : 0.0;
    if (!(skin >= 0.0 && skin < values[0]))
      error->all(FLERR,
                 "Species file '{}', line {}: skin of species {} is '{}': it must be zero or a "
                 "positive number below its radius {}",
                 file, number, words[0], words[4], words[1]);
    for (const Species &other : all)
      if (other.name == words[0])
        error->all(FLERR, "Species file '{}', line {}: species {} is defined twice", file, number,
                   words[0]);
    all.push_back({words[0], values[0], {values[1], values[2]}, skin});
  }
  if (all.empty()) error->all(FLERR, "Species file '{}' defines no species", file);
  return all;
}
