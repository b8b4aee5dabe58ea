#include "drivers/ros/messages/ros_image.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <Eigen/Dense>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "drivers/image_files/image_file.hpp"
#include "drivers/images/encoded_image.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop {
namespace {

using Coefficients = std::array<double, 5>;  // k1, k2, p1, p2, k3

Eigen::Vector2d modified_brown_conrady(const Coefficients& c, const Eigen::Vector2d& ideal) {
  const double r2 = ideal.squaredNorm();
  const Eigen::Vector2d p = (1 + r2 * (c[0] + r2 * (c[1] + r2 * c[4]))) * ideal;
  return {p.x() + 2 * c[2] * p.x() * p.y() + c[3] * (r2 + 2 * p.x() * p.x()),
          p.y() + 2 * c[3] * p.x() * p.y() + c[2] * (r2 + 2 * p.y() * p.y())};
}

/// Fits k1, k2, p1, p2, k3 to librealsense's modified Brown-Conrady model, which multiplies the tangential
/// part with the radial factor, by least squares over the pixels of `camera`, whose own distortion is
/// ignored.
std::array<double, 5> brown_conrady_from_modified(const Coefficients& coefficients,
                                                  const PinholeCamera& camera) {
  constexpr int kSteps = 20;  // per side
  constexpr int kEquations = 2 * (kSteps + 1) * (kSteps + 1);
  Eigen::MatrixXd A(kEquations, 5);
  Eigen::VectorXd b(kEquations);
  int row = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d pixel(camera.width * i / double{kSteps}, camera.height * j / double{kSteps});
      const Eigen::Vector2d ideal((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
      const double x = ideal.x(), y = ideal.y(), r2 = ideal.squaredNorm();
      A.row(row) << x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x, x * r2 * r2 * r2;
      A.row(row + 1) << y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y, y * r2 * r2 * r2;
      b.segment<2>(row) = modified_brown_conrady(coefficients, ideal) - ideal;
      row += 2;
    }
  }
  const Eigen::VectorXd fitted = A.colPivHouseholderQr().solve(b);
  return {fitted[0], fitted[1], fitted[2], fitted[3], fitted[4]};
}

/// Wraps the message's pixels. `type` is an OpenCV type.
cv::Mat pixels_of(const RosImage& image, int type) {
  const size_t row = static_cast<size_t>(image.width) * CV_ELEM_SIZE(type);
  const bool fits = image.width > 0 && image.height > 0 && image.step >= row &&
                    image.data.size() >= image.step * static_cast<size_t>(image.height);
  if (!fits) {
    throw InputError(fmt::format("an image message of {} x {} pixels with {} bytes: truncated", image.width,
                                 image.height, image.data.size()));
  }
  if (image.step % CV_ELEM_SIZE1(type) != 0)
    throw InputError(fmt::format("an image message with rows of {} bytes, not whole values of {} bytes",
                                 image.step, CV_ELEM_SIZE1(type)));
  return {image.height, image.width, type, const_cast<uint8_t*>(image.data.data()), image.step};
}

cv::Mat converted(const cv::Mat& pixels, int code) {
  cv::Mat color;
  cv::cvtColor(pixels, color, code);
  return color;
}

[[noreturn]] void reject(const std::string& encoding, const char* known) {
  throw InputError(fmt::format("unknown encoding '{}'; expected one of {}", encoding, known));
}

cv::Mat metres_from(const cv::Mat& units, double unit_m) {
  cv::Mat depth_m;
  units.convertTo(depth_m, CV_32FC1, unit_m);
  return depth_m;
}

/// A copy of the pixels in this machine's byte order.
template <class Number>
cv::Mat native_pixels(const RosImage& image, int type) {
  cv::Mat pixels = pixels_of(image, type).clone();
  if (image.big_endian == (std::endian::native == std::endian::big)) return pixels;
  auto* first = pixels.ptr<Number>();
  std::transform(first, first + pixels.total(), first, byte_swapped<Number>);
  return pixels;
}

/// The header of compressed_depth_image_transport: how 32-bit depth was quantised.
struct DepthQuantisation {
  float a = 0, b = 0;  ///< depth = a / (value - b)
};

cv::Mat metres_from_inverse_depth(const cv::Mat& values, const DepthQuantisation& q) {
  cv::Mat depth_m(values.size(), CV_32FC1);
  for (int y = 0; y < values.rows; ++y) {
    const auto* row = values.ptr<uint16_t>(y);
    auto* metres = depth_m.ptr<float>(y);
    for (int x = 0; x < values.cols; ++x) {
      const float depth = row[x] == 0 ? 0 : q.a / (static_cast<float>(row[x]) - q.b);
      metres[x] = std::isfinite(depth) && depth > 0 ? depth : 0;
    }
  }
  return depth_m;
}

bool is_rvl(const std::string& format) {
  return format.find("rvl") != std::string::npos;
}

bool has_depth_header(const std::string& format) {
  return format.find("compressedDepth") != std::string::npos;
}

DepthQuantisation read_depth_header(ByteReader& reader) {
  reader.number<int32_t>();  // format of the quantisation; there is only one
  const auto a = reader.number<float>();
  return {a, reader.number<float>()};
}

cv::Size read_rvl_size(ByteReader& reader) {
  const auto cols = reader.number<uint32_t>(), rows = reader.number<uint32_t>();
  constexpr uint32_t kMaxSide = 1U << 15;
  if (cols > kMaxSide || rows > kMaxSide)
    throw InputError(fmt::format("RVL depth claims {} x {} pixels", cols, rows));
  return {static_cast<int>(cols), static_cast<int>(rows)};
}

/// The content of compressed_depth_image_transport behind its header: a 16-bit PNG, or RVL with its size.
cv::Mat compressed_depth_values(const std::string& format, Bytes data) {
  if (!is_rvl(format)) return decode_embedded_image(data);
  ByteReader reader(data);
  const cv::Size size = read_rvl_size(reader);
  return decode_rvl(reader.block(reader.left()), size);
}

bool has_prefix_of(const std::vector<double>& coefficients, size_t count) {
  return coefficients.size() >= count &&
         std::all_of(coefficients.begin() + static_cast<std::ptrdiff_t>(count), coefficients.end(),
                     [](double d) { return d == 0; });
}

/// The lens of a raw image; `camera` has the other parameters.
LensDistortion lens_of(const RosCameraInfo& info, const PinholeCamera& camera) {
  const std::string& model = info.distortion_model;
  std::vector<double> d = info.D;
  if (model == "rational_polynomial" && has_prefix_of(d, 8))  // behind them: thin prism and tilt
    return lens_with(LensModel::kRational, std::span(d).first(8));
  if ((model == "equidistant" || model == "fisheye" || model == "Kannala Brandt4") && has_prefix_of(d, 4))
    return lens_with(LensModel::kKannalaBrandt, std::span(d).first(4));
  std::array<double, 5> brown{};
  if (d.size() <= brown.size()) std::copy(d.begin(), d.end(), brown.begin());
  if (model == "Inverse Brown Conrady" || model == "Modified Brown Conrady") {
    // The SDK projects by the same formula for both, and (since 2021) inverts it to unproject.
    return lens_with(LensModel::kBrownConrady, brown_conrady_from_modified(brown, camera));
  }
  if ((model != "plumb_bob" && model != "Brown Conrady" && !model.empty()) || d.size() > brown.size()) {
    throw InputError(
        fmt::format("the camera_info message has the distortion model '{}' with {} coefficients; plumb_bob, "
                    "rational_polynomial and equidistant are supported: use --camera FILE",
                    model, d.size()));
  }
  return lens_with(LensModel::kBrownConrady, brown);
}

}  // namespace

cv::Mat color_from(const RosImage& image) {
  const std::string& e = image.encoding;
  if (e == "bgr8" || e == "8UC3") return pixels_of(image, CV_8UC3).clone();
  if (e == "rgb8") return converted(pixels_of(image, CV_8UC3), cv::COLOR_RGB2BGR);
  if (e == "bgra8" || e == "8UC4") return converted(pixels_of(image, CV_8UC4), cv::COLOR_BGRA2BGR);
  if (e == "rgba8") return converted(pixels_of(image, CV_8UC4), cv::COLOR_RGBA2BGR);
  if (e == "mono8" || e == "8UC1") return converted(pixels_of(image, CV_8UC1), cv::COLOR_GRAY2BGR);
  if (e == "yuv422" || e == "uyvy" || e == "UYVY")
    return converted(pixels_of(image, CV_8UC2), cv::COLOR_YUV2BGR_UYVY);
  if (e == "yuv422_yuy2" || e == "yuyv" || e == "YUYV")
    return converted(pixels_of(image, CV_8UC2), cv::COLOR_YUV2BGR_YUY2);
  reject(e, "bgr8, rgb8, bgra8, rgba8, mono8, yuv422, yuv422_yuy2");
}

cv::Mat depth_from(const RosImage& image, double unit_m) {
  const std::string& e = image.encoding;
  if (e == "16UC1" || e == "mono16") return metres_from(native_pixels<uint16_t>(image, CV_16UC1), unit_m);
  if (e == "32FC1") return without_impossible_depth(native_pixels<float>(image, CV_32FC1));
  reject(e, "16UC1, 32FC1");
}

ColorImage color_from_compressed(std::span<const uint8_t> data) {
  return decode_embedded_color(data);
}

cv::Mat depth_from_compressed(const std::string& format, std::span<const uint8_t> data, double unit_m) {
  ByteReader reader(data);
  DepthQuantisation quantisation;
  const bool has_header = has_depth_header(format);
  if (has_header) quantisation = read_depth_header(reader);
  const cv::Mat values = compressed_depth_values(format, reader.block(reader.left()));
  if (values.type() != CV_16UC1)
    throw InputError(fmt::format("compressed depth '{}' that is not a 16-bit grey PNG", format));
  if (has_header && format.starts_with("32FC1")) return metres_from_inverse_depth(values, quantisation);
  return metres_from(values, unit_m);
}

std::optional<cv::Size> compressed_size(const std::string& format, std::span<const uint8_t> data) {
  ByteReader reader(data);
  if (has_depth_header(format)) read_depth_header(reader);
  if (is_rvl(format)) return read_rvl_size(reader);
  return encoded_size(as_text(reader.block(reader.left())));
}

PinholeCamera camera_from(const RosCameraInfo& info, bool rectified) {
  PinholeCamera camera;
  camera.width = info.width, camera.height = info.height;
  if (rectified && info.P[0] > 0) {
    camera.fx = info.P[0], camera.fy = info.P[5], camera.cx = info.P[2], camera.cy = info.P[6];
  } else {
    camera.fx = info.K[0], camera.fy = info.K[4], camera.cx = info.K[2], camera.cy = info.K[5];
  }
  if (!(camera.fx > 0) || !(camera.fy > 0) || camera.width <= 0 || camera.height <= 0) {
    throw InputError("the camera_info message is of an uncalibrated camera; use --camera FILE");
  }
  const bool fisheye = info.distortion_model == "equidistant";  // distorts even if all coefficients are 0
  const bool ideal = !fisheye && std::all_of(info.D.begin(), info.D.end(), [](double d) { return d == 0; });
  if (!rectified && !ideal && info.distortion_model != "None") camera.lens = lens_of(info, camera);
  return camera;
}

}  // namespace kinloop
