#pragma once
// In: frames of a live camera. Out: a folder of images to calibrate from, and hints for the user.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/sensor/frame.hpp"
#include "tools/calibration/board/board.hpp"

namespace kinloop {

/// Returns how sharp the image is: the median width of the board's black-to-white edges in pixels, 2 for a
/// perfect step, 2.5 sigma if the image is blurred by sigma.
double edge_width_px(const cv::Mat& image, const BoardView& view);

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

/// What to capture.
enum class StillKind {
  kColor,  ///< 0001.png: colour only
  kPairs   ///< 0001_color.png, 0001_ir.png, 0001_depth.png (mm): both cameras
};

/// The result of processing a frame.
struct CaptureFeedback {
  bool kept = false;
  std::string hint;
  std::optional<BoardView> view;  ///< the board in the colour image
};

class StillCapture {
 public:
  /// Creates the folder. Throws InputError if it contains images.
  StillCapture(std::filesystem::path folder, const Board& board, StillKind kind, size_t wanted);

  /// Processes the next frame and saves it if useful. Throws InputError for pairs if the frame has no
  /// infrared image.
  CaptureFeedback process(const Frame& frame);

  [[nodiscard]] bool finished() const { return guide_.finished(); }
  [[nodiscard]] size_t kept() const { return guide_.kept(); }

 private:
  void write(const Frame& frame) const;

  std::filesystem::path folder_;
  Board board_;
  StillKind kind_;
  CaptureGuide guide_;
};

}  // namespace kinloop
