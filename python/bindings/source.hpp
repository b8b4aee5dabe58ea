#pragma once
// Frames and their sources in Python.

#include <memory>
#include <mutex>
#include <optional>

#include "kinloop/sensor/source/frame_source.hpp"
#include "kinloop/tracking/front_end.hpp"
#include "python/bindings/bindings.hpp"
#include "session/source/frame_pipeline.hpp"

namespace kinloop::python {

class FrameReader;

/// A frame, and what has been prepared of it.
struct PyFrame {
  Frame data;
  uint64_t prepared_for = 0;  ///< the run whose front end prepared it; 0: only read
  uint32_t first_frame = 0;   ///< added to its id by that front end
  std::weak_ptr<FrameReader> reader;

  /// Returns the frame as read.
  [[nodiscard]] Frame raw() const;
};

/// Reads a source, from the first frame that a run processes on ahead of it, like `Session`: a loop in Python
/// takes no longer than `kinloop run`.
class FrameReader : public std::enable_shared_from_this<FrameReader> {
 public:
  explicit FrameReader(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}

  [[nodiscard]] const RgbdCamera& camera() const { return source_->camera(); }
  [[nodiscard]] const SourceInfo& info() const { return source_->info(); }
  /// Returns the frames skipped so far; of a source that is read ahead, all once it is at its end.
  [[nodiscard]] SkippedFrames skipped();

  /// Returns the next frame, or nothing at the end.
  std::optional<PyFrame> next();

  /// Further frames are prepared ahead for `run` by its front end, unless they already are for some run. Does
  /// not wait for a frame being read.
  void prepare_for(uint64_t run, const FrontEnd& front_end, bool expects_keypoints);

 private:
  std::optional<PyFrame> read();

  std::mutex mutex_;  // guards all below
  std::unique_ptr<FrameSource> source_;
  uint64_t run_ = 0;  // 0: not read ahead
  uint32_t first_frame_ = 0;
  std::optional<FramePipeline> pipeline_;
  bool ended_ = false;
  SkippedFrames skipped_;
};

}  // namespace kinloop::python
