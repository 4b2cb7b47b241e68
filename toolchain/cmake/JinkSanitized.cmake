# SPDX-License-Identifier: BSD-3-Clause
# Flashed code, built a second time in the same build with AddressSanitizer, UndefinedBehaviorSanitizer, assertions and
# the standard library's bounds checks. Tests are compiled once and linked twice: `NAME` with the release libraries,
# `sanitized_NAME` with these. Tests and tools themselves are not instrumented; preset asan instruments everything.
#
# The sanitized objects come first on the link line: if both have a header's function, the linker takes the checked one.
option(JINK_SANITIZED_TESTS "Build the tests of flashed code against sanitized libraries too; toolchain/test sets it" OFF)

set(JINK_SANITIZERS -fsanitize=address,undefined)

# jink_sanitized_library(lib): the object library lib_sanitized, of lib's sources and properties
function(jink_sanitized_library lib)
  if(NOT JINK_SANITIZED_TESTS)
    return()
  endif()
  get_target_property(folder ${lib} SOURCE_DIR)
  get_target_property(sources ${lib} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  foreach(source ${sources})
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder})
    list(APPEND absolute ${source})
  endforeach()
  add_library(${lib}_sanitized OBJECT EXCLUDE_FROM_ALL ${absolute})
  foreach(property INCLUDE_DIRECTORIES COMPILE_DEFINITIONS COMPILE_OPTIONS COMPILE_FEATURES LINK_LIBRARIES PRECOMPILE_HEADERS UNITY_BUILD UNITY_BUILD_MODE UNITY_BUILD_BATCH_SIZE)
    get_target_property(value ${lib} ${property})
    if(value)
      set_target_properties(${lib}_sanitized PROPERTIES ${property} "${value}")
    endif()
  endforeach()
  get_target_property(owner ${lib} PRECOMPILE_HEADERS_REUSE_FROM)
  if(owner)
    target_precompile_headers(${lib}_sanitized REUSE_FROM ${owner}_sanitized)
  endif()
  # The vptr check compares type information, which code built without RTTI does not have.
  target_compile_options(${lib}_sanitized PRIVATE ${JINK_SANITIZERS} -fno-sanitize=vptr -fno-sanitize-recover=all
    -fno-omit-frame-pointer -g1 -O1 -UNDEBUG)
  target_compile_definitions(${lib}_sanitized PRIVATE _GLIBCXX_ASSERTIONS)
  # These checks take half of core's build time, and core parses no bytes: AddressSanitizer also detects null pointers
  # and accesses beyond an object.
  if(lib STREQUAL jink_core)
    target_compile_options(${lib}_sanitized PRIVATE -fno-sanitize=null,alignment,object-size)
  endif()
endfunction()

# jink_sanitized_program(program LIBRARIES lib...): sanitized_program of program's objects; lib: those of jink_core,
# jink_hal, jink_link, jink_app that it is linked with, and whatever else
function(jink_sanitized_program program)
  cmake_parse_arguments(arg "" "" "LIBRARIES" ${ARGN})
  set(flashed)
  foreach(lib jink_core jink_hal jink_link jink_app_of_any jink_app)
    list(APPEND flashed $<TARGET_OBJECTS:${lib}_sanitized>)
  endforeach()
  # A program that replaces malloc would replace the sanitizer's.
  add_executable(sanitized_${program} ${flashed} $<FILTER:$<TARGET_OBJECTS:${program}>,EXCLUDE,allocation_test>)
  set_target_properties(sanitized_${program} PROPERTIES LINKER_LANGUAGE CXX)
  target_link_libraries(sanitized_${program} PRIVATE ${arg_LIBRARIES} ccd)
  target_link_options(sanitized_${program} PRIVATE ${JINK_SANITIZERS})
endfunction()
