#pragma once
// The tables of a map file, shared by writer and reader.

#include "kinloop/io/map_file/checked_database.hpp"

namespace kinloop::map_tables {

constexpr DatabaseFormat kKind{0x4b4c4d50, 4};  ///< "KLMP"; increment the version if older readers would fail

// Pose columns: p_world = R(q) * p + t.
constexpr const char* kAbout = "about";      ///< key, value: row counts per table, etc.
constexpr const char* kSession = "session";  ///< input, first_frame
constexpr const char* kOption = "option";    ///< key, value
constexpr const char* kCamera = "camera";    ///< name, value
constexpr const char* kSensor = "sensor";    ///< value, sigma, used
constexpr const char* kKeyframe =
    "keyframe";  ///< frame, stamp, component, pose, features, visit (since version 4)
/// a, b, motion, information, inliers, support (since version 4)
constexpr const char* kLoopEdge = "loop_edge";
/// a, b, motion, information, inliers, support, scale, scale_sigma, status, reason; older files have none
constexpr const char* kOtherLoop = "other_loop";
constexpr const char* kLandmark = "landmark";  ///< anchor, position in its frame, observations
constexpr const char* kImage = "image";        ///< frame, rows, cols, colour, depth
/// frame, stamp, status, reference, keyframe, repeat (2 = predicted), pose, lag (since version 2), cause of
/// doubt (since version 3; 0 or 1 in older files)
constexpr const char* kFrame = "frame";

}  // namespace kinloop::map_tables
