// Devices of the solver that can be left out to measure what they buy: the environment variable DEFORMABLE_WITHOUT has their
// names, between commas. It is read when a pair style is defined.

#ifndef LMP_DEVICES_H
#define LMP_DEVICES_H

#include <cstdlib>
#include <set>
#include <string>

namespace LAMMPS_NS {

struct Devices {
  bool relax_before, relax_after, local, cubic, kink, kolafa, learned, quantile, in_blocks,
      lookahead, slack, one_run, adapt, groups, columns, margin, part, crowd, bounds, first_step;
  void read()
  {
    const char *const words = std::getenv("DEFORMABLE_WITHOUT");
    const std::string all = std::string(",") + (words ? words : "") + ",";
    const auto has = [&](const char *name) {
      return all.find(std::string(",") + name + ",") == std::string::npos;
    };
    relax_before = has("relax_before");
    relax_after = has("relax_after");
    local = has("local");
    cubic = has("cubic");
    kink = has("kink");
    kolafa = has("kolafa");
    learned = has("learned");
    quantile = has("quantile");
    in_blocks = has("in_blocks");
    lookahead = has("lookahead");
    slack = has("slack");
    one_run = has("one_run");
    adapt = has("adapt");
    groups = has("groups");
    columns = has("columns");
    margin = has("margin");
    part = has("part");
    crowd = has("crowd");
    bounds = has("bounds");
    first_step = has("first_step");
  }
};

inline Devices devices;

}    // namespace LAMMPS_NS

#endif
