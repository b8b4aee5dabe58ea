#include "drivers/datasets/reading/numpy_file.hpp"

#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"

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

}  // namespace kinloop
