#include "drivers/datasets/reading/matrix_text.hpp"

#include <charconv>
#include <cmath>

#include <Eigen/LU>
#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {

SE3 from_arkit(const SE3& T_world_arkit) {
  static const SE3 kHalfTurnAboutX{Eigen::Quaterniond(0, 1, 0, 0), Eigen::Vector3d::Zero()};
  return T_world_arkit * kHalfTurnAboutX;
}

std::optional<SE3> rigid_motion(const Eigen::Matrix4d& matrix) {
  constexpr double kTolerance = 1e-2;  // some datasets write few digits
  if (!matrix.allFinite()) return std::nullopt;
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const double error = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (error > kTolerance || R.determinant() < 0) return std::nullopt;
  return SE3{Eigen::Quaterniond(R).normalized(), matrix.topRightCorner<3, 1>()};
}

std::optional<Eigen::Matrix4d> matrix_of(std::span<const double> rows) {
  constexpr size_t kThreeRows = 12, kFourRows = 16;
  if (rows.size() != kThreeRows && rows.size() != kFourRows) return std::nullopt;
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (size_t i = 0; i < rows.size(); ++i)
    matrix(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = rows[i];
  return matrix;
}

std::optional<SE3> motion_of(std::span<const double> v) {
  constexpr size_t kPose = 7;
  constexpr double kMinNorm = 1e-6;
  require(v.size() == kPose, "motion_of: expected seven numbers");
  SE3 T{Eigen::Quaterniond(v[6], v[3], v[4], v[5]), {v[0], v[1], v[2]}};
  if (!T.is_finite() || T.rotation.norm() < kMinNorm) return std::nullopt;
  T.rotation.normalize();
  return T;
}

namespace {

bool is_separator(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ',';
}

}  // namespace

std::vector<double> read_numbers(const std::filesystem::path& file) {
  require_size(file, kMostListBytes);
  const std::string text = read_file(file);
  std::vector<double> numbers;
  size_t line = 1;
  const char* at = text.data();
  const char* end = at + text.size();
  while (at != end) {
    if (is_separator(*at)) {
      line += *at == '\n' ? 1 : 0;
      ++at;
      continue;
    }
    double value = 0;
    const auto [next, error] = std::from_chars(*at == '+' ? at + 1 : at, end, value);
    if (error != std::errc() || (next != end && !is_separator(*next))) {
      const std::string_view rest(at, static_cast<size_t>(end - at));
      const std::string_view word = rest.substr(0, std::min<size_t>(rest.find_first_of(" \t\r\n,"), 20));
      throw_parse_error(file, line, fmt::format("'{}' is not a number; correct the file", word));
    }
    numbers.push_back(value);
    at = next;
  }
  return numbers;
}

Eigen::Matrix4d read_matrix(const std::filesystem::path& file) {
  const auto matrix = matrix_of(read_numbers(file));
  if (!matrix)
    throw InputError(fmt::format("{}: not a matrix of 12 or 16 numbers; copy it again", file.string()));
  return *matrix;
}

PinholeCamera read_lens(const std::filesystem::path& file, cv::Size size) {
  constexpr size_t k3x3 = 9, k4x4 = 16;
  const auto k = read_numbers(file);
  if (k.size() != k3x3 && k.size() != k4x4) {
    throw InputError(
        fmt::format("{}: {} numbers where intrinsics have 9 or 16; copy it again", file.string(), k.size()));
  }
  const size_t columns = k.size() == k3x3 ? 3 : 4;
  return checked_lens(make_lens(size, k[0], k[columns + 1], k[2], k[columns + 2]), file);
}

PinholeCamera checked_lens(const PinholeCamera& lens, const std::filesystem::path& file) {
  constexpr double kWidest = 0.1, kLongest = 20;  // focal length as a share of the width
  const auto plausible = [&](double focal) {
    return focal > kWidest * lens.width && focal < kLongest * lens.width;
  };
  const bool centred = lens.cx > 0 && lens.cy > 0 && lens.cx < lens.width && lens.cy < lens.height;
  if (plausible(lens.fx) && plausible(lens.fy) && centred) return lens;
  throw InputError(
      fmt::format("{}: fx {}, fy {}, cx {}, cy {} cannot be those of a camera of {} x {}; correct it",
                  file.string(), lens.fx, lens.fy, lens.cx, lens.cy, lens.width, lens.height));
}

bool is_plausible_size(double width, double height) {
  constexpr double kMax_px = 30'000, kMaxPixels = 1 << 26;
  return width >= 1 && width <= kMax_px && height >= 1 && height <= kMax_px && width * height <= kMaxPixels;
}

cv::Size checked_size(double width, double height, const std::filesystem::path& file) {
  if (!is_plausible_size(width, height))
    throw InputError(fmt::format("{}: images of {} x {}; correct it", file.string(), width, height));
  return {static_cast<int>(width), static_cast<int>(height)};
}

PinholeCamera make_lens(cv::Size size, double fx, double fy, double cx, double cy) {
  PinholeCamera lens;
  lens.width = size.width;
  lens.height = size.height;
  lens.fx = fx, lens.fy = fy, lens.cx = cx, lens.cy = cy;
  return lens;
}

}  // namespace kinloop
