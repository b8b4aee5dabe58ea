#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "drivers/images/depth_files/depth_file.hpp"
#include "drivers/images/depth_files/depth_formats.hpp"
#include "drivers/images/depth_files/inflate.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/sensor/images/image_limits.hpp"

namespace kinloop {
namespace {

using namespace std::string_view_literals;

constexpr auto kNumpyMagic = "\x93NUMPY"sv, kZipMagic = "PK\x03\x04"sv;

/// Magic, version, length of the header; then the header, a Python dictionary.
struct NumpyParts {
  std::string_view header, data;
};

NumpyParts split_numpy(std::string_view bytes) {
  constexpr size_t kVersion = 6, kLength = 8;
  if (bytes.size() < kLength + 4) throw InputError("the .npy file is truncated; copy it again");
  ByteReader rest(as_bytes(bytes.substr(kLength)));
  const size_t length = bytes[kVersion] == 1 ? rest.number<uint16_t>() : rest.number<uint32_t>();
  const auto header = as_text(rest.block(length));
  return {header, as_text(rest.block(rest.left()))};
}

/// The text between the first `open` and the next `close`.
std::string_view between(std::string_view text, std::string_view open, char close) {
  const size_t begin = text.find(open);
  if (begin == std::string_view::npos) return {};
  text.remove_prefix(begin + open.size());
  return text.substr(0, text.find(close));
}

/// Parses "'shape': (480, 640)"; dimensions of 1 are left out.
cv::Size shape_in(std::string_view header) {
  std::vector<uint64_t> sides;
  std::string_view text = between(header, "'shape': (", ')');
  while (!text.empty()) {
    uint64_t side = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), side);
    if (error != std::errc()) break;
    if (side != 1) sides.push_back(side);
    text.remove_prefix(static_cast<size_t>(end - text.data()));
    text.remove_prefix(std::min(text.find_first_not_of(", "), text.size()));
  }
  if (sides.size() != 2) throw InputError("the array does not have two dimensions, as depth has");
  return checked_depth_size(sides[1], sides[0]);
}

void require_bytes(std::string_view data, cv::Size size, size_t pixel_bytes) {
  const auto pixels = static_cast<size_t>(size.width) * static_cast<size_t>(size.height);
  if (data.size() != pixels * pixel_bytes) throw InputError("the array is truncated; copy it again");
}

template <class Number>
cv::Mat numbers_of(std::string_view data, cv::Size size) {
  require_bytes(data, size, sizeof(Number));
  cv::Mat image(size, std::is_same_v<Number, uint16_t> ? CV_16UC1 : CV_32FC1);
  if constexpr (std::is_same_v<Number, uint16_t> || std::is_same_v<Number, float>) {
    std::memcpy(image.data, data.data(), data.size());
  } else {
    ByteReader reader(as_bytes(data));
    auto* out = image.ptr<float>();
    for (size_t i = 0; i < image.total(); ++i) out[i] = static_cast<float>(reader.number<Number>());
  }
  return image;
}

cv::Mat halves_of(std::string_view data, cv::Size size) {
  require_bytes(data, size, sizeof(uint16_t));
  return floats_of_halves(data, size);
}

/// Reads the directory at the end of a zip file, without ZIP64.
struct ZipMember {
  std::string_view name;
  uint16_t method = 0;
  uint32_t packed_bytes = 0, bytes = 0, begin = 0;
};

std::vector<ZipMember> zip_members(std::string_view zip) {
  constexpr auto kEnd = "PK\x05\x06"sv;
  constexpr uint32_t kEntry = 0x02014b50;
  const size_t end = zip.rfind(kEnd);
  if (end == std::string_view::npos) throw InputError("the .npz file is truncated; copy it again");
  ByteReader tail(as_bytes(zip.substr(end + kEnd.size())));
  tail.block(6);  // numbers of disks, entries on this disk
  const auto count = tail.number<uint16_t>();
  tail.block(4);  // bytes of the directory
  const auto begin = tail.number<uint32_t>();
  if (begin > end) throw InputError("the directory of the .npz file is damaged; copy it again");
  ByteReader entries(as_bytes(zip.substr(begin, end - begin)));
  std::vector<ZipMember> members;
  for (uint16_t i = 0; i < count; ++i) {
    if (entries.number<uint32_t>() != kEntry) throw InputError("the directory of the .npz file is damaged");
    ZipMember member;
    entries.block(6);  // versions, flags
    member.method = entries.number<uint16_t>();
    entries.block(8);  // time, checksum
    member.packed_bytes = entries.number<uint32_t>();
    member.bytes = entries.number<uint32_t>();
    const auto name = entries.number<uint16_t>(), extra = entries.number<uint16_t>(),
               comment = entries.number<uint16_t>();
    entries.block(8);  // disk, attributes
    member.begin = entries.number<uint32_t>();
    member.name = as_text(entries.block(name));
    entries.block(size_t{extra} + comment);
    members.push_back(member);
  }
  return members;
}

std::string unzipped(std::string_view zip, const ZipMember& member) {
  constexpr uint16_t kStored = 0, kDeflated = 8;
  constexpr uint64_t kMostBytes = kMaxDecodedPixels * sizeof(double);
  if (member.begin > zip.size() || member.bytes > kMostBytes)
    throw InputError("the directory of the .npz file is damaged; copy it again");
  ByteReader reader(as_bytes(zip.substr(member.begin)));
  reader.block(26);  // what the directory says, too
  const auto name = reader.number<uint16_t>(), extra = reader.number<uint16_t>();
  reader.block(size_t{name} + extra);
  const auto packed = as_text(reader.block(member.packed_bytes));
  if (member.method == kStored) return std::string(packed);
  if (member.method != kDeflated) throw InputError("the .npz file has an unknown compression");
  return inflate_raw(packed, member.bytes);
}

/// The array called depth, else the only one, as a .npy file.
std::string depth_in(std::string_view zip) {
  const auto members = zip_members(zip);
  auto depth = std::find_if(members.begin(), members.end(), [](const ZipMember& member) {
    return member.name.find("depth") != std::string_view::npos;
  });
  if (depth == members.end() && members.size() == 1) depth = members.begin();
  if (depth == members.end()) {
    throw InputError(
        fmt::format("{} arrays, none of which is called depth; save one of them", members.size()));
  }
  std::string array = unzipped(zip, *depth);
  if (!is_numpy(array)) throw InputError("a zip file without an array of NumPy");
  return array;
}

}  // namespace

bool is_numpy(std::string_view bytes) {
  return bytes.starts_with(kNumpyMagic);
}

cv::Size numpy_size(std::string_view bytes) {
  return shape_in(split_numpy(bytes).header);
}

cv::Mat decode_numpy(std::string_view bytes) {
  const auto [header, data] = split_numpy(bytes);
  const cv::Size size = shape_in(header);
  if (header.find("'fortran_order': False"sv) == std::string_view::npos)
    throw InputError("the array is not in C order; save it with numpy.ascontiguousarray");
  const std::string_view type = between(header, "'descr': '", '\'');
  if (type == "<f4") return numbers_of<float>(data, size);
  if (type == "<f2") return halves_of(data, size);
  if (type == "<f8") return numbers_of<double>(data, size);
  if (type == "<u2") return numbers_of<uint16_t>(data, size);
  if (type == "<i2") return numbers_of<int16_t>(data, size);
  if (type == "<i4") return numbers_of<int32_t>(data, size);
  if (type == "<u4") return numbers_of<uint32_t>(data, size);
  if (type == "<i8") return numbers_of<int64_t>(data, size);
  throw InputError(fmt::format("an array of '{}'; save depth as uint16 or float32", printable(type)));
}

bool is_numpy_archive(std::string_view bytes) {
  return bytes.starts_with(kZipMagic);
}

cv::Size numpy_archive_size(std::string_view bytes) {
  return numpy_size(depth_in(bytes));
}

cv::Mat decode_numpy_archive(std::string_view bytes) {
  return decode_numpy(depth_in(bytes));
}

}  // namespace kinloop
