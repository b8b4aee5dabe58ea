#include "drivers/images/depth_files/tiff.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "drivers/images/depth_files/depth_file.hpp"
#include "drivers/images/depth_files/inflate.hpp"
#include "drivers/images/depth_files/tiff_compression.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/sensor/images/tiff_bytes.hpp"

namespace kinloop {
namespace {

enum TiffTag : uint16_t {
  kTiffWidth = 256,
  kTiffHeight = 257,
  kTiffBits = 258,
  kTiffCompression = 259,
  kTiffStripOffsets = 273,
  kTiffChannels = 277,
  kTiffRowsPerStrip = 278,
  kTiffStripBytes = 279,
  kTiffPredictor = 317,
  kTiffTileWidth = 322,
  kTiffTileHeight = 323,
  kTiffTileOffsets = 324,
  kTiffTileBytes = 325,
  kTiffSampleFormat = 339,
};

using TiffTags = std::map<uint16_t, std::vector<uint64_t>>;

/// The values of a tag; none if they are not whole numbers.
std::vector<uint64_t> tiff_values(const TiffBytes& file, uint64_t entry) {
  constexpr uint16_t kShort = 3, kLong = 4;
  constexpr uint64_t kInPlace = 4;
  const auto type = file.number<uint16_t>(entry + 2);
  if (type != kShort && type != kLong) return {};
  const uint64_t count = file.number<uint32_t>(entry + 4), each = type == kShort ? 2 : 4;
  const uint64_t begin = count * each <= kInPlace ? entry + 8 : file.number<uint32_t>(entry + 8);
  static_cast<void>(file.block(begin, count * each));  // before memory is allocated
  std::vector<uint64_t> values;
  for (uint64_t i = 0; i < count; ++i)
    values.push_back(type == kShort ? file.number<uint16_t>(begin + 2 * i)
                                    : file.number<uint32_t>(begin + 4 * i));
  return values;
}

TiffTags first_directory(const TiffBytes& file) {
  constexpr uint64_t kDirectory = 4, kEntryBytes = 12;
  const uint64_t begin = file.number<uint32_t>(kDirectory);
  const auto count = file.number<uint16_t>(begin);
  TiffTags tags;
  for (uint64_t i = 0; i < count; ++i) {
    const uint64_t entry = begin + 2 + kEntryBytes * i;
    const auto tag = file.number<uint16_t>(entry);
    const bool used =
        (tag >= kTiffWidth && tag <= kTiffStripBytes) || (tag >= kTiffPredictor && tag <= kTiffSampleFormat);
    if (used) tags[tag] = tiff_values(file, entry);
  }
  return tags;
}

uint64_t tiff_value(const TiffTags& tags, TiffTag tag, uint64_t otherwise) {
  const auto found = tags.find(tag);
  return found == tags.end() || found->second.empty() ? otherwise : found->second.front();
}

enum class TiffNumber : uint8_t { kUnsigned = 1, kSigned = 2, kFloat = 3 };

/// The image as its directory describes it. A strip is a tile as wide as the image.
struct TiffImage {
  cv::Size size, tile;
  size_t pixel_bytes = 0;
  TiffNumber number = TiffNumber::kUnsigned;
  uint64_t compression = 1, predictor = 1;
  std::vector<uint64_t> offsets, lengths;

  [[nodiscard]] int columns() const { return (size.width + tile.width - 1) / tile.width; }
  [[nodiscard]] int rows() const { return (size.height + tile.height - 1) / tile.height; }
};

cv::Size tiff_image_size(const TiffTags& tags) {
  return checked_depth_size(tiff_value(tags, kTiffWidth, 0), tiff_value(tags, kTiffHeight, 0));
}

void set_tiff_tiles(const TiffTags& tags, TiffImage& image) {
  const bool tiled = tags.contains(kTiffTileOffsets);
  const auto offsets = tags.find(tiled ? kTiffTileOffsets : kTiffStripOffsets),
             lengths = tags.find(tiled ? kTiffTileBytes : kTiffStripBytes);
  const auto height = static_cast<uint64_t>(image.size.height);
  image.tile =
      tiled ? checked_depth_size(tiff_value(tags, kTiffTileWidth, 0), tiff_value(tags, kTiffTileHeight, 0))
            : checked_depth_size(static_cast<uint64_t>(image.size.width),
                                 std::min(tiff_value(tags, kTiffRowsPerStrip, height), height));
  if (offsets == tags.end() || lengths == tags.end()) throw InputError("the TIFF file has no pixels");
  image.offsets = offsets->second, image.lengths = lengths->second;
  const size_t needed = static_cast<size_t>(image.columns()) * static_cast<size_t>(image.rows());
  if (image.offsets.size() < needed || image.lengths.size() < needed)
    throw InputError("the TIFF file is damaged: some of its strips are not listed");
}

TiffImage tiff_image(const TiffTags& tags) {
  constexpr uint64_t kBitsPerByte = 8;
  TiffImage image;
  image.size = tiff_image_size(tags);
  const uint64_t bits = tiff_value(tags, kTiffBits, 1), format = tiff_value(tags, kTiffSampleFormat, 1),
                 channels = tiff_value(tags, kTiffChannels, 1);
  const bool is_integer = format == 1 || format == 2;
  const bool known = channels == 1 && ((is_integer && (bits == 16 || bits == 32)) ||
                                       (format == 3 && (bits == 32 || bits == 64)));
  if (!known) {
    throw InputError(
        fmt::format("a TIFF of {} bits and {} channels; write depth as one channel of 16 bits or "
                    "32-bit floats",
                    bits, channels));
  }
  image.pixel_bytes = static_cast<size_t>(bits / kBitsPerByte);
  image.number = static_cast<TiffNumber>(format);
  image.compression = tiff_value(tags, kTiffCompression, 1);
  image.predictor = tiff_value(tags, kTiffPredictor, 1);
  set_tiff_tiles(tags, image);
  return image;
}

std::string expand_tile(std::string_view packed, uint64_t compression, size_t size) {
  constexpr uint64_t kNone = 1, kLzw = 5, kAdobeDeflate = 8, kDeflate = 32946, kPackBits = 32773;
  if (compression == kNone) return std::string(packed.substr(0, size));
  if (compression == kLzw) return expand_tiff_lzw(packed, size);
  if (compression == kPackBits) return expand_packbits(packed, size);
  if (compression == kAdobeDeflate || compression == kDeflate) return inflate_zlib(packed, size);
  throw InputError(fmt::format(
      "a TIFF with compression {}, which kinloop cannot read; write it with Deflate or none", compression));
}

/// The bytes of a row come in planes, the highest first, as differences of successive bytes (Adobe's TIFF
/// technical note 3). The result has the byte order of this machine.
void undo_float_predictor(char* row, size_t pixels, size_t each) {
  const size_t size = pixels * each;
  for (size_t i = 1; i < size; ++i)
    row[i] = static_cast<char>(static_cast<uint8_t>(row[i]) + static_cast<uint8_t>(row[i - 1]));
  const std::string planes(row, size);
  for (size_t i = 0; i < pixels; ++i) {
    for (size_t b = 0; b < each; ++b) row[i * each + each - 1 - b] = planes[b * pixels + i];
  }
}

/// Undoes differences of successive pixels, of which the bits count, also those of floats.
template <class Bits>
void undo_horizontal_predictor(char* row, size_t pixels, bool swapped) {
  Bits previous = 0;
  for (size_t i = 0; i < pixels; ++i) {
    Bits value;
    std::memcpy(&value, row + i * sizeof(Bits), sizeof(Bits));
    if (swapped) value = byte_swapped(value);
    previous = static_cast<Bits>(value + previous);
    std::memcpy(row + i * sizeof(Bits), &previous, sizeof(Bits));
  }
}

/// The result has the byte order of this machine.
void undo_horizontal_predictor(char* row, size_t pixels, size_t each, bool swapped) {
  if (each == sizeof(uint16_t)) undo_horizontal_predictor<uint16_t>(row, pixels, swapped);
  if (each == sizeof(uint32_t)) undo_horizontal_predictor<uint32_t>(row, pixels, swapped);
  if (each == sizeof(uint64_t)) undo_horizontal_predictor<uint64_t>(row, pixels, swapped);
}

template <class Number>
void convert_tiff_row(const char* row, int pixels, bool swapped, cv::Mat& image, cv::Point at) {
  for (int i = 0; i < pixels && at.x + i < image.cols; ++i) {
    Number value;
    std::memcpy(&value, row + static_cast<size_t>(i) * sizeof(Number), sizeof(Number));
    if (swapped) value = byte_swapped(value);
    if constexpr (std::is_same_v<Number, uint16_t>) {
      if (image.type() == CV_16UC1) {
        image.at<uint16_t>(at.y, at.x + i) = value;
        continue;
      }
    }
    image.at<float>(at.y, at.x + i) = static_cast<float>(value);
  }
}

/// What is negative as a signed number is no depth.
void remove_negative_numbers(cv::Mat& image, size_t each) {
  const double half = each == sizeof(uint16_t) ? 32768 : 2147483648;
  image.setTo(0, image >= half);
}

void place_tile(std::string& tile, const TiffImage& layout, bool swapped, cv::Point at, cv::Mat& image) {
  constexpr uint64_t kHorizontal = 2, kFloatingPoint = 3;
  const auto width = static_cast<size_t>(layout.tile.width);
  const size_t row_bytes = width * layout.pixel_bytes;
  const bool differences = layout.predictor == kHorizontal, planes = layout.predictor == kFloatingPoint;
  for (int y = 0; y < layout.tile.height && at.y + y < image.rows; ++y) {
    char* row = tile.data() + static_cast<size_t>(y) * row_bytes;
    if (differences) undo_horizontal_predictor(row, width, layout.pixel_bytes, swapped);
    if (planes) undo_float_predictor(row, width, layout.pixel_bytes);
    const cv::Point begin(at.x, at.y + y);
    const bool swap = swapped && !planes && !differences;
    const int n = layout.tile.width;
    if (layout.number == TiffNumber::kFloat && layout.pixel_bytes == sizeof(double)) {
      convert_tiff_row<double>(row, n, swap, image, begin);
    } else if (layout.number == TiffNumber::kFloat) {
      convert_tiff_row<float>(row, n, swap, image, begin);
    } else if (layout.pixel_bytes == sizeof(uint16_t)) {
      convert_tiff_row<uint16_t>(row, n, swap, image, begin);
    } else {
      convert_tiff_row<uint32_t>(row, n, swap, image, begin);
    }
  }
}

}  // namespace

cv::Size tiff_size(std::string_view bytes) {
  return tiff_image_size(first_directory(TiffBytes(bytes)));
}

cv::Mat decode_tiff(std::string_view bytes) {
  const TiffBytes file(bytes);
  const TiffImage layout = tiff_image(first_directory(file));
  const size_t tile_bytes = static_cast<size_t>(layout.tile.area()) * layout.pixel_bytes;
  const bool is_uint16 = layout.number == TiffNumber::kUnsigned && layout.pixel_bytes == sizeof(uint16_t);
  cv::Mat image(layout.size, is_uint16 ? CV_16UC1 : CV_32FC1, cv::Scalar(0));
  for (int row = 0; row < layout.rows(); ++row) {
    for (int column = 0; column < layout.columns(); ++column) {
      const auto i =
          static_cast<size_t>(row) * static_cast<size_t>(layout.columns()) + static_cast<size_t>(column);
      const cv::Point at(column * layout.tile.width, row * layout.tile.height);
      const int rows = layout.tile.width == layout.size.width
                           ? std::min(layout.tile.height, layout.size.height - at.y)  // the last strip
                           : layout.tile.height;
      const size_t needed =
          static_cast<size_t>(rows) * static_cast<size_t>(layout.tile.width) * layout.pixel_bytes;
      std::string tile =
          expand_tile(file.block(layout.offsets[i], layout.lengths[i]), layout.compression, needed);
      if (tile.size() < needed) throw InputError("a strip of the TIFF file is truncated; copy it again");
      tile.resize(tile_bytes);
      place_tile(tile, layout, file.is_swapped(), at, image);
    }
  }
  if (layout.number == TiffNumber::kSigned) remove_negative_numbers(image, layout.pixel_bytes);
  return image;
}

}  // namespace kinloop
