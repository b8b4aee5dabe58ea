#include "session/source/frame_pipeline.hpp"

#include <utility>

namespace kinloop {

FramePipeline::FramePipeline(FrameSource& source, const FrontEnd& front_end)
    : source_(source), front_end_(front_end), frames_(kFramesAhead), thread_([this] { run_ahead(); }) {}

FramePipeline::~FramePipeline() {
  frames_.close();
}

void FramePipeline::run_ahead() {
  try {
    Stopwatch watch;
    while (auto frame = source_.next()) {
      const ElapsedTime decoding = watch.elapsed();
      if (!frame->time.read_at) frame->time.read_at = std::chrono::steady_clock::now();
      Frame prepared = front_end_.prepare(*std::move(frame));
      prepared.time.decoding = decoding;
      if (features_wanted_) {
        const Stopwatch extracting;
        prepared.features = front_end_.features(prepared);
        prepared.time.extracting = extracting.elapsed();
      }
      if (!frames_.push(std::move(prepared))) break;
      watch = Stopwatch();
    }
  } catch (...) {
    error_ = std::current_exception();
  }
  frames_.close();
}

std::optional<Frame> FramePipeline::next() {
  auto frame = frames_.pop();
  if (!frame && error_) std::rethrow_exception(std::exchange(error_, nullptr));
  return frame;
}

}  // namespace kinloop
