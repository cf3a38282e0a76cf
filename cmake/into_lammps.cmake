# Compiles the styles into LAMMPS itself. In a build folder of LAMMPS, which needs no change:
#
#   cmake -D CMAKE_PROJECT_lammps_INCLUDE=<this file> ../cmake
#
# or `include(<this file>)` as the last line of LAMMPS' own cmake/CMakeLists.txt.

# CMake reads a file of CMAKE_PROJECT_lammps_INCLUDE first: come back where all of LAMMPS is known.
if(NOT TARGET lammps)
  set(DEFORMABLE_INTO_LAMMPS ${CMAKE_CURRENT_LIST_FILE})
  cmake_language(DEFER CALL include "${DEFORMABLE_INTO_LAMMPS}")
  return()
endif()

include(${CMAKE_CURRENT_LIST_DIR}/release.cmake)
release_of_header(${LAMMPS_SOURCE_DIR}/version.h LAMMPS_RELEASE)
get_filename_component(DEFORMABLE_DIR ${CMAKE_CURRENT_LIST_DIR} DIRECTORY)
# after the installation, and before it
set(DEFORMABLE_POTENTIALS
    "${CMAKE_INSTALL_FULL_DATADIR}/lammps/potentials:${DEFORMABLE_DIR}/potentials")
include(${CMAKE_CURRENT_LIST_DIR}/sources.cmake)
message(STATUS "lammps-deformable ${DEFORMABLE_VERSION} becomes a part of LAMMPS ${LAMMPS_RELEASE}")

# An object library, so that our warnings and options do not become those of LAMMPS.
add_library(deformable_styles OBJECT ${STYLE_SOURCES})
set_target_properties(deformable_styles PROPERTIES POSITION_INDEPENDENT_CODE ON)
target_link_libraries(deformable_styles PRIVATE deformable_core)
target_include_directories(deformable_styles SYSTEM
                           PRIVATE $<TARGET_PROPERTY:lammps,INCLUDE_DIRECTORIES>)
target_compile_definitions(
  deformable_styles PRIVATE $<TARGET_PROPERTY:lammps,COMPILE_DEFINITIONS>
                            DEFORMABLE_LAMMPS_RELEASE=${LAMMPS_RELEASE})
target_sources(lammps PRIVATE $<TARGET_OBJECTS:deformable_styles> ${SHARED_OBJECTS})

# LAMMPS' lists of styles include our headers.
target_include_directories(lammps PRIVATE ${STYLE_FOLDERS} ${DEFORMABLE_DIR}/src)
foreach(folder IN LISTS STYLE_FOLDERS)
  RegisterStyles(${folder})
endforeach()
GenerateStyleHeaders(${LAMMPS_STYLE_HEADERS_DIR})

install(DIRECTORY ${DEFORMABLE_DIR}/potentials/
        DESTINATION ${CMAKE_INSTALL_DATADIR}/lammps/potentials)
