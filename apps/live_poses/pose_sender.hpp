#pragma once
// In: each frame as it is tracked. Out: a JSON line with its pose for another program (--poses-to);
// docs/protocol.md describes it.

#include <memory>
#include <string>

#include "apps/live_poses/line_output.hpp"
#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// Returns the line of a frame, with its line break.
std::string pose_line(const TrackedFrame& tracked, const Map& map);

class PoseSender {
 public:
  /// `target` is that of open_line_output, which may throw.
  explicit PoseSender(std::string target);

  void send(const TrackedFrame& tracked, const Map& map);

  /// Logs how many lines were dropped, if any.
  void report() const;

 private:
  std::string target_;
  std::unique_ptr<LineOutput> output_;
  size_t lines_ = 0, dropped_ = 0;
};

}  // namespace kinloop
