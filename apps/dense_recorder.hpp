#pragma once
// Listens to a run and keeps the images of its keyframes, so that the dense map can be made from their final
// poses.

#include <optional>

#include "kinloop/dense/fuse_keyframes.hpp"
#include "kinloop/output/map_file.hpp"
#include "kinloop/slam/frame_log.hpp"
#include "kinloop/slam/listener.hpp"

namespace kinloop {

class DenseRecorder : public Listener {
 public:
  DenseRecorder(const RgbdCamera& camera, const DenseOptions& options);

  void on_frame(const FrameResult& result, const PreparedFrame& frame) override;
  void on_map(const Map&) override {}

  /// Keeps images of a map file. Their depth must be in the units of the camera.
  void restore(const SavedImages& saved);

  [[nodiscard]] size_t image_count() const { return frame_of_image_.size(); }

  [[nodiscard]] FrameId frame_of_image(size_t index) const { return frame_of_image_.at(index); }

  /// What a map file keeps of image `index`.
  [[nodiscard]] SavedImages saved_images(size_t index) const {
    return {frame_of_image_.at(index), images_.encoded(index)};
  }

  [[nodiscard]] const KeyframeImages& images() const { return images_; }

  /// The images whose place is known, at the poses of `log` and `map`.
  [[nodiscard]] std::vector<PosedImage> views(const FrameLog& log, const Map& map) const;

  /// The coloured cloud of all images kept, at the poses of `log` and `map`.
  [[nodiscard]] ColoredCloud fuse(const FrameLog& log, const Map& map, int threads,
                                  const Progress& progress) const;

  /// The images of a frame, where they were kept: those of every keyframe are.
  [[nodiscard]] std::optional<RgbdImages> images_of(FrameId frame) const;

 private:
  RgbdCamera camera_;
  DenseOptions options_;
  KeyframeImages images_;
  std::vector<FrameId> frame_of_image_;
};

}  // namespace kinloop
