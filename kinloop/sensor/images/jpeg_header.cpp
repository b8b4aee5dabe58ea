#include "kinloop/sensor/images/jpeg_header.hpp"

#include <cstdint>
#include <optional>

#include "kinloop/core/files/byte_reader.hpp"

namespace kinloop {
namespace {

using namespace std::string_view_literals;

/// A segment of the header: its marker, and what follows its length (ITU T.81, annex B.1).
struct JpegSegment {
  uint8_t marker = 0;
  std::string_view content;
};

/// Calls `take` with each segment before the compressed data, until it returns true.
template <class Take>
void for_each_segment(std::string_view bytes, const Take& take) {
  constexpr uint8_t kFill = 0xff, kStartOfScan = 0xda;
  constexpr size_t kLengthBytes = 2;
  for (size_t position = 2; position + 2 + kLengthBytes <= bytes.size();) {
    if (static_cast<uint8_t>(bytes[position]) != kFill) return;
    const auto marker = static_cast<uint8_t>(bytes[position + 1]);
    if (marker == kFill) {
      ++position;
      continue;
    }
    const size_t length = big_endian_at<uint16_t>(bytes, position + 2);
    if (marker == kStartOfScan || length < kLengthBytes || length > bytes.size() - position - 2) return;
    if (take(JpegSegment{marker, bytes.substr(position + 2 + kLengthBytes, length - kLengthBytes)})) return;
    position += 2 + length;
  }
}

/// The frame header, of any kind of compression: not a table of Huffman or arithmetic codes, or reserved.
bool is_frame_header(uint8_t marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/// Numbers of a TIFF file, in its own byte order.
class TiffNumbers {
 public:
  /// `tiff` begins with its byte order.
  explicit TiffNumbers(std::string_view tiff) : tiff_(tiff), little_(tiff.starts_with("II")) {}

  /// Returns a number; nullopt beyond the end.
  template <class Number>
  [[nodiscard]] std::optional<Number> at(size_t position) const {
    if (position > tiff_.size() || tiff_.size() - position < sizeof(Number)) return std::nullopt;
    const auto big = big_endian_at<Number>(tiff_, position);
    return little_ ? byte_swapped(big) : big;
  }

 private:
  std::string_view tiff_;
  bool little_;
};

/// The orientation in the first directory of a TIFF file (TIFF 6.0, section 2).
std::optional<int> tiff_orientation(std::string_view tiff) {
  constexpr size_t kDirectoryOffset = 4, kCountBytes = 2, kEntryBytes = 12, kTypeAt = 2, kValueAt = 8;
  constexpr uint16_t kOrientation = 274, kShort = 3;
  if (!tiff.starts_with("II*\0"sv) && !tiff.starts_with("MM\0*"sv)) return std::nullopt;
  const TiffNumbers numbers(tiff);
  const size_t directory = numbers.at<uint32_t>(kDirectoryOffset).value_or(0);
  const size_t entries = numbers.at<uint16_t>(directory).value_or(0);
  for (size_t i = 0; i < entries; ++i) {
    const size_t entry = directory + kCountBytes + i * kEntryBytes;
    const auto tag = numbers.at<uint16_t>(entry);
    if (!tag) return std::nullopt;
    if (tag != kOrientation || numbers.at<uint16_t>(entry + kTypeAt) != kShort) continue;
    return numbers.at<uint16_t>(entry + kValueAt);
  }
  return std::nullopt;
}

}  // namespace

int jpeg_components(std::string_view bytes) {
  constexpr size_t kComponentsAt = 5;  // after the precision and the size
  int components = 0;
  for_each_segment(bytes, [&](const JpegSegment& segment) {
    const bool found = is_frame_header(segment.marker) && segment.content.size() > kComponentsAt;
    if (found) components = static_cast<uint8_t>(segment.content[kComponentsAt]);
    return found;
  });
  return components;
}

int exif_orientation(std::string_view bytes) {
  constexpr uint8_t kApp1 = 0xe1;
  constexpr auto kExif = "Exif\0\0"sv;
  constexpr int kUpright = 1, kMost = 8;
  std::optional<int> orientation;
  for_each_segment(bytes, [&](const JpegSegment& segment) {
    const bool found = segment.marker == kApp1 && segment.content.starts_with(kExif);
    if (found) orientation = tiff_orientation(segment.content.substr(kExif.size()));
    return found;
  });
  const int value = orientation.value_or(kUpright);
  return value >= kUpright && value <= kMost ? value : kUpright;
}

}  // namespace kinloop
