#pragma once
// What is worked out of a keyframe's images once, in the background: they themselves made small, and their
// surfels of its surface.

#include "kinloop/base/ids.hpp"
#include "kinloop/dense/cloud/image_surfels.hpp"
#include "kinloop/dense/image_store.hpp"

namespace kinloop {

struct DenseKeyframe {
  FrameId frame;
  EncodedImages images;
  std::vector<uint8_t> surfels;  ///< as `to_bytes` gives it
};

}  // namespace kinloop
