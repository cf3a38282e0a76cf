#include "solver/tuning.h"

#include <cstdlib>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

namespace deformable {

// Throws std::invalid_argument.
Tuning Tuning::changed_by(const std::string &given) const
{
  Tuning t = *this;
  const std::map<std::string, double *> members = {{"margin", &t.margin},
                                                   {"column", &t.column},
                                                   {"cubic", &t.cubic},
                                                   {"smooth", &t.smooth},
                                                   {"planned", &t.planned},
                                                   {"relaxed", &t.relaxed},
                                                   {"relaxed_part", &t.relaxed_part},
                                                   {"relaxed_to", &t.relaxed_to},
                                                   {"crowd", &t.crowd},
                                                   {"of_ring", &t.of_ring},
                                                   {"coarse", &t.coarse},
                                                   {"of_tolerance", &t.of_tolerance},
                                                   {"of_square", &t.of_square},
                                                   {"of_lines", &t.of_lines},
                                                   {"of_answers", &t.of_answers},
                                                   {"of_films", &t.of_films},
                                                   {"small_step", &t.small_step},
                                                   {"chebyshev", &t.chebyshev},
                                                   {"spectrum", &t.spectrum},
                                                   {"close", &t.close},
                                                   {"threads", &t.threads},
                                                   {"astray", &t.astray},
                                                   {"stuck", &t.stuck}};
  std::istringstream words(given);
  for (std::string word; words >> word;) {
    const std::size_t at = word.find('=');
    const auto member = members.find(word.substr(0, at));
    char *end = nullptr;
    const double value = at < word.size() ? std::strtod(word.c_str() + at + 1, &end) : 0.0;
    if (member == members.end() || !end || end == word.c_str() + at + 1 || *end != 0)
      throw std::invalid_argument("DEFORMABLE_TUNING: '" + word +
                                  "' is no name=number of src/solver/tuning.h");
    *member->second = value;
  }
  return t;
}

}    // namespace deformable
