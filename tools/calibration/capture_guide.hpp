#pragma once
// In: board detections in successive live images. Out: which images to keep for calibration, and instructions
// for the user.

#include <optional>
#include <string>
#include <vector>

#include "tools/calibration/board.hpp"

namespace kinloop {

/// Approximate placement of a board in front of an uncalibrated camera.
struct BoardPlacement {
  Eigen::Vector2d tilt_deg;          ///< direction of its normal: to the right, downwards
  Eigen::Vector2d center;            ///< mean of its corners, as a fraction of the image
  Eigen::Vector2d box_min, box_max;  ///< their bounding box, as a fraction of the image
  double size = 0;                   ///< the larger side of the box
};

/// Returns the placement of a view; nullopt if its corners do not determine one.
std::optional<BoardPlacement> placement_of(const BoardView& view);

/// Whether to keep an image, and the hint for the user.
struct CaptureAdvice {
  bool keep = false;
  std::string hint;  ///< one line
};

/// Guides the user to images that determine a camera: the board tilted in all directions, close, and in the
/// corners of the image; each image sharp, still and different from the previous ones.
class CaptureGuide {
 public:
  explicit CaptureGuide(size_t wanted) : wanted_(wanted) {}

  /// Processes the next image, given its detection and the width of its edges in pixels.
  CaptureAdvice advise(const std::optional<BoardView>& view, double edge_width_px);

  [[nodiscard]] size_t kept() const { return kept_.size(); }

  /// Returns whether there are enough images, with every kind of view.
  [[nodiscard]] bool finished() const;

 private:
  [[nodiscard]] std::string next_hint() const;
  [[nodiscard]] bool similar_to_kept(const BoardPlacement& placement) const;

  size_t wanted_;
  std::optional<BoardView> previous_;
  std::vector<BoardPlacement> kept_;
};

}  // namespace kinloop
