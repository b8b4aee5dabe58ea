#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/io/run_folder.hpp"
#include "kinloop/sensor/frame_source.hpp"
#include "kinloop/slam/dense_recorder.hpp"

namespace kinloop {

/// A picture of a loop and what was measured on it.
struct LoopPicture {
  std::string file;                        ///< in the folder of the pictures
  int64_t stamp_a_ns = 0, stamp_b_ns = 0;  ///< of its two images, the older first
  int reprojected = 0;                     ///< landmarks of the first image that lie in the second
  int observed = 0;                        ///< of these, those that the second observes too
  double median_error_px = 0;              ///< of these, between prediction and keypoint
  double distance_m = 0, angle_deg = 0;    ///< between the two cameras
  int inliers = 0;                         ///< of the loop itself
};

/// Writes a picture per loop into the folder's `loops`, with loops.json: the two keyframes around the loop
/// that overlap most, and the landmarks of the one reprojected into the other by the final poses. Of many
/// loops an even choice. Pictures of an earlier run are removed.
void write_loop_pictures(const RunFolder& folder, const Slam& slam, const RgbdCamera& camera,
                         const DenseRecorder& recorder);

/// What loops.json says of the pictures that are there; empty for a folder without it.
std::vector<LoopPicture> read_loop_pictures(const RunFolder& folder);

}  // namespace kinloop
