// Whether the plugin fits the LAMMPS that loads it.

#ifndef DEFORMABLE_HOST_CHECK_H
#define DEFORMABLE_HOST_CHECK_H

#include <string>

// The layout of LAMMPS' classes changes between releases, and between the updates of one. A style that was compiled for
// another LAMMPS would crash without a message. Empty where host and plugin agree, else one line that says what to do.
std::string unfit_host(void *lmp);

#endif
