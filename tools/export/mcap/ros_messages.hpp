#pragma once
// Messages of ROS 2 in CDR, little-endian, and their definitions.

#include <cstdint>
#include <string>
#include <string_view>

#include "kinloop/geometry/camera.hpp"
#include "tools/export/mcap/mcap_writer.hpp"

namespace kinloop::ros_messages {

// Topics, each with its definition.
McapTopic compressed_image_topic(const std::string& name);
McapTopic camera_info_topic(const std::string& name);
McapTopic string_topic(const std::string& name);

std::string compressed_image(int64_t stamp_ns, std::string_view format, std::string_view data);

std::string camera_info(int64_t stamp_ns, const PinholeCamera& camera);

std::string text(std::string_view value);

}  // namespace kinloop::ros_messages
