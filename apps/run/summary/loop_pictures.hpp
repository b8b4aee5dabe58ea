#pragma once
// Evidence for the loop closures of a finished map: the two keyframes around each with the most shared
// landmarks, the landmarks of one reprojected into the image of the other, and pictures of both.

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/io/run_folder.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/sensor/sensor.hpp"
#include "kinloop/sensor/source/frame_source.hpp"
#include "session/store/dense_recorder.hpp"

namespace kinloop {

/// Two keyframes of one place, far apart in time.
struct KeyframePair {
  KeyframeId older, newer;
  int shared = 0;  ///< common landmarks
};

/// Returns the pair that shares the most landmarks among the ends of the loop and their covisible keyframes.
/// Each keyframe stays on its side of the loop: within a third of its length from its end.
KeyframePair most_overlapping_pair(const Map& map, const LoopClosure& loop);

/// Sensor and motion of a keyframe.
struct MovingSensor {
  Sensor sensor;
  Velocity velocity;  ///< at the keyframe's stamp
};

/// A landmark observed in one keyframe, projected into another.
struct ReprojectedLandmark {
  Eigen::Vector2d observed;                           ///< keypoint of the first keyframe, raw px
  Eigen::Vector2d predicted;                          ///< in the second image, raw px
  double depth_m = 0;                                 ///< z in the second camera
  std::optional<Eigen::Vector2d> observed_in_second;  ///< keypoint of the second keyframe, raw px
};

/// Projects the landmarks of `from` into the image of `into`, given the poses of the map and the motion of
/// the second camera during its readout.
std::vector<ReprojectedLandmark> reproject_landmarks(const Map& map, KeyframeId from, KeyframeId into,
                                                     const MovingSensor& moving);

/// A picture of a loop, with measurements.
struct LoopPicture {
  std::string file;                        ///< in the folder of the pictures
  int64_t stamp_a_ns = 0, stamp_b_ns = 0;  ///< of its two images, the older first
  int reprojected = 0;                     ///< landmarks of the first image that project into the second
  int observed = 0;                        ///< of these, landmarks also observed in the second
  double median_error_px = 0;              ///< of these, distance between projection and keypoint
  double distance_m = 0, angle_deg = 0;    ///< between the two cameras
  int inliers = 0;                         ///< of the loop itself
};

/// Writes a picture per loop into the folder's `loops`, with loops.json: the two keyframes around the loop
/// with the largest overlap, and the landmarks of the first reprojected into the second with the final poses.
/// Of many loops, evenly spaced ones. Removes pictures of an earlier run.
void write_loop_pictures(const RunFolder& folder, const Slam& slam, const DenseRecorder& recorder);

/// Reads the index loops.json; empty if the folder has none. Leaves out what is not a JPEG image in the
/// folder itself. Throws InputError naming the index if it is damaged.
std::vector<LoopPicture> read_loop_pictures(const RunFolder& folder);

}  // namespace kinloop
