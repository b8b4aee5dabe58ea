#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "session/input/checks/checks.hpp"

namespace kinloop {
namespace {

constexpr size_t kMostSamples = 20, kFewestSamples = 5;

/// Whether one mapping explains the edges much better than all others do. In 30 clean sequences the highest
/// score of a wrong mapping was 5.8, or 9.3 where the right one had 34.
bool is_clear(double score, double others) {
  constexpr double kHigh = 8, kOverOthers = 1.3, kEnough = 5.5, kFarOverOthers = 1.8;
  return (score > kHigh && score > kOverOthers * others) ||
         (score > kEnough && score > kFarOverOthers * others);
}

std::string mirror_text(const Eigen::Vector2d& scale) {
  if (scale.x() < 0 && scale.y() < 0) return "turned by 180 degrees";
  return scale.x() < 0 ? "mirrored left to right" : "upside down";
}

std::string mirror_remedy(const Eigen::Vector2d& scale) {
  if (scale.x() < 0 && scale.y() < 0) return "turn the images of one of the two streams by 180 degrees";
  return scale.x() < 0 ? "mirror the images of one of the two streams, usually depth"
                       : "flip the images of one of the two streams upside down, usually depth";
}

std::string score_text(const EdgeAlignment& a) {
  return fmt::format("edges agree with a score of {:.1f} instead of {:.1f}", a.best_score,
                     std::max(a.registered_score, 0.0));
}

/// The pinhole camera of depth images that a mapping to the colour image suggests, if the two are close.
PinholeCamera depth_camera_of(const DepthMapping& mapping, const PinholeCamera& color) {
  const Eigen::Vector2d middle(0.5 * (color.width - 1), 0.5 * (color.height - 1));
  const Eigen::Vector2d center =
      Eigen::Vector2d(color.cx, color.cy) - middle - std::max(color.width, color.height) * mapping.shift;
  const Eigen::Vector2d moved = middle + center.cwiseQuotient(mapping.scale);
  PinholeCamera depth = color;
  depth.fx /= mapping.scale.x(), depth.fy /= mapping.scale.y();
  depth.cx = moved.x(), depth.cy = moved.y();
  return depth;
}

std::string shift_text(const Eigen::Vector2d& shift_px) {
  return fmt::format("{:.0f} px {} and {:.0f} px {}", std::abs(shift_px.x()),
                     shift_px.x() < 0 ? "left" : "right", std::abs(shift_px.y()),
                     shift_px.y() < 0 ? "up" : "down");
}

template <class Sample>
void keep_every_second(std::vector<Sample>& samples) {
  for (size_t i = 1; 2 * i < samples.size(); ++i) samples[i] = std::move(samples[2 * i]);
  samples.resize((samples.size() + 1) / 2);
}

}  // namespace

Registration judge_registration(const EdgeAlignment& a) {
  constexpr double kOver = 1.3, kLikely = 5;                // what is expected needs less evidence
  constexpr double kScaleError = 0.04, kShiftError = 0.02;  // smaller ones do little harm
  const bool as_it_is = a.best_score < kOver * a.registered_score;
  if (as_it_is) {
    const bool likely = a.registered_score > std::max(kLikely, kOver * a.other_score);
    return likely ? Registration::kRegistered : Registration::kUnknown;
  }
  if (!is_clear(a.best_score, std::max(a.registered_score, a.other_score))) return Registration::kUnknown;
  if (a.best.is_mirrored()) return Registration::kMirrored;
  if ((a.best.scale.array() - 1).abs().maxCoeff() > kScaleError) return Registration::kScaled;
  return a.best.shift.cwiseAbs().maxCoeff() > kShiftError ? Registration::kShifted
                                                          : Registration::kRegistered;
}

std::optional<InputWarning> RegistrationCheck::observe(const Frame& frame) {
  constexpr size_t kFirstLook = 24, kSecondLook = 240;
  if (frames_++ % interval_ == 0) {
    images_.push_back(edge_images_of(frame));
    if (images_.size() == kMostSamples) {
      keep_every_second(images_);
      keep_every_second(samples_);
      interval_ *= 2;
    }
  }
  if (frames_ != kFirstLook && frames_ != kSecondLook) return std::nullopt;
  constexpr double kCertain = 8, kOverAsItIs = 3;
  const auto found = align_edges(samples(), AlignmentSearch::kMirrored);
  if (!found || judge_registration(*found) != Registration::kMirrored) return std::nullopt;
  if (found->best_score < std::max(kCertain, kOverAsItIs * found->registered_score)) return std::nullopt;
  return warning_of(*found);
}

std::optional<EdgeAlignment> RegistrationCheck::alignment() const {
  // Depth that is 10 % too large reaches a third of the score of registered depth.
  constexpr double kBeyondDoubt = 10;
  if (images_.size() < kFewestSamples) return std::nullopt;
  auto quick = align_edges(samples(), AlignmentSearch::kMirrored);
  if (!quick || (quick->registered_score > kBeyondDoubt && quick->best_score == quick->registered_score))
    return quick;
  return align_edges(samples(), AlignmentSearch::kAll);
}

const std::vector<EdgeSample>& RegistrationCheck::samples() const {
  while (samples_.size() < images_.size()) samples_.push_back(make_edge_sample(images_[samples_.size()]));
  return samples_;
}

std::optional<InputWarning> RegistrationCheck::verdict() const {
  const auto found = alignment();
  return found ? warning_of(*found) : std::nullopt;
}

std::optional<InputWarning> RegistrationCheck::warning_of(const EdgeAlignment& a) const {
  const double side_px = std::max(camera_.width, camera_.height);
  const PinholeCamera depth = depth_camera_of(a.best, camera_);
  const std::string remedy = fmt::format(
      "register depth to colour when recording, or describe the depth camera in camera.yaml, by its own "
      "calibration or about as depth: {{fx: {:.0f}, fy: {:.0f}, cx: {:.0f}, cy: {:.0f}}} with T_color_depth",
      depth.fx, depth.fy, depth.cx, depth.cy);
  InputWarning warning{InputFault::kDepthNotRegistered, {}, remedy, false};
  switch (judge_registration(a)) {
    case Registration::kMirrored:
      return InputWarning{
          warning.fault,
          fmt::format("depth is {} against colour ({})", mirror_text(a.best.scale), score_text(a)),
          mirror_remedy(a.best.scale), true};
    case Registration::kScaled:
      warning.evidence = fmt::format(
          "depth is not registered to colour: it fits if enlarged {:.2f} times in width and {:.2f} times in "
          "height and moved by {} ({})",
          a.best.scale.x(), a.best.scale.y(), shift_text(side_px * a.best.shift), score_text(a));
      return warning;
    case Registration::kShifted:
      warning.evidence = fmt::format("depth is not registered to colour: it fits if moved by {} ({})",
                                     shift_text(side_px * a.best.shift), score_text(a));
      return warning;
    case Registration::kUnknown:
    case Registration::kRegistered:
      break;
  }
  return std::nullopt;
}

}  // namespace kinloop
