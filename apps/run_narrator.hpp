#pragma once
// Listens to a run and tells what happens, a line each (--verbose): losses, relocalisations, loops, and now
// and then how far it is.

#include "kinloop/slam/listener.hpp"

namespace kinloop {

class RunNarrator : public Listener {
 public:
  void on_frame(const FrameResult& result, const PreparedFrame& frame) override;
  void on_map(const Map& map) override;

 private:
  TrackStatus status_ = TrackStatus::kTracked;
  size_t loops_told_ = 0;
  size_t keyframes_told_ = 0;
};

/// How a run goes, in a few words: "tracking, 44 keyframes, 5 loops".
std::string run_note(const FrameResult& result, const Map& map);

}  // namespace kinloop
