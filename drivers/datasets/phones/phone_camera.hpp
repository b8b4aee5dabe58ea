#pragma once
// What the exports of iPhone apps have in common: ARKit's camera, whose depth is a small image seen through
// the same lens, in millimetres.

#include <filesystem>
#include <span>
#include <vector>

#include <opencv2/core/types.hpp>

#include "drivers/datasets/recorded_sequence.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// Returns the camera with the median of the lenses of all frames: an iPhone focuses while it records, and
/// its focal length changes by about a percent. Throws InputError naming `file` if there is none or it is not
/// plausible.
RgbdCamera phone_camera(std::span<const PinholeCamera> lenses, cv::Size depth_size,
                        const std::filesystem::path& file);

/// Ends a sequence whose frames have their own times and lenses: drops frames whose time does not increase,
/// and sets the camera and the rate. Throws as `phone_camera` does.
void finish_phone_sequence(RecordedSequence& sequence, std::span<const PinholeCamera> lenses,
                           const std::filesystem::path& file);

}  // namespace kinloop
