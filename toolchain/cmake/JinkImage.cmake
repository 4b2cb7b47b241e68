# SPDX-License-Identifier: BSD-3-Clause
# jink_image(name MAIN sources... LINKER_SCRIPT file): a bare-metal image, its map file and a binary beside it.
function(jink_image name)
  cmake_parse_arguments(arg "" "LINKER_SCRIPT" "MAIN" ${ARGN})
  cmake_path(ABSOLUTE_PATH arg_LINKER_SCRIPT NORMALIZE)
  add_executable(${name} ${arg_MAIN})
  set_target_properties(${name} PROPERTIES SUFFIX .elf LINK_DEPENDS "${arg_LINKER_SCRIPT};${PROJECT_SOURCE_DIR}/hal/cortex_m/sections.ld")
  target_link_libraries(${name} PRIVATE jink_app jink_hal jink_warnings jink_embedded)
  target_link_options(${name} PRIVATE -T ${arg_LINKER_SCRIPT} -L ${PROJECT_SOURCE_DIR}/hal/cortex_m
    -Wl,-Map=${CMAKE_CURRENT_BINARY_DIR}/${name}.map)
  add_custom_command(TARGET ${name} POST_BUILD
    COMMAND ${CMAKE_OBJCOPY} -O binary $<TARGET_FILE:${name}> ${CMAKE_CURRENT_BINARY_DIR}/${name}.bin)
endfunction()
