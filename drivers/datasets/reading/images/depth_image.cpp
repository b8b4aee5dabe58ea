#include "drivers/datasets/reading/images/depth_image.hpp"

#include <bit>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "drivers/image_files/image_file.hpp"
#include "drivers/image_files/netpbm.hpp"
#include "drivers/images/depth_files/depth_file.hpp"
#include "drivers/images/depth_files/inflate.hpp"
#include "drivers/images/encoded_image.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {

namespace {

static_assert(std::endian::native == std::endian::little, "raw depth is little-endian");

[[noreturn]] void reject_depth(const std::filesystem::path& file, const std::string& why) {
  throw InputError(fmt::format("{}: {}", file.string(), why));
}

size_t pixels_of(cv::Size size) {
  return static_cast<size_t>(size.width) * static_cast<size_t>(size.height);
}

void require_length(const std::string& bytes, size_t expected, const std::filesystem::path& file) {
  if (bytes.size() == expected) return;
  reject_depth(file, fmt::format("a depth image of {} bytes where the camera's size needs {}; copy it again",
                                 bytes.size(), expected));
}

cv::Mat raw_units(const std::string& bytes, cv::Size size, const std::filesystem::path& file) {
  require_length(bytes, pixels_of(size) * sizeof(uint16_t), file);
  cv::Mat units(size, CV_16UC1);
  std::memcpy(units.data, bytes.data(), bytes.size());
  return units;
}

std::string inflated(const std::string& bytes, size_t size, const std::filesystem::path& file) {
  try {
    return inflate_zlib(bytes, size);
  } catch (const InputError& error) {
    reject_depth(file, error.what());
  }
}

cv::Mat raw_metres(const std::string& bytes, cv::Size size, const std::filesystem::path& file) {
  require_length(bytes, pixels_of(size) * sizeof(float), file);
  cv::Mat depth_m(size, CV_32FC1);
  std::memcpy(depth_m.data, bytes.data(), bytes.size());
  return without_impossible_depth(depth_m);
}

cv::Mat in_metres(const cv::Mat& numbers, double depth_scale) {
  if (numbers.type() == CV_16UC1) return from_depth_units(numbers, depth_scale);
  cv::Mat depth_m;
  numbers.convertTo(depth_m, CV_32F, 1 / depth_scale);
  return without_impossible_depth(depth_m);
}

/// PNG is left to the caller, which has the fastest decoder for it.
cv::Mat decode_numbers(const std::string& bytes, const std::filesystem::path& file) {
  try {
    if (is_depth_file(bytes)) return decode_depth_file(bytes);
  } catch (const InputError& error) {
    reject_depth(file, error.what());
  }
  cv::Mat units = decode_netpbm(bytes);
  if (units.empty()) reject_depth(file, "the PGM is truncated or damaged; copy it again");
  if (units.type() != CV_16UC1)
    throw ImageFormatError(fmt::format("{}: a PGM of 8 bits; export depth with 16 bits", file.string()));
  return units;
}

bool is_depth_of_numbers(std::string_view bytes) {
  return bytes.starts_with("P5") || is_depth_file(bytes);
}

}  // namespace

bool has_float_depth(const std::string& bytes, const std::filesystem::path& file) {
  return is_depth_file(bytes) && decode_numbers(bytes, file).type() == CV_32FC1;
}

cv::Mat decode_depth(const std::string& bytes, const std::filesystem::path& file, DepthEncoding encoding,
                     cv::Size size, double depth_scale) {
  switch (encoding) {
    case DepthEncoding::kRawUint16:
      return from_depth_units(raw_units(bytes, size, file), depth_scale);
    case DepthEncoding::kZlibUint16:
      return from_depth_units(
          raw_units(inflated(bytes, pixels_of(size) * sizeof(uint16_t), file), size, file), depth_scale);
    case DepthEncoding::kRawFloat32:
      return raw_metres(bytes, size, file);
    case DepthEncoding::kFloatImage:
      if (!is_depth_file(bytes))
        reject_depth(file, "not a depth image of floats, or truncated; copy it again");
      return in_metres(decode_numbers(bytes, file), 1);
    case DepthEncoding::kImage:
      break;
  }
  return is_depth_of_numbers(bytes) ? in_metres(decode_numbers(bytes, file), depth_scale)
                                    : decode_depth_image(bytes, file, depth_scale);
}

cv::Mat read_confidence_image(const std::filesystem::path& file, cv::Size size) {
  const std::string bytes = read_image_bytes(file);
  const auto damage = image_damage(bytes);
  if (!damage.empty()) reject_depth(file, std::string(damage));
  if (const auto found = encoded_size(bytes); found && *found != size) {
    reject_depth(file, fmt::format("{} x {} pixels where depth has {} x {}", found->width, found->height,
                                   size.width, size.height));
  }
  cv::Mat image = decode_image(bytes);
  if (image.empty()) reject_depth(file, "the file is damaged; copy it again");
  if (image.type() != CV_8UC1) reject_depth(file, "not an 8-bit grey image, as confidence is");
  return image;
}

}  // namespace kinloop
