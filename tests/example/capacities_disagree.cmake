# SPDX-License-Identifier: BSD-3-Clause
# A unit compiled with another capacity than the installed library must not link, and the linker must say why.
set(definitions -DJINK_MAX_TRACKS=33 -DJINK_MAX_MISSION_ITEMS=63 -DJINK_MAX_PATH_POINTS=63)
file(REMOVE_RECURSE ${WORK})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
function(build definition expected)
  string(MAKE_C_IDENTIFIER "${definition}" name)
  execute_process(COMMAND ${CMAKE_COMMAND} -S ${EXAMPLE} -B ${WORK}/${name} -G Ninja -DCMAKE_PREFIX_PATH=${WORK}/prefix
    -DCMAKE_CXX_COMPILER=${COMPILER} "-DCMAKE_CXX_FLAGS=${definition}" -DCMAKE_BUILD_TYPE=Release OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/${name} --target example RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(expected STREQUAL "links")
    if(NOT result EQUAL 0)
      message(FATAL_ERROR "${definition} does not link:\n${output}")
    endif()
  elseif(result EQUAL 0 OR NOT output MATCHES "undefined reference to `jink_capacities_[0-9_]+'|undefined symbol: jink_capacities_[0-9_]+")
    message(FATAL_ERROR "${definition} was not refused for its capacities:\n${output}")
  endif()
endfunction()
build(-DJINK_MAX_TRACKS=64 links)  # the library's own
foreach(definition ${definitions})
  build(${definition} refused)
endforeach()
