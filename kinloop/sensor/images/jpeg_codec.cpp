#include "kinloop/sensor/images/jpeg_codec.hpp"

#include <charconv>
#include <cstdint>
#include <memory>
#include <new>

#include <turbojpeg.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/images/image_limits.hpp"

namespace kinloop {
namespace {

using JpegDecoder = std::unique_ptr<void, decltype(&tjDestroy)>;

const unsigned char* data_of(std::string_view bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

std::optional<cv::Size> read_jpeg_header(const JpegDecoder& decoder, std::string_view bytes) {
  int width = 0, height = 0, subsampling = 0, color_space = 0;
  if (!decoder || tjDecompressHeader3(decoder.get(), data_of(bytes), bytes.size(), &width, &height,
                                      &subsampling, &color_space) != 0) {
    return std::nullopt;
  }
  return cv::Size(width, height);
}

/// Whether a warning means damage. Some cameras pad the compressed data with a few bytes.
bool means_damage(std::string_view warning) {
  constexpr std::string_view kCorrupt = "Corrupt JPEG data: ", kExtraneous = " extraneous bytes";
  constexpr unsigned kMaxPaddingBytes = 8;
  if (!warning.starts_with(kCorrupt)) return true;
  warning.remove_prefix(kCorrupt.size());
  unsigned bytes = 0;
  const auto [end, error] = std::from_chars(warning.data(), warning.data() + warning.size(), bytes);
  warning.remove_prefix(static_cast<size_t>(end - warning.data()));
  return error != std::errc() || bytes > kMaxPaddingBytes || !warning.starts_with(kExtraneous);
}

cv::Mat decode_jpeg_as(std::string_view bytes, int type, TJPF pixel_format) {
  const JpegDecoder decoder(require_memory(tjInitDecompress()), tjDestroy);
  const auto size = read_jpeg_header(decoder, bytes);
  if (!size || static_cast<uint64_t>(int64_t{size->width} * size->height) > kMaxDecodedPixels) return {};
  cv::Mat image(*size, type);
  // A progressive file may have any number of scans, each over the whole image.
  const int result =
      tjDecompress2(decoder.get(), data_of(bytes), bytes.size(), image.data, size->width,
                    static_cast<int>(image.step), size->height, pixel_format, TJFLAG_LIMITSCANS);
  if (result == 0) return image;
  const bool failed =
      tjGetErrorCode(decoder.get()) != TJERR_WARNING || means_damage(tjGetErrorStr2(decoder.get()));
  return failed ? cv::Mat() : image;
}

}  // namespace

std::optional<cv::Size> jpeg_size(std::string_view bytes) {
  return read_jpeg_header(JpegDecoder(require_memory(tjInitDecompress()), tjDestroy), bytes);
}

cv::Mat decode_jpeg(std::string_view bytes) {
  return decode_jpeg_as(bytes, CV_8UC3, TJPF_BGR);
}

cv::Mat decode_jpeg_gray(std::string_view bytes) {
  return decode_jpeg_as(bytes, CV_8UC1, TJPF_GRAY);
}

std::vector<uint8_t> encode_jpeg(const cv::Mat& image, int quality) {
  require(!image.empty() && (image.type() == CV_8UC1 || image.type() == CV_8UC3),
          "encode_jpeg: expected 8UC1 or 8UC3");
  const bool gray = image.type() == CV_8UC1;
  const int subsampling = gray ? TJSAMP_GRAY : TJSAMP_420;
  const std::unique_ptr<void, decltype(&tjDestroy)> encoder(require_memory(tjInitCompress()), tjDestroy);
  std::vector<uint8_t> bytes(tjBufSize(image.cols, image.rows, subsampling));
  unsigned char* begin = bytes.data();
  unsigned long size = bytes.size();
  const int result = tjCompress2(encoder.get(), image.data, image.cols, static_cast<int>(image.step),
                                 image.rows, gray ? TJPF_GRAY : TJPF_BGR, &begin, &size, subsampling, quality,
                                 TJFLAG_NOREALLOC | TJFLAG_ACCURATEDCT);
  if (result != 0) throw std::bad_alloc();  // all that can fail with these arguments
  return {begin, begin + size};
}

}  // namespace kinloop
