#include "drivers/image_files/tiff_file.hpp"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "drivers/images/depth_files/depth_file.hpp"
#include "drivers/images/depth_files/depth_formats.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/images/image_limits.hpp"

namespace kinloop {
namespace {

tmsize_t read_memory(thandle_t handle, void* to, tmsize_t count) {
  auto& memory = *static_cast<TiffMemory*>(handle);
  if (count <= 0 || memory.at >= memory.bytes.size()) return 0;
  const size_t size = std::min(static_cast<size_t>(count), memory.bytes.size() - memory.at);
  std::memcpy(to, memory.bytes.data() + memory.at, size);
  memory.at += size;
  return static_cast<tmsize_t>(size);
}

tmsize_t refuse_to_write(thandle_t /*handle*/, void* /*from*/, tmsize_t /*count*/) {
  return 0;
}

toff_t seek_memory(thandle_t handle, toff_t offset, int whence) {
  auto& memory = *static_cast<TiffMemory*>(handle);
  const uint64_t from = whence == SEEK_CUR ? memory.at : whence == SEEK_END ? memory.bytes.size() : 0;
  return memory.at = from + offset;
}

int keep_open(thandle_t /*handle*/) {
  return 0;
}

toff_t size_of_memory(thandle_t handle) {
  return static_cast<TiffMemory*>(handle)->bytes.size();
}

int map_memory(thandle_t handle, void** base, toff_t* size) {
  const std::string_view bytes = static_cast<TiffMemory*>(handle)->bytes;
  *base = const_cast<char*>(bytes.data());  // libtiff does not write to a file opened for reading
  *size = bytes.size();
  return 1;
}

void unmap_memory(thandle_t /*handle*/, void* /*base*/, toff_t /*size*/) {}

}  // namespace

void reject_damaged_tiff() {
  throw InputError("the TIFF file is damaged or truncated; copy it again");
}

TiffFile open_tiff(TiffMemory& memory) {
  constexpr const char *kName = "TIFF", *kRead = "r";
#if TIFFLIB_VERSION >= 20221213  // 4.5.0
  constexpr uint64_t kMostBytes = kMaxDecodedPixels * sizeof(double);
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(
      require_memory(TIFFOpenOptionsAlloc()), TIFFOpenOptionsFree);
  constexpr TIFFErrorHandlerExtR kSilent = [](TIFF*, void*, const char*, const char*, va_list) { return 1; };
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), static_cast<tmsize_t>(kMostBytes));
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), kSilent, nullptr);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), kSilent, nullptr);
  TiffFile file(TIFFClientOpenExt(kName, kRead, &memory, read_memory, refuse_to_write, seek_memory, keep_open,
                                  size_of_memory, map_memory, unmap_memory, options.get()),
                TIFFClose);
#else
  // Before 4.5, handlers are those of the process.
  static const std::array kBefore = {TIFFSetErrorHandler(nullptr), TIFFSetWarningHandler(nullptr)};
  static_cast<void>(kBefore);
  TiffFile file(TIFFClientOpen(kName, kRead, &memory, read_memory, refuse_to_write, seek_memory, keep_open,
                               size_of_memory, map_memory, unmap_memory),
                TIFFClose);
#endif
  if (!file) reject_damaged_tiff();
  return file;
}

cv::Size tiff_image_size(const TiffFile& file) {
  return checked_depth_size(tiff_value<uint32_t>(file, TIFFTAG_IMAGEWIDTH),
                            tiff_value<uint32_t>(file, TIFFTAG_IMAGELENGTH));
}

cv::Size color_tiff_size(std::string_view bytes) {
  TiffMemory memory{bytes};
  return tiff_image_size(open_tiff(memory));
}

cv::Mat decode_color_tiff(std::string_view bytes) {
  constexpr uint16_t kSixteen = 16;
  TiffMemory memory{bytes};
  const TiffFile file = open_tiff(memory);
  const cv::Size size = tiff_image_size(file);
  if (tiff_value<uint16_t>(file, TIFFTAG_SAMPLESPERPIXEL) == 1 &&
      tiff_value<uint16_t>(file, TIFFTAG_BITSPERSAMPLE) == kSixteen)
    return decode_tiff(bytes);
  cv::Mat rgba(size, CV_8UC4);
  const int ok = TIFFReadRGBAImageOriented(file.get(), static_cast<uint32_t>(size.width),
                                           static_cast<uint32_t>(size.height),
                                           reinterpret_cast<uint32_t*>(rgba.data), ORIENTATION_TOPLEFT, 1);
  if (ok == 0) reject_damaged_tiff();
  cv::Mat bgr;
  cv::cvtColor(rgba, bgr, cv::COLOR_RGBA2BGR);
  return bgr;
}

}  // namespace kinloop
