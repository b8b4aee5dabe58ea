#include "drivers/images/depth_files/exr.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "drivers/images/depth_files/depth_file.hpp"
#include "drivers/images/depth_files/inflate.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/core/text/lower_case.hpp"

namespace kinloop {
namespace {

using namespace std::string_view_literals;

constexpr auto kExrMagic = "\x76\x2f\x31\x01"sv;

enum class ExrCompression : uint8_t { kNone, kRle, kZips, kZip };
constexpr std::array<const char*, 10> kExrCompressions = {"none",  "RLE", "ZIPS", "ZIP",  "PIZ",
                                                          "PXR24", "B44", "B44A", "DWAA", "DWAB"};

enum class ExrPixel : int32_t { kUint, kHalf, kFloat };

struct ExrChannel {
  std::string name;
  ExrPixel pixel = ExrPixel::kHalf;

  [[nodiscard]] size_t bytes() const { return pixel == ExrPixel::kHalf ? 2 : 4; }
};

struct ExrHeader {
  std::vector<ExrChannel> channels;  ///< in the order of a scan line
  ExrCompression compression = ExrCompression::kNone;
  cv::Size size;
  int32_t first_row = 0;
  size_t end = 0;  ///< byte
};

std::string exr_string(ByteReader& reader) {
  constexpr size_t kLongest = 255;
  std::string text;
  while (const char c = reader.number<char>()) {
    if (text.size() == kLongest) throw InputError("the EXR header is damaged");
    text += c;
  }
  return text;
}

std::vector<ExrChannel> exr_channels(Bytes block) {
  constexpr size_t kMostChannels = 64, kLinearAndReserved = 4;
  ByteReader reader(block);
  std::vector<ExrChannel> channels;
  for (std::string name = exr_string(reader); !name.empty(); name = exr_string(reader)) {
    const auto pixel = reader.number<int32_t>();
    reader.block(kLinearAndReserved);
    const bool subsampled = reader.number<int32_t>() != 1 || reader.number<int32_t>() != 1;
    if (pixel < 0 || pixel > static_cast<int32_t>(ExrPixel::kFloat) || subsampled ||
        channels.size() == kMostChannels)
      throw InputError(fmt::format("EXR channel '{}': not one of depth", printable(name)));
    channels.push_back({name, static_cast<ExrPixel>(pixel)});
  }
  if (channels.empty()) throw InputError("the EXR file has no channel");
  return channels;
}

ExrCompression exr_compression(uint8_t number) {
  if (number <= static_cast<uint8_t>(ExrCompression::kZip)) return static_cast<ExrCompression>(number);
  throw InputError(
      fmt::format("EXR compressed by {}, which kinloop cannot read; write it with ZIP",
                  number < kExrCompressions.size() ? kExrCompressions[number] : "another method"));
}

void set_exr_window(Bytes block, ExrHeader& header) {
  ByteReader reader(block);
  const auto x0 = reader.number<int32_t>(), y0 = reader.number<int32_t>(), x1 = reader.number<int32_t>(),
             y1 = reader.number<int32_t>();
  if (x1 < x0 || y1 < y0) throw InputError("the EXR header is damaged: its image is empty");
  header.size = checked_depth_size(static_cast<uint64_t>(int64_t{x1} - x0 + 1),
                                   static_cast<uint64_t>(int64_t{y1} - y0 + 1));
  header.first_row = y0;
}

ExrHeader read_exr_header(std::string_view bytes) {
  constexpr uint32_t kVersion = 2, kVersionMask = 0xff, kLongNames = 0x400;
  ByteReader reader(as_bytes(bytes));
  reader.block(kExrMagic.size());
  const auto version = reader.number<uint32_t>();
  if ((version & kVersionMask) != kVersion || (version & ~kVersionMask & ~kLongNames) != 0)
    throw InputError(
        "an EXR file of tiles, of several parts or of deep pixels; write one image of scan lines");
  ExrHeader header;
  for (std::string name = exr_string(reader); !name.empty(); name = exr_string(reader)) {
    exr_string(reader);  // the type
    const Bytes value = reader.block(reader.number<uint32_t>());
    if (name == "channels") header.channels = exr_channels(value);
    if (name == "compression") header.compression = exr_compression(ByteReader(value).number<uint8_t>());
    if (name == "dataWindow") set_exr_window(value, header);
  }
  if (header.channels.empty() || header.size.width == 0)
    throw InputError("the EXR header is damaged: no channels or no dataWindow");
  header.end = bytes.size() - reader.left();
  return header;
}

/// Undoes the run lengths: n >= 0 repeats the next byte n + 1 times, n < 0 copies -n bytes.
std::string expand_exr_runs(std::string_view bytes, size_t size) {
  std::string content;
  size_t at = 0;
  while (content.size() < size && at < bytes.size()) {
    const auto n = static_cast<int8_t>(bytes[at++]);
    const size_t count = n < 0 ? static_cast<size_t>(-int{n}) : static_cast<size_t>(n) + 1;
    const size_t used = n < 0 ? count : 1;
    if (used > bytes.size() - at || count > size - content.size()) break;
    n < 0 ? content.append(bytes.substr(at, count)) : content.append(count, bytes[at]);
    at += used;
  }
  if (content.size() != size) throw InputError("a block of the EXR file is damaged");
  return content;
}

/// Undoes the differences of successive bytes, and puts the two halves of the block together again.
std::string undo_exr_filter(std::string block) {
  constexpr int kOffset = 128;
  for (size_t i = 1; i < block.size(); ++i)
    block[i] =
        static_cast<char>(static_cast<uint8_t>(block[i - 1]) + static_cast<uint8_t>(block[i]) - kOffset);
  std::string pixels(block.size(), '\0');
  const size_t half = (block.size() + 1) / 2;
  for (size_t i = 0; i < block.size(); ++i) pixels[i] = block[i / 2 + (i % 2 == 0 ? 0 : half)];
  return pixels;
}

/// A block that compression would make larger is stored as it is.
std::string exr_block(Bytes packed, size_t size, ExrCompression compression) {
  if (packed.size() == size || compression == ExrCompression::kNone) return std::string(as_text(packed));
  return undo_exr_filter(compression == ExrCompression::kRle ? expand_exr_runs(as_text(packed), size)
                                                             : inflate_zlib(as_text(packed), size));
}

/// How well a channel's name says that it is depth; less is better.
int exr_rank(const std::string& name) {
  const std::string small = lower_case(name.substr(name.find_last_of('.') + 1));
  if (small == "z") return 0;
  if (lower_case(name).find("depth") != std::string::npos) return 1;
  return small == "r" || small == "y" || small == "v" ? 2 : 3;
}

void convert_exr_row(std::string_view row, ExrPixel pixel, cv::Mat out) {
  if (pixel == ExrPixel::kHalf) return floats_of_halves(row, out.size()).copyTo(out);
  ByteReader reader(as_bytes(row));
  for (int x = 0; x < out.cols; ++x) {
    out.at<float>(x) =
        pixel == ExrPixel::kFloat ? reader.number<float>() : static_cast<float>(reader.number<uint32_t>());
  }
}

/// Of a pixel of all channels, and where the chosen one begins in a scan line of one pixel.
struct ExrLine {
  size_t bytes = 0, channel_begin = 0;
  ExrChannel channel;
};

ExrLine exr_line(const std::vector<ExrChannel>& channels) {
  const auto best = std::min_element(channels.begin(), channels.end(), [](const auto& a, const auto& b) {
    return exr_rank(a.name) < exr_rank(b.name);
  });
  ExrLine line{0, 0, *best};
  for (auto c = channels.begin(); c != channels.end(); ++c) {
    if (c == best) line.channel_begin = line.bytes;
    line.bytes += c->bytes();
  }
  return line;
}

}  // namespace

bool is_exr(std::string_view bytes) {
  return bytes.starts_with(kExrMagic);
}

cv::Size exr_size(std::string_view bytes) {
  return read_exr_header(bytes).size;
}

cv::Mat decode_exr(std::string_view bytes) {
  constexpr int kZipRows = 16;
  const ExrHeader header = read_exr_header(bytes);
  const ExrLine line = exr_line(header.channels);
  const auto width = static_cast<size_t>(header.size.width);
  const int rows_per_block = header.compression == ExrCompression::kZip ? kZipRows : 1;
  const int blocks = (header.size.height + rows_per_block - 1) / rows_per_block;
  ByteReader offsets(as_bytes(bytes.substr(header.end)));
  if (offsets.left() / sizeof(uint64_t) < static_cast<size_t>(blocks))
    throw InputError("the EXR file is truncated; copy it again");
  cv::Mat depth(header.size, CV_32FC1, cv::Scalar(0));
  for (int i = 0; i < blocks; ++i) {
    const auto offset = offsets.number<uint64_t>();
    if (offset > bytes.size()) throw InputError("the EXR file is truncated; copy it again");
    ByteReader reader(as_bytes(bytes.substr(offset)));
    const int64_t row = int64_t{reader.number<int32_t>()} - header.first_row;
    if (row < 0 || row >= header.size.height || row % rows_per_block != 0)
      throw InputError("a block of the EXR file is damaged");
    const auto first = static_cast<int>(row);
    const int rows = std::min(rows_per_block, header.size.height - first);
    const size_t size = static_cast<size_t>(rows) * line.bytes * width;
    const std::string block = exr_block(reader.block(reader.number<uint32_t>()), size, header.compression);
    if (block.size() != size) throw InputError("a block of the EXR file is of another size than its image");
    for (int y = 0; y < rows; ++y) {
      const size_t begin = (static_cast<size_t>(y) * line.bytes + line.channel_begin) * width;
      convert_exr_row(std::string_view(block).substr(begin, width * line.channel.bytes()), line.channel.pixel,
                      depth.row(first + y));
    }
  }
  return depth;
}

}  // namespace kinloop
