// Tracks your own camera: pass colour and depth as cv::Mat, get the pose of each frame.
//
//   example_own_camera COLOR_PATTERN DEPTH_PATTERN     e.g. rgb/%04d.png depth/%04d.png, depth in mm
//
// Image files stand in for a camera driver. Colour is 8UC3 BGR, depth 32FC1 in metres, registered to colour.

#include <cstdio>

#include <opencv2/imgcodecs.hpp>

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
    kinloop::RgbdFrame frame;
    frame.id = kinloop::FrameId{i};
    frame.stamp_ns = int64_t{i} * 1'000'000'000 / 30;
    frame.color = cv::imread(cv::format(argv[1], i), cv::IMREAD_COLOR);
    const cv::Mat depth_mm = cv::imread(cv::format(argv[2], i), cv::IMREAD_UNCHANGED);
    if (frame.color.empty() || depth_mm.empty()) break;
    depth_mm.convertTo(frame.depth_m, CV_32F, 1e-3);

    const kinloop::FrameResult result = slam.process(frame);
    const Eigen::Vector3d p = result.T_world_camera.translation;
    if (result.status == kinloop::TrackStatus::kLost) {
      std::printf("%u lost\n", i);
    } else {
      std::printf("%u %.3f %.3f %.3f\n", i, p.x(), p.y(), p.z());
    }
  }
  kinloop::write_tum_trajectory("trajectory.txt", slam.finish());
}
