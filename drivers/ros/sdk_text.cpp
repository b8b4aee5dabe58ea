#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "drivers/ros/realsense_bag.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

/// The value of a key in "key=value;key=value".
std::string_view field(std::string_view text, std::string_view key) {
  while (!text.empty()) {
    const std::string_view entry = text.substr(0, text.find(';'));
    text.remove_prefix(std::min(entry.size() + 1, text.size()));
    const size_t equals = entry.find('=');
    if (equals != std::string_view::npos && entry.substr(0, equals) == key) return entry.substr(equals + 1);
  }
  throw InputError(fmt::format("a message of the RealSense SDK without '{}'", key));
}

double number_field(std::string_view text, std::string_view key) {
  return sdk_number(field(text, key));
}

int size_field(std::string_view text, std::string_view key) {
  constexpr double kMaxSize = 65535;
  const double size = number_field(text, key);
  if (!(size >= 1 && size <= kMaxSize)) throw InputError("a camera of impossible size");
  return static_cast<int>(size);
}

std::vector<double> list_field(std::string_view text, std::string_view key) {
  std::string_view list = field(text, key);
  std::vector<double> numbers;
  while (true) {
    const size_t comma = list.find(',');
    numbers.push_back(sdk_number(list.substr(0, comma)));
    if (comma == std::string_view::npos) return numbers;
    list.remove_prefix(comma + 1);
  }
}

}  // namespace

double sdk_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw InputError(fmt::format("'{}' is not a number", text));
  return value;
}

RosCameraInfo sdk_camera_info(std::string_view text) {
  RosCameraInfo info;
  info.width = size_field(text, "width");
  info.height = size_field(text, "height");
  info.distortion_model = field(text, "model");
  info.D = list_field(text, "coeffs");
  info.K = {number_field(text, "fx"),
            0,
            number_field(text, "ppx"),
            0,
            number_field(text, "fy"),
            number_field(text, "ppy"),
            0,
            0,
            1};
  return info;
}

SE3 sdk_pose(std::string_view text) {
  const auto columns = list_field(text, "rotation"), translation = list_field(text, "translation");
  constexpr double kTolerance = 1e-3;  // six decimals are written
  if (columns.size() == 9 && translation.size() == 3) {
    const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix3d>(columns.data());
    if ((R * R.transpose() - Eigen::Matrix3d::Identity()).norm() < kTolerance && R.determinant() > 0)
      return {Eigen::Quaterniond(R).normalized(), Eigen::Map<const Eigen::Vector3d>(translation.data())};
  }
  throw InputError("a pose that is not a rigid motion");
}

int64_t sdk_stamp_ns(std::string_view text) {
  constexpr double kNsPerMs = 1e6;
  const double stamp_ms = number_field(text, "timestamp"), whole_ms = std::floor(stamp_ms);
  if (std::abs(stamp_ms) > kMaxStampNs / kNsPerMs) throw InputError("an impossible timestamp");
  // In two parts: a double of nanoseconds since 1970 has steps of 256.
  return checked_stamp_ns(static_cast<int64_t>(whole_ms) * static_cast<int64_t>(kNsPerMs) +
                          std::llround((stamp_ms - whole_ms) * kNsPerMs));
}

}  // namespace kinloop
