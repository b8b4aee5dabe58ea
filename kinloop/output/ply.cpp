#include "kinloop/output/ply.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/text_file.hpp"

namespace kinloop {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY files are written as memory has them");

constexpr size_t kPointBytes = 3 * sizeof(float);
constexpr size_t kVertexBytes = kPointBytes + sizeof(Rgb);

constexpr const char* kBeforeCount = "ply\nformat binary_little_endian 1.0\ncomment kinloop\nelement vertex ";
constexpr const char* kAfterCount =
    "\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";

[[noreturn]] void throw_bad(const std::filesystem::path& path, const char* what) {
  throw InputError(fmt::format("{}: {}; give a map.ply that kinloop wrote", path.string(), what));
}

/// Takes `text` off the front of `content`, or throws.
void expect(std::string_view& content, std::string_view text, const std::filesystem::path& path) {
  if (!content.starts_with(text))
    throw_bad(path, "not a binary PLY cloud with float x y z and uchar red green blue");
  content.remove_prefix(text.size());
}

}  // namespace

void write_ply(const std::filesystem::path& path, const ColoredCloud& cloud) {
  require(cloud.points.size() == cloud.colors.size(), "write_ply: one colour per point");
  AtomicFile file(path);
  file.stream() << kBeforeCount << cloud.size() << kAfterCount;
  constexpr size_t kAtOnce = 4096;
  std::string buffer(kAtOnce * kVertexBytes, '\0');
  for (size_t first = 0; first < cloud.size(); first += kAtOnce) {
    const size_t count = std::min(kAtOnce, cloud.size() - first);
    for (size_t i = 0; i < count; ++i) {
      char* vertex = &buffer[i * kVertexBytes];
      std::memcpy(vertex, cloud.points[first + i].data(), kPointBytes);
      std::memcpy(vertex + kPointBytes, cloud.colors[first + i].data(), sizeof(Rgb));
    }
    file.stream().write(buffer.data(), static_cast<std::streamsize>(count * kVertexBytes));
  }
  file.commit();
}

ColoredCloud read_ply(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  std::string_view content = bytes;
  expect(content, kBeforeCount, path);
  size_t count = 0;
  const auto [end, error] = std::from_chars(content.data(), content.data() + content.size(), count);
  if (error != std::errc()) throw_bad(path, "the number of points is not a number");
  content.remove_prefix(static_cast<size_t>(end - content.data()));
  expect(content, kAfterCount, path);
  if (content.size() / kVertexBytes < count) throw_bad(path, "cut short");

  ColoredCloud cloud;
  cloud.points.resize(count);
  cloud.colors.resize(count);
  for (size_t i = 0; i < count; ++i) {
    const char* vertex = content.data() + i * kVertexBytes;
    std::memcpy(cloud.points[i].data(), vertex, kPointBytes);
    std::memcpy(cloud.colors[i].data(), vertex + kPointBytes, sizeof(Rgb));
  }
  return cloud;
}

}  // namespace kinloop
