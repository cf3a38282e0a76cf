// The species of a parameter file: one line each, `name radius kA kP [skin] [keyword value ...]` with the keywords
// tension and skin.

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

// Reads the file on rank 0 and sends it to all ranks. Stops with LAMMPS' error on all of them if the file is missing
// or invalid.
std::vector<Species> read_species(LAMMPS *lmp, const std::string &file);

// The problem of a species in a phrase that names its value, empty if there is none.
std::string invalid_values(const Species &);

// A text for error messages: shortened, with printable characters only.
std::string shown(const std::string &text);

}    // namespace LAMMPS_NS

#endif
