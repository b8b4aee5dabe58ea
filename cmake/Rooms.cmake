# kinloop_room(NAME [ROOMS room...] [LIBRARIES target...])
#
# One library target kinloop_<NAME>, alias kinloop::<NAME>, from all sources in the current folder. ROOMS are the
# rooms it may include (the same as its line in layers.txt), LIBRARIES what it needs from outside.
function(kinloop_room name)
  cmake_parse_arguments(ARG "" "" "ROOMS;LIBRARIES" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  add_library(kinloop_${name} STATIC ${sources})
  add_library(kinloop::${name} ALIAS kinloop_${name})
  set_target_properties(kinloop_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(kinloop_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                    $<INSTALL_INTERFACE:include>)
  list(TRANSFORM ARG_ROOMS PREPEND kinloop_)
  target_link_libraries(kinloop_${name} PUBLIC ${ARG_ROOMS} ${ARG_LIBRARIES})
  set_property(GLOBAL APPEND PROPERTY KINLOOP_ROOMS kinloop_${name})
endfunction()

# kinloop_test(NAME [ROOMS room...] [LIBRARIES target...])
#
# One GoogleTest program tests/<NAME>/*.cpp, each of its tests known to CTest by itself.
function(kinloop_test name)
  cmake_parse_arguments(ARG "" "" "ROOMS;LIBRARIES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  list(TRANSFORM ARG_ROOMS PREPEND kinloop_)
  add_executable(test_${name} ${sources})
  target_link_libraries(test_${name} PRIVATE ${ARG_ROOMS} ${ARG_LIBRARIES} GTest::gmock GTest::gtest_main)
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_definitions(
    test_${name} PRIVATE KINLOOP_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                         KINLOOP_SHARED_DATA="${PROJECT_SOURCE_DIR}/../shared/data")
  gtest_discover_tests(test_${name} TEST_PREFIX ${name}. DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 600)
endfunction()
