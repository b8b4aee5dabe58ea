#include "python/bindings/arrays.hpp"

#include <memory>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"

namespace kinloop::python {
namespace {

/// An object that keeps the pixels of `image` alive.
py::capsule owner_of(const cv::Mat& image) {
  auto copy = std::make_unique<cv::Mat>(image);  // shares the pixels
  return {copy.release(), [](void* mat) { delete static_cast<cv::Mat*>(mat); }};
}

py::dtype dtype_of(int depth) {
  switch (depth) {
    case CV_8U:
      return py::dtype::of<uint8_t>();
    case CV_16U:
      return py::dtype::of<uint16_t>();
    default:
      require(depth == CV_32F, "image_view: 8-bit, 16-bit or float");
      return py::dtype::of<float>();
  }
}

template <class T>
bool is_of(const py::array& array) {
  return py::isinstance<py::array_t<T>>(array);
}

/// How the usual arrays of colour become uint8 of shape (height, width, 3); empty for others.
std::string color_remedy(const py::array& array, const std::string& name) {
  const bool grey = array.ndim() == 2 || (array.ndim() == 3 && array.shape(2) == 1);
  if (array.dtype().kind() == 'f')
    return fmt::format("; for values of 0 to 1: (255 * {}).astype(np.uint8)", name);
  if (!is_of<uint8_t>(array)) return fmt::format("; for values of 0 to 255: {}.astype(np.uint8)", name);
  if (grey) return fmt::format("; of a grey image: np.dstack([{0}, {0}, {0}])", name);
  if (array.ndim() == 3 && array.shape(2) == 4)
    return fmt::format("; without its fourth channel: {}[:, :, :3]", name);
  return "";
}

/// Same for depth.
std::string depth_remedy(const py::array& array, const std::string& name) {
  if (array.ndim() == 3) return fmt::format("; its first channel: {}[:, :, 0]", name);
  if (array.dtype().kind() == 'f') return fmt::format("; in metres: {}.astype(np.float32)", name);
  if (array.dtype().kind() == 'i' || array.dtype().kind() == 'u')
    return fmt::format("; in units of depth_scale: {}.astype(np.uint16)", name);
  return "";
}

[[noreturn]] void refuse(const char* name, const char* expected, const py::array& array,
                         const std::string& remedy) {
  throw UsageError(fmt::format("{}: expected {}, got {}{}", name, expected, describe_array(array), remedy));
}

/// Rows of aligned pixels of one element at positive strides, as OpenCV has them; other layouts are copied
/// first.
py::array with_rows(const py::array& array) {
  const py::ssize_t pixel_bytes = array.itemsize();
  const bool rows = array.strides(1) == pixel_bytes && array.strides(0) >= pixel_bytes * array.shape(1);
  const bool aligned =
      (array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0 && array.strides(0) % pixel_bytes == 0;
  if (rows && aligned) return array;
  return array.attr("copy")();
}

/// The image shares the array's memory: the caller's object must live as long.
cv::Mat mat_over(const py::array& array, int type, const void* data) {
  return {static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)), type, const_cast<void*>(data),
          static_cast<size_t>(array.strides(0))};
}

}  // namespace

py::array read_only_view(const py::dtype& type, std::vector<py::ssize_t> shape,
                         std::vector<py::ssize_t> strides, const void* data, const py::object& owner) {
  py::array array(type, std::move(shape), std::move(strides), data, owner);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

py::array image_view(const cv::Mat& image) {
  const auto element = static_cast<py::ssize_t>(image.elemSize1()),
             pixel = static_cast<py::ssize_t>(image.elemSize());
  std::vector<py::ssize_t> shape = {image.rows, image.cols};
  std::vector<py::ssize_t> strides = {static_cast<py::ssize_t>(image.step[0]), pixel};
  if (image.channels() > 1) {
    shape.push_back(image.channels());
    strides.push_back(element);
  }
  return read_only_view(dtype_of(image.depth()), shape, strides, image.data, owner_of(image));
}

py::array rgb_view(const cv::Mat& bgr) {
  require(bgr.type() == CV_8UC3, "rgb_view: 8UC3");
  return read_only_view(py::dtype::of<uint8_t>(), {bgr.rows, bgr.cols, 3},
                        {static_cast<py::ssize_t>(bgr.step[0]), 3, -1}, bgr.data + 2, owner_of(bgr));
}

std::string describe_array(const py::array& array) {
  const py::object shape = array.attr("shape");
  return fmt::format("{} of shape {}", py::str(array.dtype()).cast<std::string>(),
                     py::str(shape).cast<std::string>());
}

ArrayImage rgb_image(const py::array& rgb, const char* name) {
  if (!is_of<uint8_t>(rgb) || rgb.ndim() != 3 || rgb.shape(2) != 3)
    refuse(name, "uint8 of shape (height, width, 3), red first", rgb, color_remedy(rgb, name));
  const auto* data = static_cast<const uint8_t*>(rgb.data());
  const bool reversed = rgb.strides(2) == -1 && rgb.strides(1) == 3 && rgb.strides(0) >= 3 * rgb.shape(1);
  if (reversed) return {mat_over(rgb, CV_8UC3, data - 2), true};
  if (rgb.strides(2) != 1 || rgb.strides(1) != 3 || rgb.strides(0) < 3 * rgb.shape(1)) {
    const py::array rows = rgb.attr("copy")();
    return {mat_over(rows, CV_8UC3, rows.data()).clone(), false};
  }
  return {mat_over(rgb, CV_8UC3, data), false};
}

cv::Mat depth_image(const py::array& depth, const char* name) {
  int type = -1;
  if (is_of<float>(depth)) type = CV_32FC1;
  if (is_of<double>(depth)) type = CV_64FC1;
  if (is_of<uint16_t>(depth)) type = CV_16UC1;
  if (type < 0 || depth.ndim() != 2)
    refuse(name, "float32 (metres) or uint16 (units) of shape (height, width)", depth,
           depth_remedy(depth, name));
  const py::array rows = with_rows(depth);
  const cv::Mat image = mat_over(rows, type, rows.data());
  return rows.is(depth) ? image : image.clone();
}

cv::Mat gray_image(const py::array& image, const char* name) {
  if (is_of<uint8_t>(image) && image.ndim() == 2) {
    const py::array rows = with_rows(image);
    return mat_over(rows, CV_8UC1, rows.data()).clone();
  }
  if (!is_of<uint8_t>(image) || image.ndim() != 3 || image.shape(2) != 3)
    refuse(name, "uint8 of shape (height, width, 3), red first, or (height, width)", image,
           color_remedy(image, name));
  const ArrayImage color = rgb_image(image, name);
  cv::Mat gray;
  cv::cvtColor(color.pixels, gray, color.bgr ? cv::COLOR_BGR2GRAY : cv::COLOR_RGB2GRAY);
  return gray;
}

SE3 to_se3(const Eigen::Matrix4d& matrix, const char* name) {
  constexpr double kTolerance = 1e-4;
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const bool rigid = matrix.allFinite() && (R * R.transpose()).isIdentity(kTolerance) &&
                     R.determinant() > 0 &&
                     matrix.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), kTolerance);
  if (!rigid) throw UsageError(fmt::format("{}: expected the 4x4 matrix of a rigid motion", name));
  return {Eigen::Quaterniond(R).normalized(), matrix.topRightCorner<3, 1>()};
}

}  // namespace kinloop::python
