# SPDX-License-Identifier: BSD-3-Clause
# Installs the build into a scratch prefix, builds the example against it and runs it.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  message(STATUS "${output}")
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "failed (${result}): ${ARGN}")
  endif()
endfunction()
file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${EXAMPLE} -B ${WORK}/build -G Ninja -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_CXX_COMPILER=${COMPILER}
    "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror" -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/example)
run(${WORK}/build/method)

# The C example: by jink::c, and by pkg-config as C11 without a warning.
set(c_example ${EXAMPLE}/c_interface)
if(EXISTS ${WORK}/prefix/include/jink.h)
  run(${CMAKE_COMMAND} -S ${c_example} -B ${WORK}/build_c -G Ninja -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_C_COMPILER=${C_COMPILER}
      "-DCMAKE_C_FLAGS=-Wall -Wextra -pedantic -Werror" -DCMAKE_BUILD_TYPE=Release)
  run(${CMAKE_COMMAND} --build ${WORK}/build_c)
  run(${WORK}/build_c/example)
  file(GLOB_RECURSE pc ${WORK}/prefix/*/jink.pc)
  cmake_path(GET pc PARENT_PATH pc_folder)
  cmake_path(GET pc_folder PARENT_PATH library_folder)
  run(sh -ec "flags=$(PKG_CONFIG_PATH=${pc_folder} pkg-config --cflags --libs jink); for std in 'c11 -x c' 'c++20 -x c++'; do
      ${C_COMPILER} -std=$std -Wall -Wextra -pedantic -Werror ${c_example}/main.c -x none -o ${WORK}/with_pkg_config $flags -Wl,-rpath,${library_folder}
      ${WORK}/with_pkg_config; done")
endif()
