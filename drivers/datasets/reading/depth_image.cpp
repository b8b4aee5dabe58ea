#include "drivers/datasets/reading/depth_image.hpp"

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>

#include <fmt/format.h>
#include <libdeflate.h>

#include "drivers/datasets/reading/pgm.hpp"
#include "drivers/images/encoded_image.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/sensor/images/image_file.hpp"

namespace kinloop {

namespace {

using namespace std::string_view_literals;

/// Magic, version, length of the header; then the header, a Python dictionary.
struct NumpyParts {
  std::string_view header, data;
};

std::optional<NumpyParts> split_numpy(std::string_view bytes) {
  constexpr size_t kVersion = 6, kLength = 8;
  if (!bytes.starts_with("\x93NUMPY"sv) || bytes.size() < kLength + 4) return std::nullopt;
  ByteReader rest(as_bytes(bytes.substr(kLength)));
  const size_t length = bytes[kVersion] == 1 ? rest.number<uint16_t>() : rest.number<uint32_t>();
  if (length > rest.left()) return std::nullopt;
  const auto header = as_text(rest.block(length));
  return NumpyParts{header, as_text(rest.block(rest.left()))};
}

/// Parses "'shape': (480, 640)".
std::optional<cv::Size> shape_in(std::string_view header) {
  constexpr int kMax_px = 30'000;
  const size_t open = header.find("'shape': ("sv);
  if (open == std::string_view::npos) return std::nullopt;
  const char* at = header.data() + open + "'shape': ("sv.size();
  const char* end = header.data() + header.size();
  int rows = 0, cols = 0;
  const auto first = std::from_chars(at, end, rows);
  if (first.ec != std::errc() || end - first.ptr < 2 || std::string_view(first.ptr, 2) != ", "sv)
    return std::nullopt;
  const auto second = std::from_chars(first.ptr + 2, end, cols);
  const bool closed = second.ec == std::errc() && second.ptr != end && *second.ptr == ')';
  if (!closed || rows <= 0 || cols <= 0 || rows > kMax_px || cols > kMax_px) return std::nullopt;
  return cv::Size(cols, rows);
}

}  // namespace

cv::Mat decode_numpy_image(std::string_view bytes, const std::filesystem::path& file) {
  const auto fail = [&](const char* why) { throw InputError(fmt::format("{}: {}", file.string(), why)); };
  const auto parts = split_numpy(bytes);
  if (!parts) fail("not a .npy file, or truncated; copy it again");
  const bool known = parts->header.find("'<f4'"sv) != std::string_view::npos &&
                     parts->header.find("'fortran_order': False"sv) != std::string_view::npos;
  const auto size = shape_in(parts->header);
  if (!known || !size) fail("not a two-dimensional array of float32 in C order, as depth is");
  const size_t pixels = static_cast<size_t>(size->width) * static_cast<size_t>(size->height);
  if (parts->data.size() != pixels * sizeof(float)) fail("the array is truncated; copy it again");
  cv::Mat image(*size, CV_32FC1);
  std::memcpy(image.data, parts->data.data(), parts->data.size());
  return image;
}

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

/// The size of the image is known, so that a bomb cannot expand to more.
std::string inflate_zlib(const std::string& bytes, size_t size, const std::filesystem::path& file) {
  using Decompressor = std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>;
  const Decompressor decompressor(require_memory(libdeflate_alloc_decompressor()),
                                  libdeflate_free_decompressor);
  std::string content(size, '\0');
  const auto result = libdeflate_zlib_decompress(decompressor.get(), bytes.data(), bytes.size(),
                                                 content.data(), content.size(), nullptr);
  if (result != LIBDEFLATE_SUCCESS)
    reject_depth(file, "compressed depth is damaged, or of another size than the header says");
  return content;
}

cv::Mat raw_metres(const std::string& bytes, cv::Size size, const std::filesystem::path& file) {
  require_length(bytes, pixels_of(size) * sizeof(float), file);
  cv::Mat depth_m(size, CV_32FC1);
  std::memcpy(depth_m.data, bytes.data(), bytes.size());
  return without_impossible_depth(depth_m);
}

}  // namespace

cv::Mat decode_depth(const std::string& bytes, const std::filesystem::path& file, DepthEncoding encoding,
                     cv::Size size, double depth_scale) {
  switch (encoding) {
    case DepthEncoding::kRawUint16:
      return from_depth_units(raw_units(bytes, size, file), depth_scale);
    case DepthEncoding::kZlibUint16:
      return from_depth_units(
          raw_units(inflate_zlib(bytes, pixels_of(size) * sizeof(uint16_t), file), size, file), depth_scale);
    case DepthEncoding::kRawFloat32:
      return raw_metres(bytes, size, file);
    case DepthEncoding::kNumpy:
      return without_impossible_depth(decode_numpy_image(bytes, file));
    case DepthEncoding::kImage:
      break;
  }
  if (!bytes.starts_with("P5")) return decode_depth_image(bytes, file, depth_scale);
  const cv::Mat units = decode_pgm(bytes);
  if (units.empty()) reject_depth(file, "the PGM is truncated or damaged; copy it again");
  if (units.type() != CV_16UC1)
    throw ImageFormatError(fmt::format("{}: a PGM of 8 bits; export depth with 16 bits", file.string()));
  return from_depth_units(units, depth_scale);
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
