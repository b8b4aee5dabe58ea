# Optional parts, built if their packages are installed. Each sets PART_FOUND.
# g2o: one that is installed, otherwise the sources that scripts/install_g2o.sh fetches.
find_package(g2o QUIET)
set(g2o_is_installed ${g2o_FOUND})
if(NOT g2o_FOUND)
  include(G2oSources)
endif()
# dlib's own CMake file requires everything that dlib can draw and solve with; its SURF needs only the
# library.
find_path(DLIB_INCLUDE_DIR dlib/image_keypoint.h)
find_library(DLIB_LIBRARY dlib)
set(dlib_FOUND 0)
if(DLIB_INCLUDE_DIR AND DLIB_LIBRARY)
  set(dlib_FOUND 1)
  add_library(kinloop_dlib INTERFACE)
  target_include_directories(kinloop_dlib SYSTEM INTERFACE $<BUILD_INTERFACE:${DLIB_INCLUDE_DIR}>)
  target_link_libraries(kinloop_dlib INTERFACE ${DLIB_LIBRARY})
  find_library(BLAS_LIBRARY blas)  # required by the packaged dlib
  if(BLAS_LIBRARY)
    target_link_libraries(kinloop_dlib INTERFACE ${BLAS_LIBRARY})
  endif()
endif()

# kinloop_optional(PART HEADER LIBRARY...)
# Sets PART_FOUND, and creates the target kinloop_PART if the header and all libraries exist. For packages
# without CMake files, or whose CMake files need their whole build system.
function(kinloop_optional part header)
  find_path(${part}_INCLUDE_DIR ${header})
  set(found ${${part}_INCLUDE_DIR})
  set(libraries)
  foreach(library ${ARGN})
    find_library(${part}_${library}_LIBRARY ${library})
    list(APPEND libraries ${${part}_${library}_LIBRARY})
    if(NOT ${part}_${library}_LIBRARY)
      set(found 0)
    endif()
  endforeach()
  set(${part}_FOUND 0 PARENT_SCOPE)
  if(found)
    set(${part}_FOUND 1 PARENT_SCOPE)
    add_library(kinloop_${part} INTERFACE)
    target_include_directories(kinloop_${part} SYSTEM INTERFACE $<BUILD_INTERFACE:${${part}_INCLUDE_DIR}>)
    target_link_libraries(kinloop_${part} INTERFACE ${libraries})
    set_property(GLOBAL APPEND PROPERTY KINLOOP_OPTIONAL_PARTS kinloop_${part})
  endif()
endfunction()
kinloop_optional(rosbag rosbag/bag.h rosbag_storage roscpp_serialization rostime cpp_common console_bridge
                 boost_filesystem)
# Debian combines ROS 1's bags with ROS 2's plugins, whose headers are in separate folders.
if(rosbag_FOUND)
  foreach(folder pluginlib class_loader ament_index_cpp rcpputils rcutils)
    if(EXISTS ${rosbag_INCLUDE_DIR}/${folder}/${folder})
      target_include_directories(kinloop_rosbag SYSTEM INTERFACE $<BUILD_INTERFACE:${rosbag_INCLUDE_DIR}/${folder}>)
    endif()
  endforeach()
endif()

# The ROS node.
find_package(PkgConfig QUIET)
set(ros_FOUND 0)
if(rosbag_FOUND AND PkgConfig_FOUND)
  pkg_check_modules(roscpp QUIET IMPORTED_TARGET roscpp nav_msgs tf2_msgs geometry_msgs)
  if(roscpp_FOUND)
    set(ros_FOUND 1)
  endif()
endif()

kinloop_optional(freenect libfreenect.h freenect)  # Kinect 1
kinloop_optional(openni2 openni2/OpenNI.h OpenNI2)

# ChArUco boards: OpenCV's aruco from before 4.7, part of the contributed modules.
set(aruco_FOUND 0)
if(OpenCV_VERSION VERSION_LESS 4.7)
  find_path(aruco_INCLUDE_DIR opencv2/aruco/charuco.hpp PATHS ${OpenCV_INCLUDE_DIRS})
  kinloop_optional(aruco opencv2/aruco/charuco.hpp opencv_aruco)
endif()

# Kinect 2: libfreenect2's own file sets variables instead of a target.
find_package(freenect2 QUIET)
if(freenect2_FOUND)
  add_library(kinloop_freenect2 INTERFACE)
  target_include_directories(kinloop_freenect2 SYSTEM INTERFACE $<BUILD_INTERFACE:${freenect2_INCLUDE_DIRS}>)
  target_link_libraries(kinloop_freenect2 INTERFACE ${freenect2_LIBRARIES})
  set_property(GLOBAL APPEND PROPERTY KINLOOP_OPTIONAL_PARTS kinloop_freenect2)
endif()

# RealSense: the SDK's own file defines a target.
find_package(realsense2 QUIET)
if(realsense2_FOUND)
  add_library(kinloop_realsense2 INTERFACE)
  target_link_libraries(kinloop_realsense2 INTERFACE ${realsense2_LIBRARY})
  set_property(GLOBAL APPEND PROPERTY KINLOOP_OPTIONAL_PARTS kinloop_realsense2)
endif()

# Orbbec: the file of OrbbecSDK 2 defines this target, that of version 1 another.
find_package(OrbbecSDK QUIET CONFIG)
set(orbbec_FOUND 0)
if(TARGET ob::OrbbecSDK)
  set(orbbec_FOUND 1)
  add_library(kinloop_orbbec INTERFACE)
  target_link_libraries(kinloop_orbbec INTERFACE ob::OrbbecSDK)
  set_property(GLOBAL APPEND PROPERTY KINLOOP_OPTIONAL_PARTS kinloop_orbbec)
endif()

# OAK: the nodes that the driver uses came with depthai 3.
find_package(depthai QUIET CONFIG)
if(depthai_FOUND AND depthai_VERSION VERSION_LESS 3)
  set(depthai_FOUND 0)
endif()
if(depthai_FOUND)
  add_library(kinloop_depthai INTERFACE)
  target_link_libraries(kinloop_depthai INTERFACE depthai::core)
  set_property(GLOBAL APPEND PROPERTY KINLOOP_OPTIONAL_PARTS kinloop_depthai)
endif()

# Video, as iPhone apps export colour: FFmpeg's libraries.
kinloop_optional(video libavformat/avformat.h avformat avcodec swscale avutil)

# Vocabulary training on several machines. Only the C interface, which every MPI implementation has.
find_package(MPI QUIET COMPONENTS CXX)
set(mpi_FOUND 0)
if(MPI_CXX_FOUND)
  set(mpi_FOUND 1)
  add_library(kinloop_mpi INTERFACE)
  target_include_directories(kinloop_mpi SYSTEM INTERFACE "$<BUILD_INTERFACE:${MPI_CXX_INCLUDE_DIRS}>")
  target_compile_definitions(kinloop_mpi INTERFACE OMPI_SKIP_MPICXX MPICH_SKIP_MPICXX)
  target_link_libraries(kinloop_mpi INTERFACE ${MPI_CXX_LIBRARIES})
  set_property(GLOBAL APPEND PROPERTY KINLOOP_OPTIONAL_PARTS kinloop_mpi)
endif()

kinloop_optional(webp webp/decode.h webp)  # colour images
kinloop_optional(archives archive.h archive)  # .zip, .tar and the like as input

# Downloads: curl fetches, archive unpacks.
find_package(CURL QUIET)
set(download_FOUND 0)
if(CURL_FOUND AND archives_FOUND)
  set(download_FOUND 1)
endif()

# OpenVDB's find module is not in CMake's search path, and requires every optional dependency.
find_path(OPENVDB_INCLUDE_DIR openvdb/openvdb.h)
find_library(OPENVDB_LIBRARY openvdb)
find_library(TBB_LIBRARY tbb)
find_library(HALF_LIBRARY NAMES Imath Imath-3_1 Half)  # OpenVDB uses its half-precision numbers
set(openvdb_FOUND 0)
if(OPENVDB_INCLUDE_DIR AND OPENVDB_LIBRARY AND TBB_LIBRARY)
  set(openvdb_FOUND 1)
  add_library(kinloop_openvdb INTERFACE)
  target_include_directories(kinloop_openvdb SYSTEM INTERFACE $<BUILD_INTERFACE:${OPENVDB_INCLUDE_DIR}>)
  # kinloop uses templates alone; only those of old versions need the library. Loading it costs 28 MiB and starts the
  # threads of a log library.
  set(libraries ${OPENVDB_LIBRARY} ${TBB_LIBRARY})
  if(HALF_LIBRARY)
    list(APPEND libraries ${HALF_LIBRARY})
  endif()
  list(JOIN libraries "," libraries)
  target_link_libraries(kinloop_openvdb INTERFACE "-Wl,--push-state,--as-needed,${libraries},--pop-state")
endif()
find_package(octomap QUIET)

# Simplified meshes: CGAL's templates, without the exact numbers for which its own file requires GMP.
kinloop_optional(cgal CGAL/Polygon_mesh_processing/repair_polygon_soup.h)
if(cgal_FOUND)
  target_compile_definitions(kinloop_cgal INTERFACE CGAL_DISABLE_GMP)
endif()

# The Python package. The distribution's packages belong to its own Python, which need not be the first in PATH. Only
# pybind11 2.13 and newer knows NumPy 2 and all supported Pythons: scripts/install_pybind11.sh fetches one.
set(python_FOUND 0)
if(KINLOOP_PYTHON)
  if(NOT Python3_EXECUTABLE AND EXISTS /usr/bin/python3)
    set(Python3_EXECUTABLE /usr/bin/python3)
  endif()
  find_package(Python3 3.9 QUIET COMPONENTS Interpreter Development.Module)
  if(Python3_FOUND)
    find_package(pybind11 2.13 QUIET CONFIG HINTS ${PROJECT_SOURCE_DIR}/build/pybind11/pybind11/share/cmake/pybind11)
  endif()
  if(pybind11_FOUND)
    set(python_FOUND 1)
  endif()
endif()
set(KINLOOP_PYTHON_FOUND ${python_FOUND} CACHE INTERNAL "For python/setup.py")
