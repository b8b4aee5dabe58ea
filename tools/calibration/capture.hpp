#pragma once
// In: frames of a live camera. Out: a folder of images to calibrate from, and hints for the user.

#include <filesystem>
#include <optional>
#include <string>

#include "kinloop/sensor/frame.hpp"
#include "tools/calibration/capture_guide.hpp"

namespace kinloop {

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
