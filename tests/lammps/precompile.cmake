# For CMAKE_PROJECT_INCLUDE of a LAMMPS that is compiled for the tests only: most of the time goes into its headers.

if(PROJECT_NAME STREQUAL lammps)
  set(PRECOMPILED pointers.h atom.h comm.h compute.h domain.h error.h fix.h force.h group.h memory.h
                  modify.h neigh_list.h neighbor.h pair.h update.h variable.h)
  list(TRANSFORM PRECOMPILED PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/../src/)
  list(APPEND PRECOMPILED <algorithm> <cmath> <cstring> <map>)
  cmake_language(DEFER CALL target_precompile_headers lammps PRIVATE "${PRECOMPILED}")
endif()
