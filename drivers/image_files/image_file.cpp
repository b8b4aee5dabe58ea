#include "drivers/image_files/image_file.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "drivers/image_files/bmp.hpp"
#include "drivers/image_files/fast_encoder.hpp"
#include "drivers/image_files/jpeg_header.hpp"
#include "drivers/image_files/netpbm.hpp"
#include "drivers/image_files/png.hpp"
#include "drivers/image_files/tiff_bytes.hpp"
#include "drivers/image_files/tiff_file.hpp"
#include "drivers/image_files/webp.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/sensor/images/image_limits.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"

namespace kinloop {
namespace {

using namespace std::string_view_literals;

constexpr auto kPngSignature = "\x89PNG\r\n\x1a\n"sv;
constexpr auto kJpegSignature = "\xff\xd8\xff"sv;
constexpr auto kCutShort = "the file is truncated; copy it again"sv;
constexpr auto kDamaged = "the file is damaged; copy it again"sv;

std::optional<cv::Size> netpbm_size(std::string_view bytes) {
  const auto header = parse_netpbm_header(bytes);
  return header ? std::optional(cv::Size(header->width, header->height)) : std::nullopt;
}

std::optional<cv::Size> tiff_size_or_nothing(std::string_view bytes) {
  try {
    return color_tiff_size(bytes);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

cv::Mat tiff_or_nothing(std::string_view bytes) {
  try {
    return decode_color_tiff(bytes);
  } catch (const InputError&) {
    return {};
  }
}

/// A format without a need for speed: its decoder finds what is damaged.
struct OtherFormat {
  bool (*is)(std::string_view bytes);
  std::optional<cv::Size> (*size)(std::string_view bytes);
  cv::Mat (*decode)(std::string_view bytes);
};

constexpr std::array kOtherFormats = {
    OtherFormat{is_netpbm, netpbm_size, decode_netpbm},
    OtherFormat{is_bmp, bmp_size, decode_bmp},
    OtherFormat{is_any_tiff, tiff_size_or_nothing, tiff_or_nothing},
    OtherFormat{is_webp, webp_size, decode_webp},
};

const OtherFormat* other_format(std::string_view bytes) {
  const auto* found = std::find_if(kOtherFormats.begin(), kOtherFormats.end(),
                                   [&](const OtherFormat& format) { return format.is(bytes); });
  return found == kOtherFormats.end() ? nullptr : found;
}

/// Walks the chunks (length, type, data, checksum) up to IEND (PNG specification, section 5.3).
std::string_view png_damage(std::string_view bytes) {
  constexpr size_t kFrame = 12;  // length, type and checksum
  size_t position = kPngSignature.size();
  while (position + kFrame <= bytes.size()) {
    const size_t length = big_endian_at<uint32_t>(bytes, position);
    if (length > bytes.size() - position - kFrame) return kCutShort;
    if (bytes.substr(position + 4, 4) == "IEND") return {};
    position += kFrame + length;
  }
  return kCutShort;
}

/// Walks the segments and the entropy-coded data between them up to the end-of-image marker (ITU T.81, annex
/// B.1). In entropy-coded data, 0xff is followed by 0 (a stuffed byte) or by a restart marker.
std::string_view jpeg_damage(std::string_view bytes) {
  constexpr uint8_t kFirstRestart = 0xd0, kLastRestart = 0xd7, kEndOfImage = 0xd9, kTemporary = 0x01,
                    kFill = 0xff;
  size_t position = 2;  // after the start-of-image marker
  while (true) {
    position = bytes.find('\xff', position);
    if (position == std::string_view::npos || position + 1 >= bytes.size()) return kCutShort;
    const auto marker = static_cast<uint8_t>(bytes[position + 1]);
    if (marker == kEndOfImage) return {};
    if (marker == kFill) {
      position += 1;
    } else if (marker == 0 || marker == kTemporary || (marker >= kFirstRestart && marker <= kLastRestart)) {
      position += 2;
    } else {  // a segment with a length, which includes the length field
      if (position + 4 > bytes.size()) return kCutShort;
      const size_t length = big_endian_at<uint16_t>(bytes, position + 2);
      if (length < 2) return kDamaged;
      position += 2 + length;
      if (position > bytes.size()) return kCutShort;
    }
  }
}

[[noreturn]] void fail(const std::filesystem::path& path, std::string_view why) {
  throw InputError(fmt::format("{}: {}", path.string(), why));
}

void require_intact(const std::string& bytes, const std::filesystem::path& path) {
  if (const auto damage = image_damage(bytes); !damage.empty()) fail(path, damage);
}

cv::Mat decode(const std::filesystem::path& path, const std::string& bytes) {
  cv::Mat image = decode_image(bytes);
  if (image.empty()) fail(path, kDamaged);
  return image;
}

cv::Mat bgr_from(const cv::Mat& image) {
  if (image.channels() == 3) return image;
  cv::Mat bgr;
  cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
  return bgr;
}

}  // namespace

cv::Mat decode_image(std::string_view bytes) {
  if (bytes.starts_with(kPngSignature)) return decode_png(bytes);
  if (bytes.starts_with(kJpegSignature)) return decode_jpeg(bytes);
  const auto* other = other_format(bytes);
  return other == nullptr ? cv::Mat() : other->decode(bytes);
}

std::optional<cv::Size> encoded_size(std::string_view bytes) {
  if (bytes.starts_with(kJpegSignature)) return jpeg_size(bytes);
  if (const auto* other = other_format(bytes)) return other->size(bytes);
  constexpr size_t kType = 12, kWidth = 16, kHeight = 20, kEnd = 24;  // IHDR comes first
  if (!bytes.starts_with(kPngSignature) || bytes.size() < kEnd || bytes.substr(kType, 4) != "IHDR")
    return std::nullopt;
  const auto width = big_endian_at<uint32_t>(bytes, kWidth), height = big_endian_at<uint32_t>(bytes, kHeight);
  if (width > kMaxPngSide_px || height > kMaxPngSide_px) return std::nullopt;
  return cv::Size(static_cast<int>(width), static_cast<int>(height));
}

std::string_view image_damage(std::string_view bytes) {
  if (bytes.empty()) return "the file is empty; copy it again";
  if (bytes.starts_with(kPngSignature)) return png_damage(bytes);
  if (bytes.starts_with(kJpegSignature)) {
    constexpr int kCmyk = 4;
    return jpeg_components(bytes) == kCmyk ? "a CMYK image; convert it to RGB" : jpeg_damage(bytes);
  }
  if (is_webp(bytes) && !webp_available())
    return "a WebP image, which this build cannot read; convert it to PNG or JPEG, or install "
           "libwebp-dev and build again";
  return other_format(bytes) == nullptr ? kNoImage : std::string_view();
}

std::string turned_by_exif(std::string_view bytes) {
  if (!bytes.starts_with(kJpegSignature)) return {};
  const int orientation = exif_orientation(bytes);
  if (orientation == 1) return {};
  return fmt::format(
      "its EXIF orientation is {}, so that viewers turn it, but not depth or the camera; turn the pixels, "
      "depth and the camera alike, or remove the tag if they fit the pixels as stored",
      orientation);
}

bool is_color_of_16_bits(std::string_view bytes) {
  constexpr size_t kBitDepth = 24, kColorType = 25;  // after the size, which encoded_size finds
  constexpr char kSixteen = 16, kRgb = 2, kRgba = 6;
  if (!bytes.starts_with(kPngSignature) || bytes.size() <= kColorType || !encoded_size(bytes)) return false;
  return bytes[kBitDepth] == kSixteen && (bytes[kColorType] == kRgb || bytes[kColorType] == kRgba);
}

cv::Mat with_8_bits(const cv::Mat& image) {
  constexpr double kPerValue = 255.0 / 65535;
  if (image.depth() != CV_16U) return image;
  cv::Mat scaled;
  image.convertTo(scaled, CV_8U, kPerValue);
  return scaled;
}

ColorImage read_color_image(const std::filesystem::path& path) {
  return decode_color_image(read_image_bytes(path), path);
}

cv::Mat read_depth_image(const std::filesystem::path& path, double depth_scale) {
  return decode_depth_image(read_image_bytes(path), path, depth_scale);
}

std::string read_image_bytes(const std::filesystem::path& path) {
  std::error_code absent;
  const uint64_t size = std::filesystem::file_size(path, absent);
  if (!absent && size > kMaxEncodedBytes)
    fail(path, fmt::format("{} bytes, where an image has at most {}", size, kMaxEncodedBytes));
  return read_file(path);
}

ColorImage decode_color_image(std::string bytes, const std::filesystem::path& path) {
  require_intact(bytes, path);
  if (bytes.starts_with(kJpegSignature)) {
    auto jpeg = ColorImage::from_jpeg(std::move(bytes));
    if (!jpeg) fail(path, kDamaged);
    return *std::move(jpeg);
  }
  const cv::Mat image = decode(path, bytes);
  if (image.type() == CV_16UC1) {
    throw ImageFormatError(
        fmt::format("{}: grey of 16 bits, not colour; is this a depth image (colour comes first in "
                    "associations.txt)?",
                    path.string()));
  }
  return bgr_from(with_8_bits(image));
}

cv::Mat decode_depth_image(const std::string& bytes, const std::filesystem::path& path, double depth_scale) {
  require_intact(bytes, path);
  const cv::Mat image = decode(path, bytes);
  if (image.type() != CV_16UC1) {
    throw ImageFormatError(
        fmt::format("{}: not a 16-bit grey PNG, as depth images are ({} bits, {} channels); export depth as "
                    "16-bit PNG",
                    path.string(), 8 * image.elemSize1(), image.channels()));
  }
  return from_depth_units(image, depth_scale);
}

void write_png(const std::filesystem::path& path, const cv::Mat& image) {
  write_file(path, encode_png(image), Durability::kWithTheOthers);
}

cv::Mat to_depth_units(const cv::Mat& depth_m, double depth_scale) {
  cv::Mat units;
  depth_m.convertTo(units, CV_16UC1, depth_scale);
  units.setTo(0, units == std::numeric_limits<uint16_t>::max());
  return units;
}

/// In one pass without branches, so that it is vectorised.
cv::Mat from_depth_units(const cv::Mat& units, double depth_scale) {
  constexpr uint16_t kUnknown = std::numeric_limits<uint16_t>::max();
  const auto metres_per_unit = static_cast<float>(1.0 / depth_scale);
  cv::Mat depth_m(units.size(), CV_32FC1);
  for (int y = 0; y < units.rows; ++y) {
    const auto* in = units.ptr<uint16_t>(y);
    auto* out = depth_m.ptr<float>(y);
    for (int x = 0; x < units.cols; ++x)
      out[x] = static_cast<float>(in[x] == kUnknown ? 0 : in[x]) * metres_per_unit;
  }
  return depth_m;
}

void write_depth_png(const std::filesystem::path& path, const cv::Mat& depth_m, double depth_scale) {
  write_png(path, to_depth_units(depth_m, depth_scale));
}

}  // namespace kinloop
