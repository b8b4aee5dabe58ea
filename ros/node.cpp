// kinloop_node: maps the images of an RGB-D camera in ROS 1. Private parameters:
//   ~topics         COLOR,DEPTH[,CAMERA_INFO]; default: those of the first known camera that publishes
//   ~camera         camera.yaml or a preset; default: camera_info
//   ~output         folder for trajectory.txt at the end; empty: none
//   ~world_frame, ~odom_frame, ~camera_frame   names of the TF frames; ~odom_frame may be empty
//   ~keep_all       true: drops no frame, however late, so that the result is reproducible; for bags
//   ~idle_s         ends after this time without a frame; 0: at Ctrl-C
//   ~set            options as of `kinloop run --set`, separated by blanks

#include "ros/node.hpp"

#include <filesystem>
#include <sstream>

#include <ros/ros.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include "drivers/datasets/camera_selection.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/options.hpp"
#include "session/session.hpp"

namespace kinloop::ros1 {
namespace {

std::string text_parameter(const ros::NodeHandle& node, const char* name, const char* otherwise = "") {
  return node.param<std::string>(name, otherwise);
}

ListenOptions listen_options(const ros::NodeHandle& node) {
  ListenOptions options;
  const std::string topics = text_parameter(node, "topics"), camera = text_parameter(node, "camera");
  if (!topics.empty()) options.topics = parse_topics(topics);
  if (!camera.empty()) options.camera = given_camera(camera);
  options.keep_all = node.param("keep_all", false);
  options.idle_s = node.param("idle_s", 0.0);
  return options;
}

SlamOptions slam_options(const ros::NodeHandle& node, bool keep_all) {
  SlamOptions options;
  if (!keep_all) options.executor.mode = ExecutorMode::kLive;
  std::istringstream words(text_parameter(node, "set"));
  const std::vector<std::string> assignments{std::istream_iterator<std::string>(words), {}};
  return with_assignments(options, assignments);
}

void run(const ros::NodeHandle& node) {
  const ListenOptions listen = listen_options(node);
  const SlamOptions options = slam_options(node, listen.keep_all);
  TopicSource source(node, listen);
  SessionOptions session_options;
  session_options.slam = options;
  session_options.record_images = false;  // the cloud goes out frame by frame
  Session session(source, session_options);
  NodeOutput output(node, source.camera().color,
                    {text_parameter(node, "world_frame", "map"), text_parameter(node, "odom_frame", "odom"),
                     text_parameter(node, "camera_frame", "kinloop_camera")});
  size_t frames = 0, tracked = 0, doubtful = 0;
  while (const auto frame = session.next()) {
    const TrackedFrame given = session.track(*frame);
    if (!given.is_lost()) output.publish_pose(given);
    const TrackedFrame mapped = session.update_map();
    ++frames;
    if (mapped.is_lost()) continue;
    ++(mapped.is_doubtful() ? doubtful : tracked);
    if (!mapped.keyframe.valid()) continue;
    output.publish_path(session.trajectory());
    output.publish_cloud(mapped);
  }
  output.publish_path(session.finish());
  const auto skipped = source.skipped();
  log::info("{} of {} frames tracked, {} doubtful, {} images lost{}", tracked, frames, doubtful,
            skipped.size(), skipped.empty() ? "" : "; the first: " + skipped.front().reason);
  const std::filesystem::path folder = text_parameter(node, "output");
  if (folder.empty()) return;
  std::filesystem::create_directories(folder);
  session.write_trajectory(folder / "trajectory.txt");
  log::info("written: {}", (folder / "trajectory.txt").string());
}

}  // namespace
}  // namespace kinloop::ros1

int main(int argc, char** argv) {
  ros::init(argc, argv, "kinloop");
  auto logger = spdlog::stderr_color_st("kinloop");
  logger->set_pattern("%^%l:%$ %v");
  spdlog::set_default_logger(logger);
  try {
    ros::NodeHandle node("~");
    ros::AsyncSpinner spinner(1);
    spinner.start();
    kinloop::ros1::run(node);
  } catch (const std::exception& error) {
    kinloop::log::error("{}", error.what());
    return 3;
  }
  return 0;
}
