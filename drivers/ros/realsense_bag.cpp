#include "drivers/ros/realsense_bag.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "drivers/ros/messages/ros_serialization.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

constexpr std::string_view kImageData = "/image/data";
constexpr std::string_view kDepthUnits = "Depth Units";

/// "/device_0/sensor_0/Depth_0" of "/device_0/sensor_0/Depth_0/image/data", with or without "/compressed".
std::string stream_of(const std::string& image_topic) {
  return image_topic.substr(0, image_topic.rfind(kImageData));
}

std::string sensor_of(const std::string& image_topic) {
  const std::string stream = stream_of(image_topic);
  return stream.substr(0, stream.rfind('/'));
}

/// Since version 2.58 images are compressed, and what is not an image is text.
bool is_image_topic(std::string_view topic) {
  const size_t at = topic.rfind(kImageData);
  if (at == std::string_view::npos) return false;
  const std::string_view after = topic.substr(at + kImageData.size());
  return after.empty() || after == "/compressed" || after == "/compressedDepth";
}

/// The first image topic of a kind of stream; empty if there is none.
std::string first_stream(const std::set<std::string>& topics, std::string_view kind) {
  const auto found = std::find_if(topics.begin(), topics.end(), [&](const std::string& topic) {
    return topic.starts_with("/device_") && is_image_topic(topic) && topic.find(kind) != std::string::npos;
  });
  return found == topics.end() ? "" : *found;
}

/// Option names were written with spaces or underscores.
bool is_depth_units(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name.find(kDepthUnits) != std::string::npos;
}

/// The topics that hold calibration: camera_info, tf/N of both streams, and the options of the depth sensor.
std::set<std::string> calibration_topics(const MessageFile& file, const BagStreams& streams) {
  const std::string color = stream_of(streams.color), depth = stream_of(streams.depth);
  const std::string sensor = sensor_of(streams.depth);
  std::set<std::string> wanted;
  for (const BagTopic* topic : file.topics()) {
    const std::string& name = topic->name;
    const auto is_of = [&](const std::string& stream) {
      return name == stream + "/info/camera_info" || name == stream + "/camera_info" ||
             name.starts_with(stream + "/tf/");
    };
    const bool of_stream = is_of(color) || is_of(depth);
    const bool unit = name == sensor + "/property" || (name.starts_with(sensor + "/option/") &&
                                                       name.ends_with("/value") && is_depth_units(name));
    if (of_stream || unit) wanted.insert(name);
  }
  return wanted;
}

bool is_text(const BagMessage& message) {
  return message.topic->type == "std_msgs/String";
}

/// The unit from std_msgs/Float32, from text, or from diagnostic_msgs/KeyValue in files of version 2.
std::optional<double> read_unit(const BagMessage& message) {
  RosReader reader(message.data, message.topic->encoding);
  double unit_m = 0;
  if (message.topic->type == "std_msgs/Float32") {
    unit_m = double{reader.number<float>()};
  } else if (is_text(message)) {
    unit_m = sdk_number(reader.string());
  } else {
    if (!is_depth_units(reader.string())) return std::nullopt;
    const std::string text = reader.string();
    std::from_chars(text.data(), text.data() + text.size(), unit_m);  // strtod depends on the locale
  }
  constexpr double kMinUnitM = 1e-6, kMaxUnitM = 0.1;
  if (!(unit_m >= kMinUnitM && unit_m <= kMaxUnitM)) return std::nullopt;
  return unit_m;
}

/// Poses are those of a stream relative to the reference of its group: p_stream = T * p_reference.
struct Pose {
  std::string group;
  SE3 T_stream_reference;
};

struct SdkFindings {
  std::map<std::string, RosCameraInfo> infos;  ///< of streams
  std::map<std::string, Pose> poses;
  std::optional<double> depth_unit_m;
};

SdkFindings read_sdk_findings(MessageFile& file, const BagStreams& streams) {
  SdkFindings found;
  file.select(calibration_topics(file, streams));
  while (const auto message = file.next()) {
    const std::string& topic = message->topic->name;
    RosReader reader(message->data, message->topic->encoding);
    try {
      if (topic.ends_with("/info/camera_info")) {
        found.infos.emplace(topic.substr(0, topic.rfind("/info/camera_info")), read_camera_info(reader).info);
      } else if (topic.ends_with("/camera_info")) {
        found.infos.emplace(topic.substr(0, topic.rfind('/')), sdk_camera_info(reader.string()));
      } else if (const size_t at = topic.find("/tf/"); at != std::string::npos) {
        const SE3 pose = is_text(*message) ? sdk_pose(reader.string()) : read_transform(reader);
        found.poses.emplace(topic.substr(0, at), Pose{topic.substr(at), pose});
      } else if (const auto unit_m = read_unit(*message)) {
        found.depth_unit_m = unit_m;
      }
    } catch (const InputError&) {
      continue;  // what is missing is reported below
    }
  }
  return found;
}

PinholeCamera camera_of(const SdkFindings& found, const std::string& stream, const std::string& name) {
  const auto info = found.infos.find(stream);
  if (info == found.infos.end())
    throw InputError(fmt::format("{}: no camera: no message on topic {}/info/camera_info; use --camera FILE",
                                 name, stream));
  return camera_from(info->second, false);
}

SE3 pose_between(const SdkFindings& found, const std::string& color, const std::string& depth,
                 const std::string& name) {
  const auto a = found.poses.find(color), b = found.poses.find(depth);
  if (a == found.poses.end() || b == found.poses.end() || a->second.group != b->second.group) {
    throw InputError(fmt::format(
        "{}: the pose of depth relative to colour is missing (topics {}/tf/0 and {}/tf/0); use --camera FILE "
        "with depth and T_color_depth",
        name, color, depth));
  }
  return a->second.T_stream_reference * b->second.T_stream_reference.inverse();
}

}  // namespace

std::optional<BagStreams> realsense_streams(const std::set<std::string>& topics, const std::string& name) {
  const std::string color = first_stream(topics, "/Color_"), depth = first_stream(topics, "/Depth_");
  if (color.empty() && depth.empty()) return std::nullopt;
  if (color.empty() || depth.empty())
    throw InputError(fmt::format("{}: a RealSense recording without {}; record both streams", name,
                                 color.empty() ? "colour" : "depth"));
  return BagStreams{{color, depth, stream_of(color) + "/info/camera_info"}, color, depth};
}

RealsenseCalibration read_realsense_calibration(MessageFile& file, const BagStreams& streams,
                                                const std::string& name) {
  const SdkFindings found = read_sdk_findings(file, streams);
  const std::string color = stream_of(streams.color), depth = stream_of(streams.depth);
  RealsenseCalibration calibration;
  RgbdCamera& camera = calibration.camera;
  camera.color = camera_of(found, color, name);
  const PinholeCamera depth_camera = camera_of(found, depth, name);
  const SE3 T_color_depth = pose_between(found, color, depth, name);
  constexpr double kSamePoseM = 1e-6;
  const bool aligned = depth_camera == camera.color && T_color_depth.translation.norm() < kSamePoseM;
  if (!aligned) {
    camera.depth = depth_camera;
    camera.T_color_depth = T_color_depth;
  }
  if (found.depth_unit_m) calibration.depth_unit_m = unit_m_of_sdk(*found.depth_unit_m);
  return calibration;
}

SdkStamps read_realsense_stamps(MessageFile& file, const BagStreams& streams) {
  SdkStamps stamps;
  const std::string metadata = "/image/metadata";
  const std::map<std::string, std::string> image_topic_of = {
      {stream_of(streams.color) + metadata, streams.color},
      {stream_of(streams.depth) + metadata, streams.depth}};
  std::set<std::string> wanted;
  for (const BagTopic* topic : file.topics()) {
    if (image_topic_of.contains(topic->name) && topic->type == "std_msgs/String") wanted.insert(topic->name);
  }
  if (wanted.empty()) return stamps;
  file.select(wanted);
  while (const auto message = file.next()) {
    try {
      RosReader reader(message->data, message->topic->encoding);
      stamps[image_topic_of.at(message->topic->name)][message->log_ns] = sdk_stamp_ns(reader.string());
    } catch (const InputError&) {
      continue;  // its image keeps the stamp of the recorder
    }
  }
  return stamps;
}

double unit_m_of_sdk(double unit_m) {
  constexpr double kTolerance = 1e-6;
  const double per_metre = std::round(1 / unit_m);
  return std::abs(per_metre * unit_m - 1) < kTolerance ? 1 / per_metre : unit_m;
}

}  // namespace kinloop
