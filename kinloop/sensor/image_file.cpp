#include "kinloop/sensor/image_file.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/text_file.hpp"
#include "kinloop/sensor/fast_decoders.hpp"
#include "kinloop/sensor/fast_encoder.hpp"
#include "kinloop/sensor/jpeg_codec.hpp"

namespace kinloop {
namespace {

using namespace std::string_view_literals;

constexpr auto kPngSignature = "\x89PNG\r\n\x1a\n"sv;
constexpr auto kJpegSignature = "\xff\xd8\xff"sv;
constexpr auto kCutShort = "the file is truncated; copy it again"sv;
constexpr auto kDamaged = "the file is damaged; copy it again"sv;

/// Reads a big-endian number of `size` bytes.
size_t big_endian(std::string_view bytes, size_t position, size_t size) {
  size_t value = 0;
  for (size_t i = 0; i < size; ++i) value = (value << 8) | static_cast<uint8_t>(bytes[position + i]);
  return value;
}

/// Walks the chunks (length, type, data, checksum) up to IEND (PNG specification, section 5.3).
std::string_view png_damage(std::string_view bytes) {
  constexpr size_t kFrame = 12;  // length, type and checksum
  size_t position = kPngSignature.size();
  while (position + kFrame <= bytes.size()) {
    const size_t length = big_endian(bytes, position, 4);
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
      const size_t length = big_endian(bytes, position + 2, 2);
      if (length < 2) return kDamaged;
      position += 2 + length;
      if (position > bytes.size()) return kCutShort;
    }
  }
}

/// Tries the fast decoders first, then OpenCV for other or damaged images.
cv::Mat decode_any(const std::string& bytes) {
  cv::Mat image = bytes.starts_with(kPngSignature) ? decode_depth_png(bytes) : decode_jpeg(bytes);
  if (!image.empty()) return image;
  const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
  return cv::imdecode(buffer, cv::IMREAD_UNCHANGED);
}

[[noreturn]] void fail(const std::filesystem::path& path, std::string_view why) {
  throw InputError(fmt::format("{}: {}", path.string(), why));
}

std::string read_intact_file(const std::filesystem::path& path) {
  std::string bytes = read_file(path);
  if (const auto damage = image_damage(bytes); !damage.empty()) fail(path, damage);
  if (bytes.size() > static_cast<size_t>(std::numeric_limits<int>::max()))
    fail(path, "the file is too large");
  return bytes;
}

cv::Mat decode(const std::filesystem::path& path, const std::string& bytes) {
  cv::Mat image;
  try {
    image = decode_any(bytes);
  } catch (const cv::Exception& error) {
    fail(path, fmt::format("cannot be decoded: {}", error.err));
  }
  if (image.empty()) fail(path, kDamaged);
  return image;
}

}  // namespace

std::string_view image_damage(std::string_view bytes) {
  if (bytes.empty()) return "the file is empty; copy it again";
  if (bytes.starts_with(kPngSignature)) return png_damage(bytes);
  if (bytes.starts_with(kJpegSignature)) return jpeg_damage(bytes);
  return "neither a PNG nor a JPEG image";
}

ColorImage read_color_image(const std::filesystem::path& path) {
  std::string bytes = read_intact_file(path);
  if (bytes.starts_with(kJpegSignature)) {
    auto jpeg = ColorImage::from_jpeg(std::move(bytes));
    if (!jpeg) fail(path, kDamaged);
    return *std::move(jpeg);
  }
  cv::Mat image = decode(path, bytes);
  cv::Mat color;
  switch (image.type()) {
    case CV_8UC3:
      return image;
    case CV_8UC1:
      cv::cvtColor(image, color, cv::COLOR_GRAY2BGR);
      return color;
    case CV_8UC4:
      cv::cvtColor(image, color, cv::COLOR_BGRA2BGR);
      return color;
    default:
      throw ImageFormatError(
          fmt::format("{}: not 8 bits per channel, as colour images are; is this a depth image (colour comes "
                      "first in associations.txt)?",
                      path.string()));
  }
}

cv::Mat read_depth_image(const std::filesystem::path& path, double depth_scale) {
  constexpr uint16_t kUnknown = std::numeric_limits<uint16_t>::max();
  cv::Mat image = decode(path, read_intact_file(path));
  if (image.type() != CV_16UC1) {
    throw ImageFormatError(
        fmt::format("{}: not a 16-bit grey PNG, as depth images are ({} bits, {} channels); export depth as "
                    "16-bit PNG",
                    path.string(), 8 * image.elemSize1(), image.channels()));
  }
  image.setTo(0, image == kUnknown);
  cv::Mat depth_m;
  image.convertTo(depth_m, CV_32FC1, 1.0 / depth_scale);
  return depth_m;
}

void write_png(const std::filesystem::path& path, const cv::Mat& image) {
  write_file(path, encode_png(image));
}

void write_depth_png(const std::filesystem::path& path, const cv::Mat& depth_m, double depth_scale) {
  cv::Mat units;
  depth_m.convertTo(units, CV_16UC1, depth_scale);
  units.setTo(0, units == std::numeric_limits<uint16_t>::max());
  write_png(path, units);
}

}  // namespace kinloop
