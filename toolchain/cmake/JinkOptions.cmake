# SPDX-License-Identifier: BSD-3-Clause
# Compile options of every target.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
if(NOT CMAKE_SYSTEM_NAME STREQUAL "Generic")
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(JINK_CCACHE ccache)
# Not for images: it does not keep the call graphs that their stack is computed from (-fcallgraph-info).
if(JINK_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER AND NOT CMAKE_SYSTEM_NAME STREQUAL "Generic")
  # ccache caches precompiled headers only if it ignores their macros and times.
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_COMMAND}" -E env CCACHE_SLOPPINESS=pch_defines,time_macros "${JINK_CCACHE}")
  set(CMAKE_C_COMPILER_LAUNCHER "${JINK_CCACHE}")
endif()

# No contraction of a*b+c into one rounding: host and targets must agree (docs/architecture.md).
add_compile_options(-ffp-contract=off)
if(CMAKE_CROSSCOMPILING)
  add_compile_options(-g1)  # lines of code, for toolchain/report/timing; changes no instruction, and none of it is flashed
endif()
# All code must use the same capacities.
add_compile_definitions(${JINK_CAPACITIES})
if(JINK_SANITIZE)
  add_compile_options(-fsanitize=${JINK_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  # The vptr check compares type information, which code built without RTTI does not have.
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fno-sanitize=vptr>)
  # These three are expensive to build; flashed sources keep them (jink_embedded, below).
  set(JINK_COSTLY_CHECKS null,alignment,object-size)
  add_compile_options(-fno-sanitize=${JINK_COSTLY_CHECKS})
  add_link_options(-fsanitize=${JINK_SANITIZE})
endif()

# jink_warnings: for all code of the project, never exported.
add_library(jink_warnings INTERFACE)
target_compile_options(jink_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wdouble-promotion -Wshadow
  $<$<NOT:$<BOOL:${CMAKE_CROSSCOMPILING}>>:-Wformat-security>  # an error where Debian's packages are built
  $<$<BOOL:${JINK_WERROR}>:-Werror>)

# jink_embedded: rules of flashed code (no exceptions, no RTTI, no thread-safe statics).
add_library(jink_embedded INTERFACE)
target_compile_options(jink_embedded INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-fno-exceptions -fno-rtti -fno-threadsafe-statics>)
if(JINK_SANITIZE MATCHES "undefined")
  target_compile_options(jink_embedded INTERFACE -O1 -fsanitize=${JINK_COSTLY_CHECKS})
endif()

# Headers that nearly every source of core, link and app includes, half of its compile time: precompiled once per
# library. Changes no instruction. Each source still includes all that it needs: CMAKE_DISABLE_PRECOMPILE_HEADERS shows
# it (preset clang).
set(JINK_FLASHED_HEADERS <algorithm> <array> <cmath> <cstddef> <cstdint> <optional> <span> <Eigen/Core> <Eigen/Geometry>)
set(JINK_HOST_HEADERS ${JINK_FLASHED_HEADERS} <filesystem> <map> <memory> <string> <vector>)

# jink_joined(target BATCH n | BY_FOLDER): sources compiled n at a time, or all of a folder, as one text: headers are read
# and their inline functions made once for all of them. By folder, objects are named after it (memory report). Names in
# unnamed namespaces are unique within a folder for this; preset clang and JINK_JOINED=OFF compile each source by itself,
# so that an include that is missing shows.
option(JINK_JOINED "Compile sources several at a time" ON)
function(jink_joined target)
  cmake_parse_arguments(arg "BY_FOLDER" "BATCH" "" ${ARGN})
  if(NOT JINK_JOINED)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON)
  if(NOT arg_BY_FOLDER)
    set_target_properties(${target} PROPERTIES UNITY_BUILD_BATCH_SIZE "${arg_BATCH}")
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "^/.*\\.cpp$")
  foreach(source ${sources})
    cmake_path(GET source PARENT_PATH folder)
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    string(REPLACE "/" "-" folder ${folder})
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder})
  endforeach()
endfunction()

# jink_command_lines(target): for command-line parsing. CLI11 is header-only: optimizing it takes longer than all code
# of the project.
function(jink_command_lines target)
  set_target_properties(${target} PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)
  target_compile_options(${target} PRIVATE -O1)
  jink_joined(${target} BATCH 0)
endfunction()
