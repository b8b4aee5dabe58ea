#include "drivers/datasets/reading/images/image_bytes.hpp"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "drivers/image_files/image_file.hpp"
#include "drivers/images/depth_files/depth_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/sensor/images/image_limits.hpp"

namespace kinloop {
std::string read_bytes(const ImageLocation& image) {
  if (image.size == 0) return read_image_bytes(image.file);
  if (image.size > kMaxEncodedBytes) {
    throw InputError(fmt::format("{}: an image of {} bytes at byte {}, where one has at most {}",
                                 image.file.string(), image.size, image.offset, kMaxEncodedBytes));
  }
  require_regular_file(image.file);
  std::ifstream stream(image.file, std::ios::binary);
  std::error_code error;
  const uint64_t file_size = std::filesystem::file_size(image.file, error);
  if (!stream || error)
    throw InputError(fmt::format("{}: cannot be read; check its permissions", image.file.string()));
  if (image.offset > file_size || image.size > file_size - image.offset) {
    throw InputError(fmt::format("{}: the file is truncated at byte {}, within an image; copy it again",
                                 image.file.string(), file_size));
  }
  std::string bytes(image.size, '\0');
  stream.seekg(static_cast<std::streamoff>(image.offset));
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream) throw InputError(fmt::format("{}: cannot be read", image.file.string()));
  return bytes;
}

namespace {

/// Damage is said when the image is decoded.
std::optional<cv::Size> size_of_depth_file(std::string_view bytes) {
  try {
    return depth_file_size(bytes);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

std::optional<cv::Size> size_in_header(std::string_view bytes) {
  constexpr int kMax_px = 30'000;
  auto size = encoded_size(bytes);
  if (!size) size = size_of_depth_file(bytes);
  const bool plausible =
      size && size->width > 0 && size->height > 0 && size->width <= kMax_px && size->height <= kMax_px;
  return plausible ? size : std::nullopt;
}

cv::Size image_size(const std::vector<RecordedFrame>& frames, ImageLocation RecordedFrame::*image) {
  constexpr size_t kTried = 10;  // the first may be damaged
  std::string first_problem;
  for (size_t i = 0; i < std::min(kTried, frames.size()); ++i) {
    const ImageLocation& location = frames[i].*image;
    try {
      const std::string bytes = read_bytes(location);
      if (const auto size = size_in_header(bytes)) return *size;
      const std::string_view damage = image_damage(bytes);
      if (first_problem.empty())
        first_problem = fmt::format("{}: {}", location.file.string(), damage.empty() ? kNoImage : damage);
    } catch (const InputError& error) {
      if (first_problem.empty()) first_problem = error.what();
    }
  }
  throw InputError(first_problem.empty() ? "no images" : first_problem);
}

}  // namespace kinloop
