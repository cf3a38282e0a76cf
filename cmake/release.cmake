# Dates of LAMMPS releases as numbers, which compare: 20250722 is 22Jul2025.

# From LAMMPS' version.h: #define LAMMPS_VERSION "22 Jul 2025"
function(release_of_header header result)
  file(STRINGS ${header} line REGEX "define LAMMPS_VERSION")
  if(NOT line MATCHES "\"([0-9]+) ([A-Z][a-z][a-z]) ([0-9]+)\"")
    message(FATAL_ERROR "${header} names no release of LAMMPS: ${line}")
  endif()
  set(day ${CMAKE_MATCH_1})
  set(year ${CMAKE_MATCH_3})
  set(months x Jan Feb Mar Apr May Jun Jul Aug Sep Oct Nov Dec)
  list(FIND months ${CMAKE_MATCH_2} month)
  math(EXPR date "${year} * 10000 + ${month} * 100 + ${day}")
  set(${result} ${date} PARENT_SCOPE)
endfunction()

# From a version with dots, 2025.7.22.4, or without, 20250722.
function(release_of_version version result)
  if(version MATCHES "^([0-9]+)\\.([0-9]+)\\.([0-9]+)")
    math(EXPR version "${CMAKE_MATCH_1} * 10000 + ${CMAKE_MATCH_2} * 100 + ${CMAKE_MATCH_3}")
  endif()
  set(${result} ${version} PARENT_SCOPE)
endfunction()
