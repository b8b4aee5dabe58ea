# Packages, by `cpack` or scripts/build_packages.sh: one per component of the installation.
#   program      kinloop           the program, manual pages, completion, desktop entry
#   development  libkinloop-dev    headers, static libraries, CMake files
#   python       python3-kinloop   the Python package, with KINLOOP_PYTHON
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set(KINLOOP_MAINTAINER "kinloop maintainers <kinloop@users.noreply.github.com>" CACHE STRING "Maintainer of the packages")

if(NOT KINLOOP_PAGES_FOUND AND NOT "pages" IN_LIST KINLOOP_WITHOUT)
  message(FATAL_ERROR "The viewer and report pages could not be built; -DKINLOOP_WITHOUT=pages leaves them out")
endif()

# The date is that of the sources, so that the same sources give the same packages.
execute_process(COMMAND git -C ${PROJECT_SOURCE_DIR} log -1 --format=%cD OUTPUT_VARIABLE KINLOOP_CHANGELOG_DATE
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
execute_process(COMMAND git -C ${PROJECT_SOURCE_DIR} log -1 --format=%cs OUTPUT_VARIABLE KINLOOP_DATE
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT KINLOOP_DATE)  # an archive without a repository
  string(TIMESTAMP KINLOOP_CHANGELOG_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
  string(TIMESTAMP KINLOOP_DATE "%Y-%m-%d" UTC)
endif()

set(packaging ${PROJECT_SOURCE_DIR}/scripts/packaging)
set(share ${PROJECT_BINARY_DIR}/share)
configure_file(${packaging}/debian/changelog.in ${share}/changelog.Debian @ONLY)
configure_file(${packaging}/io.github.kinloop.metainfo.xml.in ${share}/io.github.kinloop.metainfo.xml @ONLY)
configure_file(${PROJECT_SOURCE_DIR}/docs/CHANGELOG.md ${share}/changelog COPYONLY)
foreach(file changelog.Debian changelog)
  execute_process(COMMAND gzip -9nkf ${share}/${file} COMMAND_ERROR_IS_FATAL ANY)
endforeach()

# Manual pages and completion are made from the help of the program.
set(scripts ${PROJECT_SOURCE_DIR}/scripts)
add_custom_command(
  OUTPUT ${share}/completion/kinloop
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${share}/man ${share}/completion
  COMMAND ${Python3_EXECUTABLE} ${scripts}/make_man_pages.py $<TARGET_FILE:kinloop_program> ${share}/man
  COMMAND gzip -9nr ${share}/man
  COMMAND ${Python3_EXECUTABLE} ${scripts}/make_completion.py $<TARGET_FILE:kinloop_program> ${share}/completion
  DEPENDS kinloop_program ${scripts}/command_help.py ${scripts}/make_man_pages.py ${scripts}/make_completion.py
  COMMENT "Writing manual pages and completion"
  VERBATIM)
add_custom_target(kinloop_manuals ALL DEPENDS ${share}/completion/kinloop)

install(DIRECTORY ${share}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program FILES_MATCHING PATTERN "*.1.gz")
install(DIRECTORY ${share}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man7 COMPONENT program FILES_MATCHING PATTERN "*.7.gz")
install(FILES ${share}/completion/kinloop DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        COMPONENT program)
install(FILES ${share}/completion/_kinloop DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
install(FILES ${packaging}/kinloop.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT program)
install(FILES ${packaging}/kinloop.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps COMPONENT program)
install(FILES ${packaging}/kinloop-mime.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages RENAME kinloop.xml
        COMPONENT program)
install(FILES ${share}/io.github.kinloop.metainfo.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo COMPONENT program)

# kinloop_package(COMPONENT PACKAGE SECTION TEXT): a component as a Debian package, with the files that each has. The
# summary of all is the description of the project.
macro(kinloop_package component package section text)
  string(TOUPPER ${component} upper)
  install(FILES ${packaging}/debian/copyright ${share}/changelog.Debian.gz ${share}/changelog.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "\
kinloop computes the camera trajectory and a coloured 3D map from the stream
of a Kinect-class RGB-D camera, on an ordinary CPU.\n${text}")
endmacro()

set(CPACK_COMPONENTS_ALL)
kinloop_package(program kinloop science "This package contains the program.")
kinloop_package(development libkinloop-dev libdevel "This package contains the headers and the static library.")
if(KINLOOP_PYTHON)
  kinloop_package(python python3-kinloop python "This package contains the module for Python 3.")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= ${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}), python3-numpy")
endif()

# The static library needs the development packages of what it was built with: each owns a header or a CMake file.
set(development_packages
    libopencv-dev libeigen3-dev libceres-dev libsuitesparse-dev libhwy-dev libturbojpeg0-dev libdeflate-dev libpng-dev
    libtiff-dev libopenexr-dev libsqlite3-dev liblz4-dev libzstd-dev libbz2-dev libyaml-cpp-dev libspdlog-dev libfmt-dev
    nlohmann-json3-dev)
set(part_packages
    "dlib:libdlib-dev" "openvdb:libopenvdb-dev" "octomap:liboctomap-dev" "aruco:libopencv-contrib-dev"
    "freenect:libfreenect-dev" "openni2:libopenni2-dev" "mpi:libopenmpi-dev" "video:libavformat-dev"
    "video:libavcodec-dev" "video:libswscale-dev" "video:libavutil-dev")
foreach(row ${part_packages})
  string(REPLACE ":" ";" row ${row})
  list(GET row 0 part)
  list(GET row 1 package)
  if(${part}_FOUND)
    list(APPEND development_packages ${package})
  endif()
endforeach()
list(JOIN development_packages ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME kinloop)
set(CPACK_PACKAGE_CONTACT "${KINLOOP_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${KINLOOP_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "www-browser, python3 (>= 3.9), python3-yaml")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)
include(CPack)
