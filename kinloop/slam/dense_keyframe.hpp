#pragma once
// What is worked out of a keyframe's images once, in the background: they themselves made small, and their
// patch of surface.

#include "kinloop/base/ids.hpp"
#include "kinloop/dense/depth_patch.hpp"
#include "kinloop/dense/keyframe_images.hpp"

namespace kinloop {

struct DenseKeyframe {
  FrameId frame;
  EncodedImages images;
  std::vector<uint8_t> patch;  ///< as `to_bytes` gives it
};

}  // namespace kinloop
