#pragma once
// In: the bytes of a binary file. Out: its values, with errors that name the file and the byte.

#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include <Eigen/Core>
#include <fmt/format.h>
#include <opencv2/core/types.hpp>

#include "kinloop/base/errors.hpp"

namespace kinloop {

/// Reads little-endian values one after the other; at the end of the bytes it throws InputError with the
/// place.
class BinaryReader {
 public:
  BinaryReader(std::string_view bytes, const std::filesystem::path& file) : bytes_(bytes), file_(file) {}

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("{}: at byte {}: {}", file_.string(), position_, what));
  }
  [[nodiscard]] bool has(uint64_t count) const { return count <= bytes_.size() - position_; }
  [[nodiscard]] size_t position() const { return position_; }

  void skip(uint64_t count) {
    if (!has(count)) fail("the file is truncated; copy it again");
    position_ += count;
  }

  template <class T>
  T read() {
    const size_t begin = position_;
    skip(sizeof(T));
    T value;
    std::memcpy(&value, bytes_.data() + begin, sizeof(T));
    return value;
  }

  Eigen::Matrix4d matrix() {
    Eigen::Matrix4d m;
    for (Eigen::Index i = 0; i < m.size(); ++i) m(i / 4, i % 4) = static_cast<double>(read<float>());
    return m;
  }

  cv::Size size() {
    constexpr uint32_t kMax_px = 30'000, kMaxPixels = 1U << 26;
    const auto width = read<uint32_t>(), height = read<uint32_t>();
    if (width == 0 || height == 0 || width > kMax_px || height > kMax_px || width * height > kMaxPixels)
      fail(fmt::format("images of {} x {}; the file is damaged", width, height));
    return {static_cast<int>(width), static_cast<int>(height)};
  }

 private:
  std::string_view bytes_;
  const std::filesystem::path& file_;
  size_t position_ = 0;
};

}  // namespace kinloop
