#include "styles/walls/wall_variable.h"

#include "info.h"
#include "input.h"
#include "lammps.h"
#include "utils.h"
#include "variable.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>

using namespace LAMMPS_NS;

namespace {

// Thermo keywords, functions and vectors that need forces, energies or temperatures.
const char *const STATE[] = {
    "temp",    "press",     "pe",     "ke",   "etotal", "evdwl", "ecoul", "epair",
    "ebond",   "eangle",    "edihed", "eimp", "emol",   "elong", "etail", "enthalpy",
    "ecouple", "econserve", "pxx",    "pyy",  "pzz",    "pxy",   "pxz",   "pyz",
    "fmax",    "fnorm",     "fx",     "fy",   "fz",     "fcm",   "torque"};

// Whether a variable, or one that it names, uses any of them, a compute or a fix.
bool uses_state(const std::string &name, LAMMPS *lmp, std::set<std::string> &seen)
{
  const int found = lmp->input->variable->find(name.c_str());
  if (found < 0 || !seen.insert(name).second) return false;
  const std::string text = Info(lmp).get_variable_info(found);
  const auto in_word = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
  auto at = text.begin() + static_cast<std::ptrdiff_t>(std::min(text.find("def ="), text.size()));
  while (at != text.end()) {
    const auto end = std::find_if_not(at, text.end(), in_word);
    const std::string word(at, end), kind = word.substr(0, 2);
    if (kind == "c_" || kind == "C_" || kind == "f_" || kind == "F_" ||
        std::find(std::begin(STATE), std::end(STATE), word) != std::end(STATE))
      return true;
    if (kind == "v_" && uses_state(word.substr(2), lmp, seen)) return true;
    at = std::find_if(end, text.end(), in_word);
  }
  return false;
}

}    // namespace

/* ---------------------------------------------------------------------- */

std::string WallVariable::read(const std::string &its_name, const std::string &word, LAMMPS *lmp)
{
  what = its_name;
  if (utils::strmatch(word, "^v_.")) {
    name = word.substr(2);
    return init(lmp);
  }
  now = utils::numeric(FLERR, word, false, lmp);
  return is_known() ? "" : what + ": '" + word + "' is not finite";
}

std::string WallVariable::init(LAMMPS *lmp)
{
  if (!varies()) return "";
  Variable &variables = *lmp->input->variable;
  const int found = variables.find(name.c_str());
  if (found < 0) return what + ": variable '" + name + "' does not exist";
  if (!variables.equalstyle(found)) return what + ": variable '" + name + "' must be equal-style";
  std::set<std::string> seen;
  of_state = uses_state(name, lmp, seen);
  return "";
}

std::string WallVariable::evaluate(LAMMPS *lmp, double &value) const
{
  Variable &variables = *lmp->input->variable;
  const int found = variables.find(name.c_str());
  if (found < 0) return what + ": variable '" + name + "' does not exist";
  value = variables.compute_equal(found);
  return std::isfinite(value) ? "" : fmt::format("{}: its value 'v_{}' is {}", what, name, value);
}

std::string WallVariable::begin_step(LAMMPS *lmp, bool goes_on)
{
  if (!varies()) return "";
  if (!of_state) return evaluate(lmp, now);
  if (goes_on || !is_known()) now = next;
  return "";
}

std::string WallVariable::end_step(LAMMPS *lmp)
{
  return of_state ? evaluate(lmp, next) : "";
}
