# The sources and how they are compiled, for the plugin, for Python, and for a LAMMPS that has the styles built in.
# DEFORMABLE_POTENTIALS: folders with species files, between colons, besides `potentials` beside the library.

get_filename_component(DEFORMABLE_DIR ${CMAKE_CURRENT_LIST_DIR} DIRECTORY)
file(STRINGS ${DEFORMABLE_DIR}/pyproject.toml DEFORMABLE_VERSION REGEX "^version = ")
string(REGEX REPLACE ".*\"(.*)\".*" "\\1" DEFORMABLE_VERSION "${DEFORMABLE_VERSION}")
option(DEFORMABLE_WERROR "Treat warnings in our own code as errors" OFF)
option(DEFORMABLE_NATIVE "Compile for this machine's processor only" OFF)

add_library(deformable_core INTERFACE)
target_include_directories(deformable_core INTERFACE ${DEFORMABLE_DIR}/src/core)
# Strict warnings are for tests: containers check their indices too.
target_compile_definitions(deformable_core
                           INTERFACE $<$<BOOL:${DEFORMABLE_WERROR}>:_GLIBCXX_ASSERTIONS>)
# Square roots become vector instructions only without errno and floating-point traps, which are not used. Products and
# sums are not contracted: all processors compute the same bits. Wide vectors never cross a call, so that their ABI does
# not matter.
target_compile_options(
  deformable_core INTERFACE -Wall -Wextra -Wsuggest-override -fno-math-errno -fno-trapping-math
                            -ffp-contract=off -Wno-psabi
                            $<$<BOOL:${DEFORMABLE_WERROR}>:-Werror>
                            $<$<BOOL:${DEFORMABLE_NATIVE}>:-march=native>)

# The contact laws for batches of particles, for each level of SIMD instructions.
file(GLOB BATCH_SOURCES CONFIGURE_DEPENDS ${DEFORMABLE_DIR}/src/batches/*.cpp)
list(FILTER BATCH_SOURCES EXCLUDE REGEX "/avx[0-9]+\\.cpp$")
include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-march=x86-64-v4 DEFORMABLE_KNOWS_X86_LEVELS)
if(DEFORMABLE_KNOWS_X86_LEVELS)
  list(APPEND BATCH_SOURCES ${DEFORMABLE_DIR}/src/batches/avx2.cpp
       ${DEFORMABLE_DIR}/src/batches/avx512.cpp)
  set_source_files_properties(${DEFORMABLE_DIR}/src/batches/avx2.cpp PROPERTIES COMPILE_OPTIONS
                                                                             -march=x86-64-v3)
  set_source_files_properties(
    ${DEFORMABLE_DIR}/src/batches/avx512.cpp
    PROPERTIES COMPILE_OPTIONS "-march=x86-64-v4;-mprefer-vector-width=512")
  set_source_files_properties(${DEFORMABLE_DIR}/src/batches/levels.cpp
                              PROPERTIES COMPILE_DEFINITIONS DEFORMABLE_X86_LEVELS)
endif()
add_library(deformable_batches OBJECT ${BATCH_SOURCES})
set_target_properties(deformable_batches PROPERTIES POSITION_INDEPENDENT_CODE ON)
target_link_libraries(deformable_batches PUBLIC deformable_core)

# The LAMMPS styles, and what only the plugin needs.
file(GLOB STYLE_SOURCES CONFIGURE_DEPENDS ${DEFORMABLE_DIR}/src/lammps/*.cpp)
set(PLUGIN_SOURCES ${DEFORMABLE_DIR}/src/lammps/host_check.cpp
                   ${DEFORMABLE_DIR}/src/lammps/plugin.cpp)
list(REMOVE_ITEM STYLE_SOURCES ${PLUGIN_SOURCES})
set_source_files_properties(
  ${DEFORMABLE_DIR}/src/lammps/species.cpp
  PROPERTIES COMPILE_DEFINITIONS "DEFORMABLE_POTENTIALS=\"${DEFORMABLE_POTENTIALS}\"")
