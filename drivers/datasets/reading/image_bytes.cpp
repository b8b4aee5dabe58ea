#include "drivers/datasets/reading/image_bytes.hpp"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "drivers/datasets/reading/pgm.hpp"
#include "kinloop/base/byte_reader.hpp"
#include "kinloop/base/errors.hpp"
#include "kinloop/base/text_file.hpp"

namespace kinloop {
namespace {

using namespace std::string_view_literals;

/// The chunk IHDR comes first (PNG specification, section 11.2.2).
std::optional<cv::Size> png_size(std::string_view bytes) {
  constexpr size_t kWidth = 16, kHeight = 20, kEnd = 24;
  if (bytes.size() < kEnd) return std::nullopt;
  return cv::Size(static_cast<int>(big_endian_at<uint32_t>(bytes, kWidth)),
                  static_cast<int>(big_endian_at<uint32_t>(bytes, kHeight)));
}

/// Walks the segments up to a start of frame, 0xc0 to 0xcf without DHT, JPG and DAC (ITU T.81, table B.1).
std::optional<cv::Size> jpeg_size(std::string_view bytes) {
  constexpr size_t kFrameHeader = 9;
  size_t position = 2;
  while (position + kFrameHeader <= bytes.size() && bytes[position] == '\xff') {
    const auto marker = static_cast<uint8_t>(bytes[position + 1]);
    if (marker == 0xff) {  // padding
      ++position;
      continue;
    }
    const bool start_of_frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (start_of_frame) {
      return cv::Size(big_endian_at<uint16_t>(bytes, position + 7),
                      big_endian_at<uint16_t>(bytes, position + 5));
    }
    position += size_t{2} + big_endian_at<uint16_t>(bytes, position + 2);
  }
  return std::nullopt;
}

}  // namespace

std::string read_bytes(const ImageLocation& image) {
  if (image.size == 0) return read_file(image.file);
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

std::optional<cv::Size> size_in_header(std::string_view bytes) {
  constexpr int kMax_px = 30'000;
  std::optional<cv::Size> size;
  if (bytes.starts_with("\x89PNG\r\n\x1a\n"sv)) {
    size = png_size(bytes);
  } else if (bytes.starts_with("\xff\xd8\xff"sv)) {
    size = jpeg_size(bytes);
  } else if (const auto header = parse_pgm_header(bytes)) {
    size = cv::Size(header->width, header->height);
  }
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
      if (const auto size = size_in_header(read_bytes(location))) return *size;
      if (first_problem.empty())
        first_problem = fmt::format("{}: neither a PNG nor a JPEG image", location.file.string());
    } catch (const InputError& error) {
      if (first_problem.empty()) first_problem = error.what();
    }
  }
  throw InputError(first_problem.empty() ? "no images" : first_problem);
}

}  // namespace kinloop
