#pragma once
// In: image files: PNG, JPEG, PPM, PGM, BMP and TIFF. Out: colour and depth images in kinloop's formats. A
// truncated file is an error here; the decoders alone would fill the missing part with grey.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/images/color_image.hpp"

namespace kinloop {

/// An intact image of the wrong kind (depth instead of colour, another size); the rest of its sequence
/// probably has the same problem.
class ImageFormatError : public InputError {
 public:
  using InputError::InputError;
};

/// What is said of a file that is no image.
constexpr const char* kNoImage = "neither a PNG nor a JPEG image, nor PPM, PGM, BMP or TIFF";

/// Decodes the bytes of an image file to 8 or 16 bits and one channel (grey) or three (BGR). Empty if they
/// are damaged or no such file. Does not notice a truncated JPEG: see `image_damage`.
cv::Mat decode_image(std::string_view bytes);

/// Returns the size in the header of an image file, which is the one that decoding gives; nullopt if it
/// is no such file. A small file may hold a huge image: compare its size with that of the camera first.
std::optional<cv::Size> encoded_size(std::string_view bytes);

/// Returns what is wrong with a colour image beside depth if viewers would turn it: a JPEG whose EXIF
/// orientation is not upright. Empty for others.
std::string turned_by_exif(std::string_view bytes);

/// Returns whether these are the bytes of a PNG with colour of 16 bits per channel.
bool is_color_of_16_bits(std::string_view bytes);

/// Returns 8 bits per channel; 16 bits are scaled by 255 / 65535 and rounded.
cv::Mat with_8_bits(const cv::Mat& image);

/// Reads colour, of which 8 bits per channel are kept, or grey of 8 bits. A JPEG is kept as
/// it is, with only its grey image decoded. Throws InputError naming the file and the problem.
ColorImage read_color_image(const std::filesystem::path& path);

/// Reads depth as 32FC1 metres, 0 = unknown, from a 16-bit grey PNG with `depth_scale` units per metre, in
/// which 0 and 65535 mean unknown. Throws InputError naming the file and the problem.
cv::Mat read_depth_image(const std::filesystem::path& path, double depth_scale);

/// The same from the bytes of a file, or of a part of the file at `path`.
ColorImage decode_color_image(std::string bytes, const std::filesystem::path& path);
cv::Mat decode_depth_image(const std::string& bytes, const std::filesystem::path& path, double depth_scale);

/// Returns the bytes of an image file. Throws InputError if it cannot be read, or is larger than any image.
std::string read_image_bytes(const std::filesystem::path& path);

/// Returns what is wrong with the bytes of an image file ("truncated"), or an empty string if it is intact,
/// or decoding it tells.
std::string_view image_damage(std::string_view bytes);

/// Converts 32FC1 metres to 16-bit units, `depth_scale` per metre; 0 if unknown or too far for 16 bits (some
/// readers take 65535 as unknown).
cv::Mat to_depth_units(const cv::Mat& depth_m, double depth_scale);

/// Converts 16-bit units, of which 0 and 65535 mean unknown, to 32FC1 metres.
cv::Mat from_depth_units(const cv::Mat& units, double depth_scale);

/// Writes an 8UC1, 8UC3 or 16UC1 image atomically.
void write_png(const std::filesystem::path& path, const cv::Mat& image);

/// Writes depth in `depth_scale` units per metre.
void write_depth_png(const std::filesystem::path& path, const cv::Mat& depth_m, double depth_scale);

}  // namespace kinloop
