#pragma once
// A colour image of which usually only the grey image is needed.

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Holds either pixels or the bytes of a JPEG file together with the grey image decoded from them. Immutable:
/// copies share the data, several threads may read one image, and the images returned must not be modified.
class ColorImage {
 public:
  ColorImage() = default;

  /// Holds pixels, 8UC3 BGR, which must not change afterwards. Throws std::logic_error for another type.
  ColorImage(cv::Mat bgr);  // NOLINT(google-explicit-constructor): sources assign their pixels

  /// Holds a JPEG file and decodes its grey image, so that damage is noticed here. Nothing if the file cannot
  /// be decoded.
  static std::optional<ColorImage> from_jpeg(std::string file);

  [[nodiscard]] bool empty() const { return size().empty(); }
  [[nodiscard]] cv::Size size() const { return (jpeg_ ? gray_ : bgr_).size(); }

  /// Returns the image as 8UC1. Of a JPEG: its luma, without any work; of pixels: converted at each call.
  [[nodiscard]] cv::Mat gray() const;

  /// Returns the image as 8UC3 BGR. A JPEG is decoded at each call; pixels are returned without any work.
  [[nodiscard]] cv::Mat bgr() const;

  /// Returns the bytes of the JPEG file, or nothing if the image holds pixels.
  [[nodiscard]] std::string_view jpeg() const {
    return jpeg_ ? std::string_view(*jpeg_) : std::string_view();
  }

 private:
  cv::Mat bgr_;   ///< empty if there is a JPEG file
  cv::Mat gray_;  ///< of the JPEG file
  std::shared_ptr<const std::string> jpeg_;
};

}  // namespace kinloop
