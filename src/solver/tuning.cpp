#include "solver/tuning.h"

#include <cstdlib>
#include <map>
#include <sstream>

using namespace LAMMPS_NS;

// An unknown name, or a value that is no number, ends the program: this is for developers.
Tuning Tuning::changed_by_environment() const
{
  Tuning t = *this;
  const char *const given = std::getenv("DEFORMABLE_TUNING");
  if (!given) return t;
  const std::map<std::string, double *> members = {{"margin", &t.margin},
                                                   {"column", &t.column},
                                                   {"group", &t.group},
                                                   {"chunk", &t.chunk},
                                                   {"cubic", &t.cubic},
                                                   {"smooth", &t.smooth},
                                                   {"planned", &t.planned},
                                                   {"relaxed", &t.relaxed},
                                                   {"relaxed_to", &t.relaxed_to},
                                                   {"crowd", &t.crowd},
                                                   {"of_ring", &t.of_ring},
                                                   {"coarse", &t.coarse},
                                                   {"of_tolerance", &t.of_tolerance},
                                                   {"of_square", &t.of_square},
                                                   {"of_lines", &t.of_lines},
                                                   {"few", &t.few},
                                                   {"small_step", &t.small_step},
                                                   {"chebyshev", &t.chebyshev},
                                                   {"spectrum", &t.spectrum},
                                                   {"close", &t.close},
                                                   {"stuck", &t.stuck}};
  std::istringstream words(given);
  for (std::string word; words >> word;) {
    const std::size_t at = word.find('=');
    *members.at(word.substr(0, at)) = std::stod(word.substr(at + 1));
  }
  return t;
}
