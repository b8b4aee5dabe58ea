#include "session/source/masked_source.hpp"

#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/surfaces/mask.hpp"

namespace kinloop {

cv::Mat read_mask(const std::filesystem::path& path, const cv::Size& size) {
  const ColorImage image = read_color_image(path);
  if (image.size() != size)
    throw InputError(fmt::format("{}: {} x {} pixels where the colour images have {} x {}", path.string(),
                                 image.size().width, image.size().height, size.width, size.height));
  cv::Mat mask = image.gray() >= 128;  // a JPEG has no pure black
  if (cv::countNonZero(mask) == 0)
    throw InputError(
        fmt::format("{}: all pixels are black, which means to be ignored; what is to be used must be white",
                    path.string()));
  return mask;
}

MaskedSource::MaskedSource(std::unique_ptr<FrameSource> source, cv::Mat mask)
    : ForwardingSource(std::move(source)), mask_(std::move(mask)) {
  const PinholeCamera& color = this->source().camera().color;
  require(mask_.type() == CV_8UC1 && mask_.size() == cv::Size(color.width, color.height),
          "MaskedSource: the mask must be 8UC1, of the camera's size");
}

std::optional<Frame> MaskedSource::next() {
  auto frame = source().next();
  if (frame) frame->mask = intersection_of_masks(frame->mask, mask_);
  return frame;
}

}  // namespace kinloop
