#pragma once
// NumPy arrays to images and poses, and back.

#include <vector>

#include <opencv2/core/mat.hpp>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>

#include "kinloop/geometry/se3.hpp"
#include "kinloop/sensor/images/color_image.hpp"
#include "python/bindings/bindings.hpp"

namespace kinloop::python {

/// Returns a read-only array over `data`, which `owner` keeps alive.
py::array read_only_view(const py::dtype& type, std::vector<py::ssize_t> shape,
                         std::vector<py::ssize_t> strides, const void* data, const py::object& owner);

/// Same for rows of `columns` numbers without gaps.
template <class T>
py::array rows_view(const T* data, size_t rows, size_t columns, const py::object& owner) {
  const auto n = static_cast<py::ssize_t>(rows), m = static_cast<py::ssize_t>(columns);
  const auto size = static_cast<py::ssize_t>(sizeof(T));
  return read_only_view(py::dtype::of<T>(), {n, m}, {m * size, size}, data, owner);
}

/// Returns the pixels of an image as an array that shares them: (H, W) or (H, W, channels).
py::array image_view(const cv::Mat& image);

/// Returns BGR pixels as RGB, without a copy: the last axis runs backwards.
py::array rgb_view(const cv::Mat& bgr);

/// What an argument is: "float32 of shape (480, 640)".
std::string describe_array(const py::array& array);

/// The memory of an array argument as an image, without a copy. `bgr`: the channels are stored in the order
/// of OpenCV.
struct ArrayImage {
  cv::Mat pixels;
  bool bgr = false;
};

/// Returns the image of an (H, W, 3) array of uint8, red first. Throws UsageError, naming the argument, for
/// another type or shape.
ArrayImage rgb_image(const py::array& rgb, const char* name);

/// Returns the image of an (H, W) array of float32, float64 or uint16. Throws UsageError, naming the
/// argument, for another type or shape.
cv::Mat depth_image(const py::array& depth, const char* name);

/// Returns a grey image, 8UC1, of an (H, W, 3) or (H, W) array of uint8.
cv::Mat gray_image(const py::array& image, const char* name);

/// Parses a 4x4 matrix. Throws UsageError unless it is a rigid motion.
SE3 to_se3(const Eigen::Matrix4d& matrix, const char* name);

}  // namespace kinloop::python
