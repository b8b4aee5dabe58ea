# The OpenCV that scripts/unpack_opencv.sh put into build/opencv. Sets what OpenCV's own file sets: OpenCV_FOUND,
# OpenCV_INCLUDE_DIRS, OpenCV_VERSION and the targets opencv_<module>.
set(unpacked ${PROJECT_SOURCE_DIR}/build/opencv)
if(NOT EXISTS ${unpacked}/version)
  return()
endif()
foreach(module core imgproc flann features2d calib3d video)
  add_library(opencv_${module} SHARED IMPORTED)
  set_target_properties(opencv_${module} PROPERTIES IMPORTED_LOCATION ${unpacked}/lib/libopencv_${module}.so)
endforeach()
# The old kind of rpath also serves what these libraries load.
set(CMAKE_INSTALL_RPATH_USE_LINK_PATH ON)
add_link_options(-Wl,--disable-new-dtags -Wl,-rpath-link,${unpacked}/lib)
set(OpenCV_INCLUDE_DIRS ${unpacked}/include/opencv4)
file(READ ${unpacked}/version OpenCV_VERSION)
string(REGEX MATCH "^[0-9.]+" OpenCV_VERSION "${OpenCV_VERSION}")
set(OpenCV_FOUND 1)
