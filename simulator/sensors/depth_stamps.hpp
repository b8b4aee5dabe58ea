#pragma once
// In: stamps of colour images. Out: stamps of the depth images that a Kinect would pair with them.

#include <cstdint>
#include <span>
#include <vector>

namespace kinloop::sim {

/// The stamps of a frame.
struct FrameStamps {
  int64_t color_ns = 0;
  int64_t depth_ns = 0;
};

/// Returns the frames of a camera whose depth images come by a clock of their own, as in TUM's freiburg1
/// recordings: with another period, so that the lag drifts and wraps around, with jitter, and with lost
/// images. Images are paired as in any recording; colour images without a partner are left out, at least one
/// is kept. `color_ns` must increase.
std::vector<FrameStamps> with_depth_stamps(std::span<const int64_t> color_ns, uint64_t seed);

}  // namespace kinloop::sim
