#pragma once
// The messages of recordings, with their topics: Foxglove's schemas as JSON, and messages of ROS 2 in CDR,
// little-endian.

#include <cstdint>
#include <string>
#include <string_view>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/files/file_frame.hpp"
#include "kinloop/geometry/camera.hpp"
#include "tools/export/mcap/mcap_writer.hpp"

namespace kinloop::foxglove {

// Topics, each with its schema.
McapTopic frame_transform_topic(const std::string& name);
McapTopic pose_topic(const std::string& name);
McapTopic point_cloud_topic(const std::string& name);
McapTopic image_topic(const std::string& name);
McapTopic calibration_topic(const std::string& name);

/// Pose of the frame `child` in the frame `parent`.
std::string frame_transform(int64_t stamp_ns, const std::string& parent, const std::string& child,
                            const SE3& T_parent_child);

std::string pose(int64_t stamp_ns, const std::string& frame_id, const SE3& pose);

/// The finite points of a cloud in the frame of the file.
std::string point_cloud(int64_t stamp_ns, const std::string& frame_id, const ColoredCloud& cloud,
                        const FileFrame& frame);

std::string jpeg_image(int64_t stamp_ns, const std::string& frame_id, std::string_view jpeg);

std::string calibration(int64_t stamp_ns, const std::string& frame_id, const PinholeCamera& camera);

}  // namespace kinloop::foxglove

namespace kinloop::ros_messages {

// Topics, each with its definition.
McapTopic compressed_image_topic(const std::string& name);
McapTopic camera_info_topic(const std::string& name);
McapTopic string_topic(const std::string& name);

std::string compressed_image(int64_t stamp_ns, std::string_view format, std::string_view data);

std::string camera_info(int64_t stamp_ns, const PinholeCamera& camera);

std::string text(std::string_view value);

}  // namespace kinloop::ros_messages
