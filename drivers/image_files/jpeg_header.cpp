#include "drivers/image_files/jpeg_header.hpp"

#include <cstdint>
#include <optional>

#include "drivers/image_files/tiff_bytes.hpp"
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

/// The orientation in the first directory of a TIFF file (TIFF 6.0, section 2); nullopt if it has none.
std::optional<int> tiff_orientation(std::string_view bytes) {
  constexpr uint64_t kDirectoryOffset = 4, kCountBytes = 2, kEntryBytes = 12, kTypeAt = 2, kValueAt = 8;
  constexpr uint16_t kOrientation = 274, kShort = 3;
  if (!is_tiff(bytes)) return std::nullopt;
  try {
    const TiffBytes tiff(bytes);
    const uint64_t directory = tiff.number<uint32_t>(kDirectoryOffset);
    const auto entries = tiff.number<uint16_t>(directory);
    for (uint64_t i = 0; i < entries; ++i) {
      const uint64_t entry = directory + kCountBytes + i * kEntryBytes;
      const bool found =
          tiff.number<uint16_t>(entry) == kOrientation && tiff.number<uint16_t>(entry + kTypeAt) == kShort;
      if (found) return tiff.number<uint16_t>(entry + kValueAt);
    }
  } catch (const InputError&) {
    return std::nullopt;  // damaged
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
