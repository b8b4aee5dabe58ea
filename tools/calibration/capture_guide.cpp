#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "tools/calibration/board/homography.hpp"
#include "tools/calibration/capture.hpp"

namespace kinloop {
namespace {

/// A kind of view that a calibration needs.
struct Goal {
  const char* hint;
  size_t wanted;
  bool (*met)(const BoardPlacement& placement);
};

constexpr double kTiltedDeg = 15, kNear = 0.6, kNearRim = 0.2;

constexpr Goal kGoals[] = {
    {"tilt the left edge of the board away from the camera", 3,
     [](const BoardPlacement& placement) { return placement.tilt_deg.x() < -kTiltedDeg; }},
    {"tilt the right edge of the board away from the camera", 3,
     [](const BoardPlacement& placement) { return placement.tilt_deg.x() > kTiltedDeg; }},
    {"tilt the upper edge of the board away from the camera", 3,
     [](const BoardPlacement& placement) { return placement.tilt_deg.y() < -kTiltedDeg; }},
    {"tilt the lower edge of the board away from the camera", 3,
     [](const BoardPlacement& placement) { return placement.tilt_deg.y() > kTiltedDeg; }},
    {"move closer: the board should fill the image", 3,
     [](const BoardPlacement& placement) { return placement.size > kNear; }},
    {"move the board into the upper left corner of the image", 1,
     [](const BoardPlacement& placement) {
       return placement.box_min.x() < kNearRim && placement.box_min.y() < kNearRim;
     }},
    {"move the board into the upper right corner of the image", 1,
     [](const BoardPlacement& placement) {
       return placement.box_max.x() > 1 - kNearRim && placement.box_min.y() < kNearRim;
     }},
    {"move the board into the lower left corner of the image", 1,
     [](const BoardPlacement& placement) {
       return placement.box_min.x() < kNearRim && placement.box_max.y() > 1 - kNearRim;
     }},
    {"move the board into the lower right corner of the image", 1, [](const BoardPlacement& placement) {
       return placement.box_max.x() > 1 - kNearRim && placement.box_max.y() > 1 - kNearRim;
     }}};

/// The first goal that the images do not meet yet; nullptr if all are met.
const Goal* first_unmet_goal(const std::vector<BoardPlacement>& stills) {
  for (const Goal& goal : kGoals) {
    if (static_cast<size_t>(std::count_if(stills.begin(), stills.end(), goal.met)) < goal.wanted)
      return &goal;
  }
  return nullptr;
}

/// Accurate enough to measure tilts to within some degrees with any camera.
PinholeCamera typical_camera(int width, int height) {
  constexpr double kFocalShare = 0.7;  // of the width: a field of view of 71 degrees
  PinholeCamera camera;
  camera.width = width, camera.height = height;
  camera.fx = camera.fy = kFocalShare * width;
  camera.cx = 0.5 * (width - 1), camera.cy = 0.5 * (height - 1);
  return camera;
}

/// Whether the board moved less than a thousandth of the image width since the previous image.
bool is_stationary(const BoardView& now, const std::optional<BoardView>& before) {
  constexpr double kMaxMovement = 0.001;
  if (!before || before->board_m != now.board_m) return false;
  double sum = 0;
  for (size_t i = 0; i < now.pixels.size(); ++i) sum += (now.pixels[i] - before->pixels[i]).norm();
  return sum <= kMaxMovement * now.width * static_cast<double>(now.pixels.size());
}

}  // namespace

std::optional<BoardPlacement> placement_of(const BoardView& view) {
  const auto T_camera_board = board_pose(typical_camera(view.width, view.height), view);
  if (!T_camera_board) return std::nullopt;
  Eigen::Vector3d face = T_camera_board->rotation * Eigen::Vector3d::UnitZ();
  if (face.z() > 0) face = -face;  // towards the camera
  constexpr double kDegrees = 180 / std::numbers::pi;
  const Eigen::Vector2d image(view.width, view.height);
  BoardPlacement placement;
  placement.tilt_deg =
      kDegrees * Eigen::Vector2d(std::atan2(face.x(), -face.z()), std::atan2(face.y(), -face.z()));
  placement.box_min = placement.box_max = view.pixels.front();
  placement.center.setZero();
  for (const Eigen::Vector2d& pixel : view.pixels) {
    placement.box_min = placement.box_min.cwiseMin(pixel);
    placement.box_max = placement.box_max.cwiseMax(pixel);
    placement.center += pixel.cwiseQuotient(image) / static_cast<double>(view.pixels.size());
  }
  placement.box_min = placement.box_min.cwiseQuotient(image);
  placement.box_max = placement.box_max.cwiseQuotient(image);
  placement.size = (placement.box_max - placement.box_min).maxCoeff();
  return placement;
}

CaptureAdvice CaptureGuide::advise(const std::optional<BoardView>& view, double edge_width_px) {
  constexpr double kBlurredPx = 4;
  const auto placement = view ? placement_of(*view) : std::nullopt;
  const bool still = view && is_stationary(*view, previous_);
  previous_ = view;
  if (!placement) return {false, fmt::format("show the board ({} of {})", kept(), wanted_)};
  if (edge_width_px > kBlurredPx) return {false, "blurred: hold the board still or add light"};
  if (similar_to_kept(*placement)) return {false, next_hint()};
  if (!still) return {false, "hold the board still"};
  kept_.push_back(*placement);
  return {true, "kept; " + next_hint()};
}

bool CaptureGuide::finished() const {
  return kept() >= wanted_ && first_unmet_goal(kept_) == nullptr;
}

std::string CaptureGuide::next_hint() const {
  if (finished()) return fmt::format("done ({})", kept());
  const Goal* goal = first_unmet_goal(kept_);
  return fmt::format("{} ({} of {})", goal != nullptr ? goal->hint : "move or tilt the board", kept(),
                     wanted_);
}

bool CaptureGuide::similar_to_kept(const BoardPlacement& placement) const {
  constexpr double kTiltDeg = 10, kPlace = 0.12, kSize = 0.12;
  return std::any_of(kept_.begin(), kept_.end(), [&](const BoardPlacement& other) {
    return (placement.tilt_deg - other.tilt_deg).norm() < kTiltDeg &&
           (placement.center - other.center).norm() < kPlace && std::abs(placement.size - other.size) < kSize;
  });
}

}  // namespace kinloop
