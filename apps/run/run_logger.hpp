#pragma once
// Listens to a run and says what happens, a line each (--verbose): the input, keyframes, losses,
// relocalisations, loops and the stages of the work.

#include <optional>
#include <string>

#include "kinloop/base/progress.hpp"
#include "kinloop/sensor/frame_source.hpp"
#include "kinloop/slam/listener.hpp"

namespace kinloop {

class RunLogger : public Listener {
 public:
  void on_frame(const FrameResult& result, const PreparedFrame& frame) override;
  void on_map(const Map& map) override;

 private:
  std::optional<TrackStatus> status_;
  size_t loops_logged_ = 0;
  size_t keyframes_logged_ = 0;
};

/// Says what a run works on.
void log_run_start(const FrameSource& source, int threads);

/// Says when a stage begins, instead of a progress bar.
Progress make_stage_logger();

/// How a run goes, in a few words: "tracking, 44 keyframes, 5 loops".
std::string progress_note(const FrameResult& result, const Map& map);

}  // namespace kinloop
