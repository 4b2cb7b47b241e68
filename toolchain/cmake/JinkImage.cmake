# SPDX-License-Identifier: BSD-3-Clause
# jink_image(name MAIN sources... LINKER_SCRIPT file [APPLICATION library]): a bare-metal image, its map file and a binary
# beside it.
function(jink_image name)
  cmake_parse_arguments(arg "" "LINKER_SCRIPT;APPLICATION" "MAIN" ${ARGN})
  if(NOT arg_APPLICATION)
    set(arg_APPLICATION jink_app)
  endif()
  cmake_path(ABSOLUTE_PATH arg_LINKER_SCRIPT NORMALIZE)
  add_executable(${name} ${arg_MAIN})
  set_target_properties(${name} PROPERTIES SUFFIX .elf LINK_DEPENDS "${arg_LINKER_SCRIPT};${PROJECT_SOURCE_DIR}/hal/cortex_m/sections.ld")
  target_link_libraries(${name} PRIVATE ${arg_APPLICATION} jink_hal jink_warnings jink_embedded)
  if(JINK_MAP)
    jink_image_map(${name} ${JINK_MAP})
  endif()
  target_link_options(${name} PRIVATE -T ${arg_LINKER_SCRIPT} -L ${PROJECT_SOURCE_DIR}/hal/cortex_m
    -Wl,-Map=${CMAKE_CURRENT_BINARY_DIR}/${name}.map)
  add_custom_command(TARGET ${name} POST_BUILD
    COMMAND ${CMAKE_OBJCOPY} -O binary $<TARGET_FILE:${name}> ${CMAKE_CURRENT_BINARY_DIR}/${name}.bin)
endfunction()

# jink_image_map(name header): the map that the image is built with (firmware/app/built_map.hpp).
function(jink_image_map name header)
  cmake_path(ABSOLUTE_PATH header BASE_DIRECTORY ${CMAKE_BINARY_DIR} NORMALIZE)
  set(definition "inline constexpr MeshMap (k[A-Za-z0-9_]+Map){")
  if(EXISTS ${header})
    file(STRINGS ${header} lines REGEX "${definition}")
  endif()
  if(NOT lines MATCHES "${definition}")
    message(FATAL_ERROR "JINK_MAP: ${header} is not a header made by jink mesh build --header")
  endif()
  target_compile_definitions(${name} PRIVATE "JINK_MAP=\"${header}\"" JINK_MAP_OF=jink::geometry::${CMAKE_MATCH_1})
endfunction()

# jink_method_images(name MAIN ... LINKER_SCRIPT ...): the same image with fewer methods, for the memory report. Built only
# when asked for by name: name_geometric_reach, name_geometric_orca, name_geometric.
function(jink_method_images name)
  foreach(methods geometric_reach geometric_orca geometric)
    string(REPLACE "_" ";" list ${methods})
    jink_application(jink_app_${methods} METHODS ${list})
    jink_image(${name}_${methods} ${ARGN} APPLICATION jink_app_${methods})
    set_target_properties(jink_app_${methods} ${name}_${methods} PROPERTIES EXCLUDE_FROM_ALL ON)
  endforeach()
endfunction()
