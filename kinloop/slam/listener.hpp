#pragma once
// Listeners observe a run: files, viewer, dense maps and the terminal. They cannot change the map.

#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

class Listener {
 public:
  virtual ~Listener() = default;

  /// Called after every frame; `tracked.frame` has its images and features.
  virtual void on_frame(const TrackedFrame& tracked) = 0;

  /// Called after keyframes were added or moved. `map` is valid only during the call.
  virtual void on_map(const Map& map) = 0;
};

}  // namespace kinloop
