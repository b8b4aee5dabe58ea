#pragma once
// Listens to a run and keeps a row per frame, for frames.txt.

#include "kinloop/slam/listener.hpp"
#include "kinloop/slam/timings.hpp"
#include "viewer/report/frame_table.hpp"

namespace kinloop {

class FrameRecorder : public Listener {
 public:
  void on_frame(const FrameResult& result, const PreparedFrame& frame) override;
  void on_map(const Map&) override {}

  /// The rows, with the time that each frame took.
  [[nodiscard]] FrameTable table(const Timings& times) const;

 private:
  FrameTable rows_;
};

}  // namespace kinloop
