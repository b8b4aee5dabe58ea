#pragma once
// Records a row per frame for frames.txt.

#include "kinloop/core/timings.hpp"
#include "kinloop/slam/listener.hpp"
#include "viewer/report/frame_table.hpp"

namespace kinloop {

class FrameRecorder : public Listener {
 public:
  void on_frame(const TrackedFrame& result) override;
  void on_map(const Map&) override {}

  /// Returns the rows, with the time of each frame.
  [[nodiscard]] FrameTable table(const Timings& times) const;

 private:
  FrameTable rows_;
};

}  // namespace kinloop
