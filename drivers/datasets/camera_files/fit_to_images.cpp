#include "drivers/datasets/camera_files/fit_to_images.hpp"

#include <cmath>

#include <fmt/format.h>

#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/sensor/camera/registration.hpp"

namespace kinloop {
namespace {

/// Of the size in the file and that of the images, or of colour and depth.
bool have_same_aspect(cv::Size a, cv::Size b) {
  constexpr double kTolerance = 0.01;  // 640 x 360 of 1366 x 768
  const double first = static_cast<double>(a.width) * b.height,
               second = static_cast<double>(b.width) * a.height;
  return std::abs(first - second) <= kTolerance * first;
}

/// The lens for images of another size and nearly the same aspect.
PinholeCamera lens_of_size(const PinholeCamera& lens, cv::Size size) {
  PinholeCamera scaled = resized(lens, size.width);
  scaled.height = size.height;
  return scaled;
}

/// A file without a size: the principal point is near the middle of the images, or it is of others.
void require_central(const CameraDescription& description, cv::Size size) {
  constexpr double kFarthest = 0.25, kWidest = 0.2, kLongest = 10;
  const PinholeCamera& lens = description.camera.color;
  const auto is_central = [&](double centre, int side) { return std::abs(centre / side - 0.5) <= kFarthest; };
  const auto is_focal = [&](double f) { return f >= kWidest * size.width && f <= kLongest * size.width; };
  if (is_central(lens.cx, size.width) && is_central(lens.cy, size.height) && is_focal(lens.fx) &&
      is_focal(lens.fy))
    return;
  throw InputError(fmt::format(
      "{}: fx {}, fy {}, cx {}, cy {} are not of images of {} x {}; give those of these images, or a "
      "camera.yaml",
      description.source, lens.fx, lens.fy, lens.cx, lens.cy, size.width, size.height));
}

/// Height and width in the order of NumPy's shapes. The principal point tells it from a camera of upright
/// images.
bool is_size_transposed(const PinholeCamera& lens, cv::Size stated, cv::Size size) {
  constexpr double kFarthest = 0.1;
  const auto is_central = [](double centre, int side) { return std::abs(centre / side - 0.5) <= kFarthest; };
  return stated.width == size.height && stated.height == size.width && is_central(lens.cx, size.width) &&
         is_central(lens.cy, size.height);
}

/// Sets the size of the images, and scales the lens to it; returns what is to be said about that.
std::string fit_size(const CameraDescription& description, cv::Size size, PinholeCamera& lens) {
  if (!description.has_size()) {
    require_central(description, size);
    lens.width = size.width, lens.height = size.height;
    return ", the size of the images";
  }
  const cv::Size stated(lens.width, lens.height);
  if (stated == size) return "";
  if (is_size_transposed(lens, stated, size)) {
    lens.width = size.width, lens.height = size.height;
    return fmt::format(", stated as {} x {}", stated.width, stated.height);
  }
  if (!have_same_aspect(stated, size)) {
    throw InputError(
        fmt::format("{}: a camera of {} x {}, but the images have {} x {}; give the camera of these "
                    "images with --camera FILE",
                    description.source, stated.width, stated.height, size.width, size.height));
  }
  lens = lens_of_size(lens, size);
  return fmt::format(", scaled from {} x {}", stated.width, stated.height);
}

std::string depth_unit_text(double depth_scale) {
  constexpr double kMillimetres = 1000;
  return depth_scale == kMillimetres ? "mm" : fmt::format("1/{} m", depth_scale);
}

/// Why a unit was taken, and what else it may be.
std::string guess_text(const DepthUnit& unit) {
  const std::string taken = depth_unit_text(unit.depth_scale);
  if (unit.divisor > 1)
    return fmt::format(
        "in {}: all values are multiples of {}, as of whole millimetres; the median is {:.1f} m (else state "
        "the "
        "unit with --depth-scale UNITS_PER_M)",
        taken, unit.divisor, unit.median_m);
  const std::string other = unit.other_scale > 0
                                ? fmt::format("; in {} it would be {:.1f} m",
                                              depth_unit_text(unit.other_scale), unit.other_median_m)
                                : "";
  return fmt::format(
      "in {}, a guess: by the median of {:.1f} m{} (a distance that you know tells; state the unit with "
      "--depth-scale UNITS_PER_M)",
      taken, unit.median_m, other);
}

/// Sets the unit of depth; returns what is to be said about it.
std::string fit_unit(const CameraDescription& description, RecordedSequence& sequence,
                     std::optional<double> given, RgbdCamera& camera) {
  if (is_metric(sequence.depth_encoding)) return "in m";
  if (given) camera.depth_scale = *given;
  if (given || description.has_depth_scale) return fmt::format("in {}", depth_unit_text(camera.depth_scale));
  if (sequence.camera) {
    camera.depth_scale = sequence.camera->depth_scale;
    return fmt::format("in {}, as the dataset has it", depth_unit_text(camera.depth_scale));
  }
  const auto unit = guess_depth_unit(sequence);
  if (!unit) {
    throw InputError(fmt::format(
        "{}: states no unit of depth, and the depth images do not tell it; add --depth-scale UNITS_PER_M",
        description.source));
  }
  camera.depth_scale = unit->depth_scale;
  if (unit->divisor == 1)  // else the values tell
    sequence.depth_unit_guess = fmt::format(
        "nobody states the unit of depth; in {} all lengths are right only if the guess is (--depth-scale)",
        depth_unit_text(unit->depth_scale));
  return guess_text(*unit);
}

}  // namespace

std::optional<cv::Size> fit_depth_size(const RecordedSequence& sequence, RgbdCamera& camera) {
  if (camera.depth || !has_header(sequence.depth_encoding)) return std::nullopt;
  const cv::Size color(camera.color.width, camera.color.height);
  cv::Size depth = color;
  try {
    const bool fits = !sequence.video.empty() || image_size(sequence.frames, &RecordedFrame::color) == color;
    if (!fits) return std::nullopt;  // of other images, said when they are read
    depth = image_size(sequence.frames, &RecordedFrame::depth);
  } catch (const InputError&) {
    return std::nullopt;  // said when the images are read
  }
  if (depth == color || !have_same_aspect(depth, color)) return std::nullopt;
  camera.depth = lens_of_size(camera.color, depth);
  return depth;
}

RgbdCamera fit_to_images(const CameraDescription& description, RecordedSequence& sequence,
                         std::optional<double> depth_scale) {
  RgbdCamera camera = description.camera;
  std::string size_note;
  if (sequence.video.empty()) {
    size_note = fit_size(description, image_size(sequence.frames, &RecordedFrame::color), camera.color);
  } else if (!description.has_size()) {
    return camera_without_images(description);
  }
  const std::string unit_note = fit_unit(description, sequence, depth_scale, camera);
  const auto depth_size = fit_depth_size(sequence, camera);
  const std::string depth_note = depth_size ? fmt::format(" of {} x {}, taken as of the same view,",
                                                          depth_size->width, depth_size->height)
                                            : "";
  if (!description.has_fps) camera.fps = median_rate_hz(sequence.frames, camera.fps);
  const PinholeCamera& lens = camera.color;
  log::info("camera of {} ({}): {} x {}{}, fx {:.1f}, fy {:.1f}, cx {:.1f}, cy {:.1f}{}; depth{} {}",
            description.source, description.format, lens.width, lens.height, size_note, lens.fx, lens.fy,
            lens.cx, lens.cy, lens.has_distortion() ? ", distortion" : "", depth_note, unit_note);
  return camera;
}

RgbdCamera camera_without_images(const CameraDescription& description) {
  if (description.has_size()) return description.camera;
  throw InputError(fmt::format("{}: states no image size, which this source needs; write a camera.yaml",
                               description.source));
}

}  // namespace kinloop
