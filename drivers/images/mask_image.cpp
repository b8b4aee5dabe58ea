#include "drivers/images/mask_image.hpp"

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "drivers/image_files/image_file.hpp"

namespace kinloop {

void require_mask_size(const cv::Size& size, const cv::Size& expected, const std::string& name) {
  if (size == expected) return;
  throw MaskFormatError(
      fmt::format("{}: a mask of {} x {} pixels where the colour image has {} x {}; make masks "
                  "of the size of the images",
                  name, size.width, size.height, expected.width, expected.height));
}

cv::Mat decode_mask(const std::string& bytes, const cv::Size& size, const std::string& name) {
  constexpr std::string_view kPngSignature = "\x89PNG";
  if (const auto damage = image_damage(bytes); !damage.empty())
    throw InputError(fmt::format("{}: {}", name, damage));
  if (const auto encoded = encoded_size(bytes)) require_mask_size(*encoded, size, name);  // before decoding
  const cv::Mat image = decode_image(bytes);
  if (image.empty()) throw InputError(fmt::format("{}: the image is damaged; copy it again", name));
  if (image.type() != CV_8UC1 || !bytes.starts_with(kPngSignature))
    throw MaskFormatError(
        fmt::format("{}: not an 8-bit grey PNG, as masks are ({} bits, {} channels); write 0 "
                    "where pixels are to be ignored and 255 elsewhere",
                    name, 8 * image.elemSize1(), image.channels()));
  return image != 0;
}

}  // namespace kinloop
