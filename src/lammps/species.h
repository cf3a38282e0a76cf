// The species of a parameter file: one line each, `name radius kA kP [skin]`.

#ifndef DEFORMABLE_SPECIES_H
#define DEFORMABLE_SPECIES_H

#include "stiffness.h"

#include <string>
#include <vector>

namespace LAMMPS_NS {

class LAMMPS;

struct Species {
  std::string name;
  double radius;
  deformable::Stiffness stiffness;
  double skin;    // thickness of the rigid shell around the ring
};

// Reads the file on rank 0 and hands it to all ranks; stops with LAMMPS' error on all of them where the
// file is missing or malformed.
std::vector<Species> read_species(LAMMPS *lmp, const std::string &file);

// A text as error messages can show it: short, and of nothing but printable characters.
std::string shown(const std::string &text);

}    // namespace LAMMPS_NS

#endif
