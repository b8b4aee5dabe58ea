#include "kinloop/calibration/still_guide.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "kinloop/calibration/homography.hpp"

namespace kinloop {
namespace {

/// Stills of one kind that a calibration needs.
struct Goal {
  const char* hint;
  size_t wanted;
  bool (*met)(const BoardLie& lie);
};

constexpr double kTiltedDeg = 15, kNear = 0.6, kNearRim = 0.2;

constexpr Goal kGoals[] = {
    {"tilt the board: its left edge away from the camera", 3,
     [](const BoardLie& lie) { return lie.tilt_deg.x() < -kTiltedDeg; }},
    {"tilt the board: its right edge away from the camera", 3,
     [](const BoardLie& lie) { return lie.tilt_deg.x() > kTiltedDeg; }},
    {"tilt the board: its upper edge away from the camera", 3,
     [](const BoardLie& lie) { return lie.tilt_deg.y() < -kTiltedDeg; }},
    {"tilt the board: its lower edge away from the camera", 3,
     [](const BoardLie& lie) { return lie.tilt_deg.y() > kTiltedDeg; }},
    {"go nearer: the board should fill the image", 3, [](const BoardLie& lie) { return lie.size > kNear; }},
    {"reach the upper left corner of the image", 1,
     [](const BoardLie& lie) { return lie.first.x() < kNearRim && lie.first.y() < kNearRim; }},
    {"reach the upper right corner of the image", 1,
     [](const BoardLie& lie) { return lie.last.x() > 1 - kNearRim && lie.first.y() < kNearRim; }},
    {"reach the lower left corner of the image", 1,
     [](const BoardLie& lie) { return lie.first.x() < kNearRim && lie.last.y() > 1 - kNearRim; }},
    {"reach the lower right corner of the image", 1,
     [](const BoardLie& lie) { return lie.last.x() > 1 - kNearRim && lie.last.y() > 1 - kNearRim; }}};

/// The first goal that the stills do not meet; nullptr where all are met.
const Goal* first_missing(const std::vector<BoardLie>& stills) {
  for (const Goal& goal : kGoals) {
    if (static_cast<size_t>(std::count_if(stills.begin(), stills.end(), goal.met)) < goal.wanted)
      return &goal;
  }
  return nullptr;
}

/// Far enough from any camera's for tilts to within some degrees.
PinholeCamera usual_camera(int width, int height) {
  constexpr double kFocalShare = 0.7;  // of the width: a view of 71 degrees
  PinholeCamera camera;
  camera.width = width, camera.height = height;
  camera.fx = camera.fy = kFocalShare * width;
  camera.cx = 0.5 * (width - 1), camera.cy = 0.5 * (height - 1);
  return camera;
}

/// Whether the board lies where it lay in the image before, to a thousandth of the image's width.
bool held_still(const BoardView& now, const std::optional<BoardView>& before) {
  constexpr double kMostMovement = 0.001;
  if (!before || before->board_m != now.board_m) return false;
  double sum = 0;
  for (size_t i = 0; i < now.pixels.size(); ++i) sum += (now.pixels[i] - before->pixels[i]).norm();
  return sum <= kMostMovement * now.width * static_cast<double>(now.pixels.size());
}

}  // namespace

std::optional<BoardLie> lie_of(const BoardView& view) {
  const auto T_camera_board = board_pose(usual_camera(view.width, view.height), view);
  if (!T_camera_board) return std::nullopt;
  Eigen::Vector3d face = T_camera_board->rotation * Eigen::Vector3d::UnitZ();
  if (face.z() > 0) face = -face;  // towards the camera
  constexpr double kDegrees = 180 / std::numbers::pi;
  const Eigen::Vector2d image(view.width, view.height);
  BoardLie lie;
  lie.tilt_deg = kDegrees * Eigen::Vector2d(std::atan2(face.x(), -face.z()), std::atan2(face.y(), -face.z()));
  lie.first = lie.last = view.pixels.front();
  lie.middle.setZero();
  for (const Eigen::Vector2d& pixel : view.pixels) {
    lie.first = lie.first.cwiseMin(pixel);
    lie.last = lie.last.cwiseMax(pixel);
    lie.middle += pixel.cwiseQuotient(image) / static_cast<double>(view.pixels.size());
  }
  lie.first = lie.first.cwiseQuotient(image);
  lie.last = lie.last.cwiseQuotient(image);
  lie.size = (lie.last - lie.first).maxCoeff();
  return lie;
}

StillAdvice StillGuide::look(const std::optional<BoardView>& view, double edge_width_px) {
  constexpr double kBlurredPx = 4;
  const auto lie = view ? lie_of(*view) : std::nullopt;
  const bool still = view && held_still(*view, before_);
  before_ = view;
  if (!lie) return {false, fmt::format("show the board ({} of {})", kept(), wanted_)};
  if (edge_width_px > kBlurredPx) return {false, "blurred: hold the board still, in more light"};
  if (like_one_before(*lie)) return {false, missing()};
  if (!still) return {false, "hold the board still"};
  kept_.push_back(*lie);
  return {true, "kept; " + missing()};
}

bool StillGuide::finished() const {
  return kept() >= wanted_ && first_missing(kept_) == nullptr;
}

std::string StillGuide::missing() const {
  if (finished()) return fmt::format("that is all ({})", kept());
  const Goal* goal = first_missing(kept_);
  return fmt::format("{} ({} of {})", goal != nullptr ? goal->hint : "move or tilt the board", kept(),
                     wanted_);
}

bool StillGuide::like_one_before(const BoardLie& lie) const {
  constexpr double kTiltDeg = 10, kPlace = 0.12, kSize = 0.12;
  return std::any_of(kept_.begin(), kept_.end(), [&](const BoardLie& other) {
    return (lie.tilt_deg - other.tilt_deg).norm() < kTiltDeg && (lie.middle - other.middle).norm() < kPlace &&
           std::abs(lie.size - other.size) < kSize;
  });
}

}  // namespace kinloop
