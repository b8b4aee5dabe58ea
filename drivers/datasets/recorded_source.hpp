#pragma once
// In: a recorded sequence in any layout. Out: its frames.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/datasets/reading/images/video_reader.hpp"
#include "drivers/datasets/recorded_sequence.hpp"
#include "kinloop/sensor/camera/registration.hpp"
#include "kinloop/sensor/source/frame_source.hpp"
#include "kinloop/sensor/source/guessed_unit.hpp"
#include "kinloop/sensor/source/passable_source.hpp"

namespace kinloop {

/// Damaged frames (missing, truncated, not an image, wrong size, depth not 16-bit) and rows whose time stamp
/// does not increase are skipped and counted. Unregistered depth (a depth camera of its own) is registered to
/// colour; depth of the lowest confidence is unknown. A mask of another size or kind is an error, which
/// `next` throws.
class RecordedSource : public FrameSource, public PassableSource, public GuessedUnit {
 public:
  /// `name` is the source as given by the user. Throws InputError naming file and remedy if the sequence is
  /// unusable: no image to read, or images of another size than the camera's.
  RecordedSource(std::string name, RecordedSequence sequence, const RgbdCamera& camera);

  /// Throws InputError at the end if not a single frame was intact.
  std::optional<Frame> next() override;
  bool pass_over() override;
  [[nodiscard]] const std::string& depth_unit_guess() const override { return sequence_.depth_unit_guess; }
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override { return sequence_.skipped; }

 private:
  /// Throws InputError if the first images are all of the wrong size or format.
  void require_expected_format() const;
  /// Says if colour has more bits than are used, and warns if it would become nearly black.
  void tell_kept_bits(const RecordedFrame& files) const;
  [[nodiscard]] Frame read_images(const RecordedFrame& files) const;
  /// The message of an error, with paths as they are in the archive, if the sequence is in one.
  [[nodiscard]] std::string shown(const std::exception& error) const;

  RgbdCamera camera_;
  RecordedSequence sequence_;
  SourceInfo info_;
  DepthPreparation prepare_depth_;
  std::unique_ptr<VideoReader> video_;  ///< if colour is a video
  size_t next_file_ = 0;
  uint32_t next_id_ = 0;
  std::string first_failure_;  ///< why the first frame that was read is not usable
};

}  // namespace kinloop
