// Tracks your own camera: pass colour and depth as cv::Mat, get the pose of each frame.
//
//   example_own_camera COLOR_PATTERN DEPTH_PATTERN     e.g. rgb/%04d.png depth/%04d.png, depth in mm
//
// Image files stand in for a camera driver. Colour is 8UC3 BGR, depth 32FC1 in metres, registered to colour.

#include <cstdio>
#include <filesystem>
#include <string>

#include <opencv2/core/utility.hpp>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/slam/slam.hpp"

namespace {

kinloop::RgbdCamera my_camera() {
  kinloop::RgbdCamera camera;
  camera.color.width = 640;
  camera.color.height = 480;
  camera.color.fx = camera.color.fy = 525;
  camera.color.cx = 319.5;
  camera.color.cy = 239.5;
  camera.fps = 30;
  return camera;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: example_own_camera COLOR_PATTERN DEPTH_PATTERN\n");
    return 2;
  }
  kinloop::Slam slam(my_camera());
  for (uint32_t i = 0;; ++i) {
    kinloop::Frame frame;
    frame.id = kinloop::FrameId{i};
    frame.stamp_ns = int64_t{i} * 1'000'000'000 / 30;
    const std::string color_file = cv::format(argv[1], i), depth_file = cv::format(argv[2], i);
    if (!std::filesystem::exists(color_file) || !std::filesystem::exists(depth_file)) break;
    frame.color = kinloop::read_color_image(color_file);  // or pixels: a cv::Mat
    frame.depth_m = kinloop::read_depth_image(depth_file, 1000);

    const kinloop::TrackedFrame result = slam.process(frame);
    const Eigen::Vector3d p = result.T_world_camera.translation;
    if (result.is_lost()) {
      std::printf("%u lost\n", i);
    } else {
      std::printf("%u %.3f %.3f %.3f\n", i, p.x(), p.y(), p.z());
    }
  }
  kinloop::write_tum_trajectory("trajectory.txt", slam.finish());
}
