#pragma once
// In: a source. Out: its frames, decoded and prepared for tracking ahead of time on a thread of their own.

#include <exception>
#include <optional>
#include <thread>

#include "kinloop/base/channel.hpp"
#include "kinloop/sensor/frame_source.hpp"
#include "kinloop/slam/front_end.hpp"

namespace kinloop {

/// Runs `source.next()` and `FrontEnd::prepare()` ahead of `Slam::process()`, so that the two overlap. The
/// frames and their order are those of the source; its exceptions reach the caller of `next`.
class FramePipeline {
 public:
  static constexpr size_t kFramesAhead = 4;

  /// `source` must outlive this object, and must not be used elsewhere meanwhile.
  FramePipeline(FrameSource& source, const FrontEnd& front_end);
  ~FramePipeline();
  FramePipeline(const FramePipeline&) = delete;
  FramePipeline& operator=(const FramePipeline&) = delete;

  /// The next frame; nothing at the end of the source.
  std::optional<PreparedFrame> next();

 private:
  void run_ahead();

  FrameSource& source_;
  const FrontEnd front_end_;
  Channel<PreparedFrame> frames_;
  std::exception_ptr error_;  // written before the channel is closed, read after it is drained
  std::jthread thread_;
};

}  // namespace kinloop
