# The sources and how they are compiled, for the plugin, for Python, and for a LAMMPS that has the styles built in.
# DEFORMABLE_POTENTIALS: folders with species files, between colons, besides `potentials` beside the library.

get_filename_component(DEFORMABLE_DIR ${CMAKE_CURRENT_LIST_DIR} DIRECTORY)
file(STRINGS ${DEFORMABLE_DIR}/pyproject.toml DEFORMABLE_VERSION REGEX "^version = ")
string(REGEX REPLACE ".*\"(.*)\".*" "\\1" DEFORMABLE_VERSION "${DEFORMABLE_VERSION}")
option(DEFORMABLE_WERROR "Treat warnings in our own code as errors" OFF)
# What goes to other machines has all levels; a clone that pip compiles is for this machine.
set(levels all)
if(BY_PIP AND EXISTS ${DEFORMABLE_DIR}/.git)
  set(levels native)
endif()
set(DEFORMABLE_SIMD_LEVELS ${levels} CACHE STRING "SIMD instructions: native, of this processor, or all")

add_library(deformable_core INTERFACE)
target_include_directories(deformable_core INTERFACE ${DEFORMABLE_DIR}/src)
# Strict warnings are for tests: containers check their indices too.
target_compile_definitions(deformable_core
                           INTERFACE $<$<BOOL:${DEFORMABLE_WERROR}>:_GLIBCXX_ASSERTIONS>)
# Square roots become vector instructions only without errno and floating-point traps, which are not used. Products and
# sums are not contracted: all processors compute the same bits. Wide vectors never cross a call, so that their ABI does
# not matter.
target_compile_options(
  deformable_core INTERFACE -Wall -Wextra -Wsuggest-override -fno-math-errno -fno-trapping-math
                            -ffp-contract=off -Wno-psabi
                            $<$<BOOL:${DEFORMABLE_WERROR}>:-Werror>)

# What the plugin and Python share.
file(GLOB GEOMETRY_SOURCES CONFIGURE_DEPENDS ${DEFORMABLE_DIR}/src/geometry/*.cpp)
add_library(deformable_shared OBJECT ${GEOMETRY_SOURCES} ${DEFORMABLE_DIR}/src/kernels/levels.cpp
                                     ${DEFORMABLE_DIR}/src/kernels/spring_matrix.cpp)
target_link_libraries(deformable_shared PRIVATE deformable_core)
set_target_properties(deformable_shared PROPERTIES POSITION_INDEPENDENT_CODE ON)
set(SHARED_OBJECTS $<TARGET_OBJECTS:deformable_shared>)

# The contact laws for batches of particles, once for each level of SIMD instructions. -O3 makes them no faster, -O1 slower by
# half; the passes that are left out take a quarter of the compiler's time and make them no faster either.
set(KERNEL_OPTIONS -O2)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  list(APPEND KERNEL_OPTIONS -fno-tree-pre -fno-gcse -fno-tree-vrp)
endif()
function(add_level level lanes)
  set(library deformable_batches_${level})
  add_library(${library} OBJECT ${DEFORMABLE_DIR}/src/kernels/droplets.cpp
                                ${DEFORMABLE_DIR}/src/kernels/forces.cpp
                                ${DEFORMABLE_DIR}/src/kernels/fronts.cpp
                                ${DEFORMABLE_DIR}/src/kernels/rings.cpp)
  target_link_libraries(${library} PRIVATE deformable_core)
  target_compile_definitions(${library} PRIVATE DEFORMABLE_LEVEL=${level} DEFORMABLE_LANES=${lanes})
  target_compile_options(${library} PRIVATE ${KERNEL_OPTIONS} ${ARGN})
  set_target_properties(${library} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  set(SHARED_OBJECTS ${SHARED_OBJECTS} $<TARGET_OBJECTS:${library}> PARENT_SCOPE)
endfunction()
set(LEVELS plain)
include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-march=x86-64-v4 DEFORMABLE_KNOWS_X86_LEVELS)
if(DEFORMABLE_KNOWS_X86_LEVELS)
  set(LEVELS avx512 avx2 plain)
endif()
if(DEFORMABLE_SIMD_LEVELS STREQUAL native)
  unset(DEFORMABLE_LEVEL_STATUS CACHE) # or CMake would not run it again
  try_run(DEFORMABLE_LEVEL_STATUS DEFORMABLE_LEVEL_COMPILED ${CMAKE_BINARY_DIR}/processor_level
          ${DEFORMABLE_DIR}/cmake/processor_level.cpp RUN_OUTPUT_VARIABLE DEFORMABLE_LEVEL)
  if(DEFORMABLE_LEVEL IN_LIST LEVELS)
    set(LEVELS ${DEFORMABLE_LEVEL})
  endif()
elseif(NOT DEFORMABLE_SIMD_LEVELS STREQUAL all)
  message(FATAL_ERROR "DEFORMABLE_SIMD_LEVELS=${DEFORMABLE_SIMD_LEVELS}: it is native or all")
endif()
message(STATUS "SIMD instructions: ${LEVELS}")
if(avx512 IN_LIST LEVELS)
  add_level(avx512 8 -march=x86-64-v4 -mprefer-vector-width=512)
endif()
if(avx2 IN_LIST LEVELS)
  add_level(avx2 4 -march=x86-64-v3)
endif()
if(plain IN_LIST LEVELS)
  add_level(plain 2)
endif()
string(REGEX REPLACE "([^;]+);?" "LEVEL(\\1)" LEVELS "${LEVELS}")
target_compile_definitions(deformable_shared PRIVATE "DEFORMABLE_LEVELS=${LEVELS}")

# The LAMMPS styles, and what only the plugin needs.
set(STYLE_FOLDERS ${DEFORMABLE_DIR}/src/styles/pair ${DEFORMABLE_DIR}/src/polygons
                  ${DEFORMABLE_DIR}/src/styles/walls ${DEFORMABLE_DIR}/src/styles/motion
                  ${DEFORMABLE_DIR}/src/styles/friction ${DEFORMABLE_DIR}/src/styles/memory
                  ${DEFORMABLE_DIR}/src/styles/minimize)
file(GLOB STYLE_SOURCES CONFIGURE_DEPENDS
     ${DEFORMABLE_DIR}/src/solver/*.cpp ${DEFORMABLE_DIR}/src/styles/*.cpp
     ${DEFORMABLE_DIR}/src/styles/*/*.cpp ${DEFORMABLE_DIR}/src/polygons/*.cpp)
set(PLUGIN_SOURCES ${DEFORMABLE_DIR}/src/styles/plugin.cpp)
list(REMOVE_ITEM STYLE_SOURCES ${PLUGIN_SOURCES})
set_source_files_properties(
  ${DEFORMABLE_DIR}/src/styles/species.cpp
  PROPERTIES COMPILE_DEFINITIONS "DEFORMABLE_POTENTIALS=\"${DEFORMABLE_POTENTIALS}\"")
