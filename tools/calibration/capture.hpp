#pragma once
// In: frames of a live camera. Out: a folder of stills to calibrate from, and hints on the way.

#include <filesystem>
#include <optional>
#include <string>

#include "kinloop/sensor/rgbd_frame.hpp"
#include "tools/calibration/capture_guide.hpp"

namespace kinloop {

/// Whose stills are wanted.
enum class StillKind {
  kColor,  ///< 0001.png: colour alone
  kPairs   ///< 0001_color.png, 0001_ir.png, 0001_depth.png (mm): what both cameras saw
};

/// What became of a frame.
struct CaptureFeedback {
  bool kept = false;
  std::string hint;
  std::optional<BoardView> view;  ///< the board in the colour image
};

class StillCapture {
 public:
  /// Makes the folder. Throws InputError where there are images in it.
  StillCapture(std::filesystem::path folder, const Board& board, StillKind kind, size_t wanted);

  /// Looks at the next frame and keeps it where it is of use. Throws InputError for pairs where the frame has
  /// no infrared image.
  CaptureFeedback process(const RgbdFrame& frame);

  [[nodiscard]] bool finished() const { return guide_.finished(); }
  [[nodiscard]] size_t kept() const { return guide_.kept(); }

 private:
  void write(const RgbdFrame& frame) const;

  std::filesystem::path folder_;
  Board board_;
  StillKind kind_;
  CaptureGuide guide_;
};

}  // namespace kinloop
