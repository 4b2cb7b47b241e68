# SPDX-License-Identifier: BSD-3-Clause
# libccd in its double build as the target `ccd`: Debian's library on the host; for other targets built from Debian's
# unpatched source package with the build's compiler.
if(NOT CMAKE_CROSSCOMPILING)
  find_package(ccd 2.0 REQUIRED)  # Debian ships 2.1 with a config file that still says 2.0
  return()
endif()

set(JINK_CCD_SOURCE "${PROJECT_SOURCE_DIR}/build/third_party/libccd" CACHE PATH "libccd's source, as toolchain/setup/ccd_source leaves it")
if(NOT EXISTS "${JINK_CCD_SOURCE}/CMakeLists.txt")
  execute_process(COMMAND "${PROJECT_SOURCE_DIR}/toolchain/setup/ccd_source" "${JINK_CCD_SOURCE}" RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "libccd's source cannot be had; see above")
  endif()
endif()
set(CCD_DOUBLE ON)
set(BUILD_SHARED_LIBS OFF)
set(BUILD_TESTING OFF)
set(BUILD_DOCUMENTATION OFF)
set(LIBM_LIBRARY m)  # its search looks for a library file in the host's folders
set(CMAKE_POLICY_DEFAULT_CMP0077 NEW)  # the settings above are taken as they are
set(CMAKE_WARN_DEPRECATED OFF)
add_subdirectory("${JINK_CCD_SOURCE}" "${PROJECT_BINARY_DIR}/third_party/libccd" EXCLUDE_FROM_ALL SYSTEM)
