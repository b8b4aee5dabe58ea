#pragma once
// In: the bytes of a TIFF file. Out: the file as libtiff reads it, and colour images in it.

#include <cstdint>
#include <memory>
#include <string_view>

#include <opencv2/core/mat.hpp>
#include <tiffio.h>

namespace kinloop {

/// The bytes of a file as libtiff reads them.
struct TiffMemory {
  std::string_view bytes;
  uint64_t at = 0;
};

using TiffFile = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

/// Opens the first image, without messages on stderr. The memory must outlive the result. Throws InputError.
TiffFile open_tiff(TiffMemory& memory);

[[noreturn]] void reject_damaged_tiff();

/// Returns the value of a tag, or its default; 0 without either.
template <class Value>
Value tiff_value(const TiffFile& file, uint32_t tag) {
  Value value{};
  TIFFGetFieldDefaulted(file.get(), tag, &value);
  return value;
}

/// Returns the size of the image. Throws InputError if it is impossible.
cv::Size tiff_image_size(const TiffFile& file);

/// Returns the size of the first image of a TIFF or BigTIFF file. Throws InputError.
cv::Size color_tiff_size(std::string_view bytes);

/// Decodes the first image to 8UC3 BGR, or to 16UC1 if it is grey of 16 bits. Throws InputError for kinds
/// that libtiff cannot convert to colour, and for damaged files.
cv::Mat decode_color_tiff(std::string_view bytes);

}  // namespace kinloop
