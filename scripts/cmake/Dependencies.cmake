# Every library comes from the distribution's packages; none is bundled. Only g2o, which no distribution packages, is
# built from its sources: G2oSources.cmake.
find_package(Threads REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(OpenCV QUIET COMPONENTS core imgproc features2d calib3d video)
if(NOT OpenCV_FOUND)
  include(UnpackedOpenCV)
endif()
if(NOT OpenCV_FOUND)
  message(FATAL_ERROR "OpenCV was not found: scripts/install_dependencies.sh installs it")
endif()
find_package(Ceres REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(spdlog REQUIRED)
find_package(SQLite3 REQUIRED)

# yaml-cpp's target has different names before and after 0.8.
if(NOT TARGET yaml-cpp::yaml-cpp)
  add_library(yaml-cpp::yaml-cpp ALIAS yaml-cpp)
endif()

# OpenCV's config lists plain libraries; one target combines them with its headers as system headers.
add_library(kinloop_opencv INTERFACE)
target_include_directories(kinloop_opencv SYSTEM INTERFACE $<BUILD_INTERFACE:${OpenCV_INCLUDE_DIRS}>)
target_link_libraries(kinloop_opencv INTERFACE opencv_core opencv_imgproc opencv_features2d opencv_calib3d opencv_video)

# SuiteSparse has its own CMake files only from version 6 on.
find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
add_library(kinloop_cholmod INTERFACE)
target_include_directories(kinloop_cholmod SYSTEM INTERFACE $<BUILD_INTERFACE:${CHOLMOD_INCLUDE_DIR}>)
target_link_libraries(kinloop_cholmod INTERFACE ${CHOLMOD_LIBRARY})

# Images: libjpeg-turbo's native interface, libdeflate, libpng for rare kinds, OpenEXR and libtiff; not all packages have
# CMake files. OpenCV's own readers (imgcodecs) would load a hundred libraries for formats that nothing here uses.
find_package(PNG REQUIRED)
find_path(TURBOJPEG_INCLUDE_DIR turbojpeg.h REQUIRED)
find_library(TURBOJPEG_LIBRARY turbojpeg REQUIRED)
find_path(LIBDEFLATE_INCLUDE_DIR libdeflate.h REQUIRED)
find_library(LIBDEFLATE_LIBRARY deflate REQUIRED)
find_path(OPENEXR_INCLUDE_DIR ImfInputPart.h PATH_SUFFIXES OpenEXR REQUIRED)
find_path(IMATH_INCLUDE_DIR ImathBox.h PATH_SUFFIXES Imath OpenEXR REQUIRED)
find_path(TIFF_INCLUDE_DIR tiffio.h REQUIRED)
find_library(TIFF_LIBRARY tiff REQUIRED)
find_library(OPENEXR_LIBRARY NAMES OpenEXR IlmImf REQUIRED)  # IlmImf: before version 3
add_library(kinloop_codecs INTERFACE)
target_include_directories(kinloop_codecs SYSTEM INTERFACE $<BUILD_INTERFACE:${TURBOJPEG_INCLUDE_DIR}>
                                                           $<BUILD_INTERFACE:${LIBDEFLATE_INCLUDE_DIR}>
                                                           $<BUILD_INTERFACE:${TIFF_INCLUDE_DIR}>
                                                           $<BUILD_INTERFACE:${OPENEXR_INCLUDE_DIR}>
                                                           $<BUILD_INTERFACE:${IMATH_INCLUDE_DIR}>)
target_link_libraries(kinloop_codecs INTERFACE ${TURBOJPEG_LIBRARY} ${LIBDEFLATE_LIBRARY} PNG::PNG ${TIFF_LIBRARY} ${OPENEXR_LIBRARY})

# Compressed blocks of bags.
find_path(LZ4_INCLUDE_DIR lz4frame.h REQUIRED)
find_library(LZ4_LIBRARY lz4 REQUIRED)
find_path(ZSTD_INCLUDE_DIR zstd.h REQUIRED)
find_library(ZSTD_LIBRARY zstd REQUIRED)
find_package(BZip2 REQUIRED)
add_library(kinloop_compression INTERFACE)
target_include_directories(kinloop_compression SYSTEM INTERFACE $<BUILD_INTERFACE:${LZ4_INCLUDE_DIR}>
                                                                $<BUILD_INTERFACE:${ZSTD_INCLUDE_DIR}>
                                                                $<BUILD_INTERFACE:${BZIP2_INCLUDE_DIR}>)
target_link_libraries(kinloop_compression INTERFACE ${LZ4_LIBRARY} ${ZSTD_LIBRARY} ${BZIP2_LIBRARIES})

# Only newer packages of Highway have CMake files.
find_path(HWY_INCLUDE_DIR hwy/highway.h REQUIRED)
find_library(HWY_LIBRARY hwy REQUIRED)
add_library(kinloop_hwy INTERFACE)
target_include_directories(kinloop_hwy SYSTEM INTERFACE $<BUILD_INTERFACE:${HWY_INCLUDE_DIR}>)
target_compile_definitions(kinloop_hwy INTERFACE HWY_SHARED_DEFINE)
target_link_libraries(kinloop_hwy INTERFACE ${HWY_LIBRARY})
# Of two instruction sets the better one has the lower number. The kernels keep vectors in arrays, which requires a size
# known at compile time: NEON instead of SVE.
set(simd ${KINLOOP_SIMD})
if(NOT simd AND CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
  set(simd NEON)
endif()
if(simd)
  target_compile_definitions(kinloop_hwy INTERFACE "HWY_DISABLED_TARGETS=(HWY_${simd}-1)")
endif()

# The program, and the viewer's server: Boost.Beast, header-only.
if(KINLOOP_PROGRAM)
  find_package(CLI11 REQUIRED)
endif()
if(KINLOOP_PROGRAM OR KINLOOP_PYTHON)
  find_package(Boost 1.74 REQUIRED)
  add_library(kinloop_boost INTERFACE)
  target_include_directories(kinloop_boost SYSTEM INTERFACE ${Boost_INCLUDE_DIRS})
  target_compile_definitions(kinloop_boost INTERFACE BOOST_ERROR_CODE_HEADER_ONLY BOOST_ASIO_NO_DEPRECATED)
endif()
if(KINLOOP_TESTS)
  find_package(GTest REQUIRED)
endif()
if(KINLOOP_BENCH)
  find_package(benchmark QUIET)
endif()

set(optional_parts g2o dlib rosbag ros freenect freenect2 openni2 realsense2 orbbec depthai video aruco mpi archives webp download openvdb octomap cgal python)
if(KINLOOP_MINIMAL)
  foreach(part ${optional_parts})
    set(${part}_FOUND 0)
  endforeach()
else()
  include(OptionalParts)
  foreach(part ${KINLOOP_WITHOUT})
    set(${part}_FOUND 0)
  endforeach()
endif()
foreach(part ${optional_parts})
  message(STATUS "kinloop optional part ${part}: ${${part}_FOUND}")
endforeach()
