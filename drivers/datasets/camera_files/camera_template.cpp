#include "drivers/datasets/camera_files/camera_template.hpp"

#include <optional>

#include <fmt/format.h>

#include "drivers/datasets/camera_files/fit_to_images.hpp"
#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// A sensor of the aspect of the images, and its focal length as a share of the width.
struct CommonSensor {
  const char* name;
  double focal_share;
};

CommonSensor common_sensor(cv::Size size) {
  constexpr double kNarrowest = 1.5;  // between 4:3 and 16:9
  const bool wide = size.width > kNarrowest * size.height;
  return wide ? CommonSensor{"RealSense D435", 0.715} : CommonSensor{"Kinect 1 or Xtion", 525.0 / 640};
}

std::optional<cv::Size> template_size(const RecordedSequence& sequence) {
  try {
    return image_size(sequence.frames, &RecordedFrame::color);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace

std::string camera_template(const RecordedSequence& sequence) {
  const auto known = template_size(sequence);
  const cv::Size size = known.value_or(cv::Size(640, 480));
  const CommonSensor sensor = common_sensor(size);
  const std::string focal_px = fmt::format("{:.5g}", sensor.focal_share * size.width);
  const auto unit = guess_depth_unit(sequence);
  std::string text =
      known ? "A camera.yaml template with the size of the images; replace the guesses with the values "
              "of your camera (see kinloop calibrate):\n"
            : "A camera.yaml template; replace the values with those of your camera (see kinloop "
              "calibrate):\n";
  text += fmt::format("  width: {}\n  height: {}\n  fx: {}  # a guess: that of a {}\n  fy: {}  # a guess\n",
                      size.width, size.height, focal_px, sensor.name, focal_px);
  text += fmt::format("  cx: {}  # a guess: the middle\n  cy: {}  # a guess\n", 0.5 * (size.width - 1),
                      0.5 * (size.height - 1));
  text += "  distortion: [0, 0, 0, 0, 0]  # k1 k2 p1 p2 k3\n";
  text += unit ? fmt::format("  depth_scale: {}  # a guess: the median depth would be {:.1f} m\n",
                             unit->depth_scale, unit->median_m)
               : "  depth_scale: 5000  # units of the depth images per metre; 1000 for millimetres\n";
  return text + "  fps: 30\n";
}

CameraDescription common_camera(const RecordedSequence& sequence) {
  const cv::Size size = image_size(sequence.frames, &RecordedFrame::color);
  const double focal_px = common_sensor(size).focal_share * size.width;
  CameraDescription description;
  description.source = "--camera guess";
  description.format = "not known";
  set_size(description, size.width, size.height);
  set_intrinsics(description, focal_px, focal_px, 0.5 * (size.width - 1), 0.5 * (size.height - 1));
  return description;
}

}  // namespace kinloop
