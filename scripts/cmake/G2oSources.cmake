# g2o from its sources in build/g2o, where scripts/install_g2o.sh puts them: what pose graphs need of it, as objects that
# become part of kinloop_optimize, so that nothing that uses kinloop has to find g2o. Compiled here and not taken as a
# compiled package: both sides must agree about Eigen, instruction sets and the C++ library. Sets g2o_FOUND.
set(g2o_folder ${PROJECT_SOURCE_DIR}/build/g2o)
if(NOT EXISTS ${g2o_folder}/g2o/core/sparse_optimizer.cpp)
  return()
endif()
set(g2o_FOUND 1)

file(GLOB g2o_sources ${g2o_folder}/g2o/core/*.cpp)
file(GLOB g2o_formats ${g2o_folder}/g2o/core/io/*.cpp)
foreach(source stuff/filesys_tools stuff/logger stuff/property stuff/string_tools stuff/sparse_helper stuff/timeutil
               types/slam2d/edge_se2 types/slam2d/vertex_se2
               types/slam3d/edge_se3 types/slam3d/vertex_se3 types/slam3d/dquat2mat types/slam3d/isometry3d_mappings
               types/slam3d/se3quat
               solvers/cholmod/cholmod_wrapper)
  list(APPEND g2o_sources ${g2o_folder}/g2o/${source}.cpp)
endforeach()
set_source_files_properties(${g2o_formats} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)

# None of what this file can turn on is needed.
configure_file(${g2o_folder}/config.h.in ${PROJECT_BINARY_DIR}/g2o/g2o/config.h)

add_library(kinloop_g2o OBJECT EXCLUDE_FROM_ALL ${g2o_sources} ${g2o_formats})
# Two files instead of fifty compile in a minute of one core.
set_target_properties(kinloop_g2o PROPERTIES POSITION_INDEPENDENT_CODE ON UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 32)
target_include_directories(kinloop_g2o SYSTEM PUBLIC ${g2o_folder} ${PROJECT_BINARY_DIR}/g2o)
target_link_libraries(kinloop_g2o PUBLIC Eigen3::Eigen kinloop_cholmod)
kinloop_compile_options(kinloop_g2o)
target_compile_options(kinloop_g2o PRIVATE -w)  # not our code
