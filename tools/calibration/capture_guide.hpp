#pragma once
// In: what a live image shows of the board, one after the other. Out: which to keep for the calibration, and
// what to do next.

#include <optional>
#include <string>
#include <vector>

#include "tools/calibration/board.hpp"

namespace kinloop {

/// How a board lies before a camera that is not known yet, roughly.
struct BoardPlacement {
  Eigen::Vector2d tilt_deg;          ///< where its face looks: to the right, downwards
  Eigen::Vector2d center;            ///< of its corners, as a fraction of the image
  Eigen::Vector2d box_min, box_max;  ///< their bounding box, as shares of the image
  double size = 0;                   ///< of the box: its larger share
};

/// The placement of a view; nothing where its corners fix none.
std::optional<BoardPlacement> placement_of(const BoardView& view);

/// What to do with an image, and what to say.
struct CaptureAdvice {
  bool keep = false;
  std::string hint;  ///< one line
};

/// Leads to stills that tell a camera: the board tilted to all sides, near, and in the corners of the image,
/// each still sharp, held still and unlike those before.
class CaptureGuide {
 public:
  explicit CaptureGuide(size_t wanted) : wanted_(wanted) {}

  /// The next image: the board in it, and over how many pixels its edges run.
  CaptureAdvice advise(const std::optional<BoardView>& view, double edge_width_px);

  [[nodiscard]] size_t kept() const { return kept_.size(); }

  /// Whether there are as many stills as wanted, and of every kind.
  [[nodiscard]] bool finished() const;

 private:
  [[nodiscard]] std::string next_hint() const;
  [[nodiscard]] bool similar_to_kept(const BoardPlacement& placement) const;

  size_t wanted_;
  std::optional<BoardView> previous_;
  std::vector<BoardPlacement> kept_;
};

}  // namespace kinloop
