#pragma once
// Logs the events of a run, one line each (--verbose): the input, keyframes, tracking losses,
// relocalisations, loops and stages.

#include <set>
#include <string>
#include <string_view>

#include "kinloop/core/progress.hpp"
#include "kinloop/sensor/source/frame_source.hpp"
#include "kinloop/slam/listener.hpp"

namespace kinloop {

class RunLogger : public Listener {
 public:
  void on_frame(const TrackedFrame& result) override;
  void on_map(const Map& map) override;

 private:
  std::string_view state_;  // of the last frame, a literal
  std::set<LoopEnds> loops_logged_, refuted_logged_;
  size_t keyframes_logged_ = 0;
};

/// Logs what a recording was taken for.
void log_recognition(const FrameSource& source);

/// Logs the input and settings of a run.
void log_run_start(const FrameSource& source, int threads);

/// Logs the beginning of each stage, instead of a progress bar.
Progress make_stage_logger();

/// Summarises the progress of a run in a few words: "tracking, 44 keyframes, 5 loops".
std::string progress_note(const TrackedFrame& result, const Map& map);

}  // namespace kinloop
