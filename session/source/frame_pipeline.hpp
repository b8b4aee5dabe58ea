#pragma once
// Decodes the frames of a source and prepares them for tracking, ahead of time on a separate thread.

#include <atomic>
#include <exception>
#include <optional>
#include <thread>

#include "kinloop/sensor/source/frame_source.hpp"
#include "kinloop/tracking/front_end.hpp"
#include "session/source/channel.hpp"

namespace kinloop {

/// Runs `source.next()` and `FrontEnd::prepare()` ahead of `Slam::process()`, so that they overlap. Keeps the
/// frames and order of the source. Rethrows its exceptions in `next`.
class FramePipeline {
 public:
  static constexpr size_t kFramesAhead = 4;

  /// `source` must outlive this object and must not be used elsewhere meanwhile.
  FramePipeline(FrameSource& source, const FrontEnd& front_end);
  ~FramePipeline();
  FramePipeline(const FramePipeline&) = delete;
  FramePipeline& operator=(const FramePipeline&) = delete;

  /// Returns the next frame, or nothing at the end of the source.
  std::optional<Frame> next();

  /// Sets whether features are extracted ahead: if tracking needs them anyway, they should not wait for it.
  /// Affects time only; tracking extracts what is missing.
  void extract_features_ahead(bool wanted) { features_wanted_ = wanted; }

 private:
  void run_ahead();

  FrameSource& source_;
  const FrontEnd front_end_;
  std::atomic<bool> features_wanted_ = true;
  Channel<Frame> frames_;
  std::exception_ptr error_;  // written before the channel is closed, read after it is drained
  std::jthread thread_;
};

}  // namespace kinloop
