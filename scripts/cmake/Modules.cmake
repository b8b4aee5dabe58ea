# Declaration of the project's libraries and tests. scripts/cmake/layers.txt says what each module may include; modules link
# exactly that.
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/layers.txt KINLOOP_LAYERS REGEX "^[a-z]")
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_LIST_DIR}/layers.txt)

# kinloop_module([LIBRARIES target...])
# The static library kinloop_<name>, alias kinloop::<name>, from all sources in the current folder, whose last
# path component is the name. It links the modules that scripts/cmake/layers.txt lists and the external LIBRARIES.
function(kinloop_module)
  cmake_parse_arguments(ARG "" "" "LIBRARIES" ${ARGN})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  get_filename_component(name ${folder} NAME)
  set(row ${KINLOOP_LAYERS})
  list(FILTER row INCLUDE REGEX "^${folder}:")
  if(NOT row)
    message(FATAL_ERROR "${folder} has no row in scripts/cmake/layers.txt")
  endif()
  string(REGEX REPLACE "^[^:]*: *" "" modules "${row}")
  string(REPLACE " " ";" modules "${modules}")
  list(TRANSFORM modules PREPEND kinloop_)

  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  set(kernels ${sources})
  list(FILTER kernels INCLUDE REGEX "/kernels/")  # each includes itself once per instruction set
  set_source_files_properties(${kernels} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  if(KINLOOP_FUZZ)  # no kernel reads input, and instrumenting them takes minutes
    set_source_files_properties(${kernels} PROPERTIES COMPILE_OPTIONS -fno-sanitize=all)
  endif()
  add_library(kinloop_${name} STATIC ${sources})
  add_library(kinloop::${name} ALIAS kinloop_${name})
  set_target_properties(kinloop_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(kinloop_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/kinloop>)
  target_link_libraries(kinloop_${name} PUBLIC ${modules} ${ARG_LIBRARIES})
  kinloop_compile_options(kinloop_${name})
  set_property(GLOBAL APPEND PROPERTY KINLOOP_MODULES kinloop_${name})
endfunction()

# kinloop_program(NAME SOURCES source... [LIBRARIES target...]): a program of the project, by the same rules.
function(kinloop_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES})
  kinloop_compile_options(${name})
endfunction()

# kinloop_test(NAME [LIBRARIES target...] [TOGETHER suite...] [BY_SUITE])
# One GoogleTest program test_<NAME> from tests/<NAME>/*.cpp; each of its tests is a separate CTest test, but for suites
# whose tests share what takes long to make (a rendered recording, a finished run): each of them is one CTest test. With
# BY_SUITE so is every suite without parameters, where starting the program takes longer than most of its tests.
function(kinloop_test name)
  cmake_parse_arguments(ARG "BY_SUITE" "" "LIBRARIES;TOGETHER" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  kinloop_program(test_${name} SOURCES ${sources} LIBRARIES ${ARG_LIBRARIES} kinloop_test_support GTest::gmock)
  target_compile_options(test_${name} PRIVATE $<$<CONFIG:Release>:-O1>)  # halves the compile time; the library is at -O3
  set(suites ${ARG_TOGETHER})
  if(ARG_BY_SUITE)
    kinloop_test_suites(names ${sources})
    list(APPEND suites ${names})
    list(REMOVE_DUPLICATES suites)
  endif()
  set(others "*")
  if(suites)
    list(JOIN suites ".*:" others)
    set(others "-${others}.*")
  endif()
  gtest_discover_tests(test_${name} TEST_PREFIX ${name}. TEST_FILTER ${others} DISCOVERY_TIMEOUT 60
                                    PROPERTIES TIMEOUT 600 SKIP_RETURN_CODE 77)
  foreach(suite ${suites})
    add_test(NAME ${name}.${suite} COMMAND test_${name} --gtest_filter=${suite}.*)
    set_tests_properties(${name}.${suite} PROPERTIES TIMEOUT 600 SKIP_RETURN_CODE 77)
  endforeach()
  foreach(suite ${ARG_TOGETHER})
    set_tests_properties(${name}.${suite} PROPERTIES COST 60)  # the longest begin first
  endforeach()
endfunction()

# kinloop_test_suites(VARIABLE source...): the suites without parameters, but for files that depend on optional parts. A
# new suite is run test by test until CMake runs again.
function(kinloop_test_suites variable)
  set(suites)
  foreach(source ${ARGN})
    file(STRINGS ${source} optional REGEX "^#ifn?def KINLOOP_WITH")
    if(optional)
      continue()
    endif()
    file(STRINGS ${source} lines REGEX "^TEST(_F)?\\([A-Za-z0-9_]+,")
    foreach(line ${lines})
      string(REGEX REPLACE "^TEST(_F)?\\(([A-Za-z0-9_]+),.*" "\\2" suite "${line}")
      list(APPEND suites ${suite})
    endforeach()
  endforeach()
  set(${variable} ${suites} PARENT_SCOPE)
endfunction()
