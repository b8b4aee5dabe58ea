#include "drivers/datasets/phones/phone_camera.hpp"

#include <cmath>

#include <fmt/format.h>

#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/sensor/camera/registration.hpp"

namespace kinloop {

RgbdCamera phone_camera(std::span<const PinholeCamera> lenses, cv::Size depth_size,
                        const std::filesystem::path& file) {
  constexpr double kMillimetres = 1000, kMaxAspectError = 0.02;
  if (lenses.empty()) throw InputError(fmt::format("{}: no intrinsics", file.string()));
  const auto median_of = [&](double PinholeCamera::*parameter) {
    std::vector<double> values;
    for (const PinholeCamera& lens : lenses) values.push_back(lens.*parameter);
    return median(values);
  };
  const cv::Size size(lenses.front().width, lenses.front().height);
  RgbdCamera camera;
  camera.color = checked_lens(make_lens(size, median_of(&PinholeCamera::fx), median_of(&PinholeCamera::fy),
                                        median_of(&PinholeCamera::cx), median_of(&PinholeCamera::cy)),
                              file);
  camera.depth_scale = kMillimetres;
  if (depth_size == size) return camera;
  camera.depth = resized(camera.color, depth_size.width);
  if (std::abs(static_cast<double>(camera.depth->height) / depth_size.height - 1) > kMaxAspectError) {
    throw InputError(fmt::format(
        "{}: depth of {} x {} cannot be of the same lens as colour of {} x {}; export the recording again",
        file.string(), depth_size.width, depth_size.height, size.width, size.height));
  }
  camera.depth->height = depth_size.height;
  return camera;
}

void finish_phone_sequence(RecordedSequence& sequence, std::span<const PinholeCamera> lenses,
                           const std::filesystem::path& file) {
  keep_increasing(sequence);
  sequence.camera = phone_camera(lenses, image_size(sequence.frames, &RecordedFrame::depth), file);
  sequence.camera->fps = median_rate_hz(sequence.frames, sequence.camera->fps);
  sequence.sensor = DepthSensorModel::kIphone;
}

}  // namespace kinloop
