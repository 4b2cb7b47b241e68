# SPDX-License-Identifier: BSD-3-Clause
# Installed as include/jink/<room>/..., exported as jink::core, jink::hal, jink::link, jink::app for find_package(jink).
include(CMakePackageConfigHelpers)
set(jink_exported jink_core jink_hal jink_link jink_app)
set(JINK_FINDS_CCD "find_dependency(ccd 2.0)")
if(CMAKE_CROSSCOMPILING)
  # Built here for the target (JinkCcd.cmake): no package of the target's has it.
  list(APPEND jink_exported ccd)
  set(JINK_FINDS_CCD "")
endif()
install(TARGETS ${jink_exported} EXPORT jinkTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(room core hal firmware/link firmware/vehicles firmware/app firmware/flight_log)
  cmake_path(GET room PARENT_PATH above)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${room} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/jink/${above}
          FILES_MATCHING PATTERN "*.hpp" PATTERN "sections.ld")
endforeach()
install(EXPORT jinkTargets NAMESPACE jink:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/jink)
configure_package_config_file(${PROJECT_SOURCE_DIR}/toolchain/cmake/jinkConfig.cmake.in
  ${PROJECT_BINARY_DIR}/jinkConfig.cmake INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/jink)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/jinkConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/jinkConfig.cmake ${PROJECT_BINARY_DIR}/jinkConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/jink)
