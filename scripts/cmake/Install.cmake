# `cmake --install` installs the program, the headers, the libraries and kinloopConfig.cmake. Components are the packages
# of Packages.cmake.
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME development)

install(TARGETS kinloop ${modules} kinloop_opencv kinloop_cholmod kinloop_codecs kinloop_compression kinloop_hwy EXPORT kinloopTargets)
get_property(parts GLOBAL PROPERTY KINLOOP_OPTIONAL_PARTS)
if(parts)
  install(TARGETS ${parts} EXPORT kinloopTargets)
endif()
if(TARGET kinloop_dlib)
  install(TARGETS kinloop_dlib EXPORT kinloopTargets)
endif()
if(TARGET kinloop_openvdb)
  install(TARGETS kinloop_openvdb EXPORT kinloopTargets)
endif()
if(KINLOOP_PROGRAM)
  install(TARGETS kinloop_program COMPONENT program)
  install(DIRECTORY python/kinloop/batch DESTINATION ${CMAKE_INSTALL_DATADIR}/kinloop COMPONENT program
          FILES_MATCHING PATTERN "*.py" PATTERN "*.html")
  install(FILES python/kinloop/_rerun.py DESTINATION ${CMAKE_INSTALL_DATADIR}/kinloop COMPONENT program)
endif()
install(DIRECTORY kinloop dense drivers simulator tools session DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kinloop
        FILES_MATCHING PATTERN "*.hpp")
install(EXPORT kinloopTargets NAMESPACE kinloop:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/kinloop)
configure_package_config_file(scripts/cmake/kinloopConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/kinloopConfig.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/kinloop)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/kinloopConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/kinloopConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/kinloopConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/kinloop)
