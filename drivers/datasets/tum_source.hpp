#pragma once
// In: a folder in the layout of the TUM RGB-D benchmark (rgb.txt, depth.txt, optional associations.txt,
// groundtruth.txt and camera.yaml). Out: its frames.

#include <filesystem>
#include <optional>
#include <vector>

#include "drivers/datasets/tum_listing.hpp"
#include "kinloop/sensor/frame_source.hpp"
#include "kinloop/sensor/registration.hpp"

namespace kinloop {

/// A recorded sequence. Damaged frames (missing, truncated, not an image, wrong size, depth not 16-bit) and
/// rows whose time stamp does not increase are skipped and counted. Unregistered depth (a `depth` block in
/// camera.yaml) is registered to colour.
class TumSource : public FrameSource {
 public:
  /// Uses the camera that `choose_camera` finds for the folder.
  explicit TumSource(const std::filesystem::path& folder);

  /// Throws InputError naming file, line and remedy if the sequence is unusable: nothing to read, images of
  /// another size than the camera's, or an invalid ground truth.
  TumSource(const std::filesystem::path& folder, const RgbdCamera& camera);

  /// Throws InputError at the end if not a single frame was intact.
  std::optional<RgbdFrame> next() override;
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] std::vector<SkippedFrame> skipped() const override { return skipped_; }

 private:
  /// Throws InputError if the first images are all of the wrong size or format.
  void require_expected_format() const;
  [[nodiscard]] RgbdFrame read_images(const FrameFiles& files) const;
  [[nodiscard]] RgbdFrame read_frame(const FrameFiles& files) const;

  RgbdCamera camera_;
  std::optional<DepthRegistration> registration_;  ///< if depth is not registered to colour
  SourceInfo info_;
  std::vector<FrameFiles> frames_;
  size_t next_file_ = 0;
  uint32_t next_id_ = 0;
  std::vector<SkippedFrame> skipped_;
};

}  // namespace kinloop
