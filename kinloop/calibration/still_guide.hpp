#pragma once
// In: what a live image shows of the board, one after the other. Out: which to keep for the calibration, and
// what to do next.

#include <optional>
#include <string>
#include <vector>

#include "kinloop/calibration/board.hpp"

namespace kinloop {

/// How a board lies before a camera that is not known yet, roughly.
struct BoardLie {
  Eigen::Vector2d tilt_deg;     ///< where its face looks: to the right, downwards
  Eigen::Vector2d middle;       ///< of its corners, as a share of the image
  Eigen::Vector2d first, last;  ///< the box around them, as shares of the image
  double size = 0;              ///< of the box: its larger share
};

/// The lie of a view; nothing where its corners fix none.
std::optional<BoardLie> lie_of(const BoardView& view);

/// What to do with an image, and what to say.
struct StillAdvice {
  bool keep = false;
  std::string hint;  ///< one line
};

/// Leads to stills that tell a camera: the board tilted to all sides, near, and in the corners of the image,
/// each still sharp, held still and unlike those before.
class StillGuide {
 public:
  explicit StillGuide(size_t wanted) : wanted_(wanted) {}

  /// The next image: the board in it, and over how many pixels its edges run.
  StillAdvice look(const std::optional<BoardView>& view, double edge_width_px);

  [[nodiscard]] size_t kept() const { return kept_.size(); }

  /// Whether there are as many stills as wanted, and of every kind.
  [[nodiscard]] bool finished() const;

 private:
  [[nodiscard]] std::string missing() const;
  [[nodiscard]] bool like_one_before(const BoardLie& lie) const;

  size_t wanted_;
  std::optional<BoardView> before_;
  std::vector<BoardLie> kept_;
};

}  // namespace kinloop
