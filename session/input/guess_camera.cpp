#include "session/input/guess_camera.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "drivers/datasets/camera_files/camera_template.hpp"
#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/open_sequence.hpp"
#include "drivers/datasets/recorded_source.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/map/frames/frame_velocities.hpp"
#include "kinloop/slam/slam.hpp"
#include "session/input/focal_length.hpp"

namespace kinloop {
namespace {

/// The estimate of a map of the first frames; nullopt if they give none.
std::optional<FocalLengthEstimate> estimate_from_first_frames(const OpenedSequence& opened) {
  constexpr int kFrames = 300;
  RecordedSource source(opened.name, opened.sequence, opened.camera);
  SlamOptions options;
  options.loop.enabled = false;
  options.self_calibration.enabled = false;
  Slam slam(source.camera(), options);
  for (int i = 0; i < kFrames; ++i) {
    const auto frame = source.next();
    if (!frame) break;
    slam.process(*frame);
  }
  slam.finish();
  return estimate_focal_length(slam.map(), slam.sensor_estimate(),
                               keyframe_velocities(slam.log(), slam.map()));
}

CameraDescription scaled(CameraDescription description, double factor) {
  PinholeCamera& lens = description.camera.color;
  lens.fx *= factor;
  lens.fy *= factor;
  return description;
}

double angle_deg(int side_px, double focal_px) {
  return 2 * std::atan(0.5 * side_px / focal_px) * 180 / M_PI;
}

}  // namespace

GuessedCamera guess_camera(const std::string& path, std::optional<double> depth_scale,
                           const std::string& name) {
  constexpr int kMostRounds = 6;
  constexpr double kConverged = 0.01, kMaxSigma = 0.02, kLargestStep = 0.25;
  constexpr double kShortest = 0.4, kLongest = 2.5;  // as a share of the width
  const LocatedSequence located = locate_sequence(path, name);
  GuessedCamera guess;
  guess.description = with_shown_paths(located, [&] {
    const SequenceLayout* layout = recognise_layout(located.folder);
    if (layout == nullptr) reject_sequence(located.folder, true);
    return common_camera(layout->read(located.folder));
  });
  const PinholeCamera& lens = guess.description.camera.color;
  OpenedSequence opened = read_located(located, guess.description, depth_scale);
  while (guess.rounds < kMostRounds) {
    opened.camera.color.fx = lens.fx, opened.camera.color.fy = lens.fy;
    const auto found = estimate_from_first_frames(opened);
    ++guess.rounds;
    if (!found) return guess;
    const double factor =
        std::clamp(0.5 * (found->factor_x + found->factor_y), 1 - kLargestStep, 1 + kLargestStep);
    const double share = factor * lens.fx / lens.width;
    if (!(share > kShortest && share < kLongest)) return guess;
    guess.description = scaled(guess.description, factor);
    guess.sigma = 0.5 * (found->sigma_x + found->sigma_y);
    guess.is_certain = std::abs(factor - 1) < kConverged && guess.sigma < kMaxSigma;
    if (std::abs(factor - 1) < kConverged) return guess;
  }
  return guess;
}

CameraDescription guess_camera_aloud(const std::string& path, std::optional<double> depth_scale,
                                     const std::string& name) {
  const GuessedCamera guess = guess_camera(path, depth_scale, name);
  const PinholeCamera& lens = guess.description.camera.color;
  const std::string known = guess.sigma > 0 ? fmt::format("+- {:.0f}", guess.sigma * lens.fx)
                                            : std::string("that of a common sensor");
  const std::string found =
      fmt::format("fx = fy = {:.0f} px ({}), {:.0f} x {:.0f} degrees, after {} map{} of the first frames",
                  lens.fx, known, angle_deg(lens.width, lens.fx), angle_deg(lens.height, lens.fy),
                  guess.rounds, guess.rounds == 1 ? "" : "s");
  if (guess.is_certain) {
    log::info("--camera guess: {}; the principal point is taken as the middle, distortion as none", found);
  } else {
    log::warn("--camera guess: not sure: {}; the images do not tell the focal length, give the camera",
              found);
  }
  return guess.description;
}

}  // namespace kinloop
