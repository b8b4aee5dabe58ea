#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <vector>

#include <png.h>

#include "drivers/image_files/png.hpp"
#include "kinloop/sensor/images/image_limits.hpp"

namespace kinloop {
namespace {

/// Bytes not read yet.
struct PngInput {
  std::string_view bytes;
};

void read_bytes(png_structp png, png_bytep to, size_t count) {
  auto& input = *static_cast<PngInput*>(png_get_io_ptr(png));
  if (count > input.bytes.size()) png_error(png, "truncated");
  std::memcpy(to, input.bytes.data(), count);
  input.bytes.remove_prefix(count);
}

[[noreturn]] void on_error(png_structp png, png_const_charp) {
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

/// Owns libpng's state.
struct PngReader {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, on_error, on_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;

  PngReader() = default;
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

// libpng reports errors by a jump, which must not leave a function that owns anything: the two functions
// below own nothing.

/// Reads the header and requests the form of `decode_png_with_libpng`. Returns false if the file is damaged
/// or its size absurd.
bool read_png_header(png_structp png, png_infop info, PngInput& input) {
  const uint64_t file_bytes = input.bytes.size();
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_user_limits(png, kMaxPngSide_px, kMaxPngSide_px);
  png_set_read_fn(png, &input, read_bytes);
  png_read_info(png, info);
  const uint64_t rows = png_get_image_height(png, info), cols = png_get_image_width(png, info);
  if (rows * cols > kMaxDecodedPixels || png_get_rowbytes(png, info) * rows > kMaxInflation * file_bytes)
    return false;
  png_set_expand(png);
  png_set_strip_alpha(png);
  png_set_bgr(png);
  if (std::endian::native == std::endian::little) png_set_swap(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  return true;
}

bool read_png_rows(png_structp png, uint8_t** rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

}  // namespace

cv::Mat decode_png_with_libpng(std::string_view bytes) {
  PngReader reader;
  if (reader.info == nullptr) return {};
  PngInput input{bytes};
  if (!read_png_header(reader.png, reader.info, input)) return {};
  const int depth = png_get_bit_depth(reader.png, reader.info) == 16 ? CV_16U : CV_8U;
  cv::Mat image(static_cast<int>(png_get_image_height(reader.png, reader.info)),
                static_cast<int>(png_get_image_width(reader.png, reader.info)),
                CV_MAKETYPE(depth, png_get_channels(reader.png, reader.info)));
  if (image.step < png_get_rowbytes(reader.png, reader.info)) return {};
  std::vector<uint8_t*> rows(static_cast<size_t>(image.rows));
  for (int y = 0; y < image.rows; ++y) rows[static_cast<size_t>(y)] = image.ptr(y);
  return read_png_rows(reader.png, rows.data()) ? image : cv::Mat();
}

}  // namespace kinloop
