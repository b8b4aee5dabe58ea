// Calibrates a camera from a recording without a calibration board: intrinsics, readout time of the rolling
// shutter, and delay of depth relative to colour. Writes calibrated.yaml, the input of `kinloop run
// --camera`.
//
//   example_self_calibrate SEQUENCE

#include <cstdio>

#include "drivers/datasets/tum_source.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "kinloop/slam/slam.hpp"

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: example_self_calibrate SEQUENCE\n");
    return 2;
  }
  kinloop::TumSource source(argv[1]);
  kinloop::Slam slam(source.camera());
  while (const auto frame = source.next()) slam.process(*frame);
  slam.finish();

  const kinloop::RgbdCamera camera = kinloop::calibrated_camera(source.camera(), slam.sensor_estimate());
  std::printf("focal length    %.2f %.2f px, was %.2f %.2f\n", camera.color.fx, camera.color.fy,
              source.camera().color.fx, source.camera().color.fy);
  std::printf("readout time    %.1f ms\n", 1e3 * kinloop::nominal_readout_s(camera));
  std::printf("depth delay     %.1f ms\n", 1e3 * camera.depth_delay_s);
  kinloop::write_camera_file("calibrated.yaml", camera);
} catch (const std::exception& error) {
  std::fprintf(stderr, "error: %s\n", error.what());
  return 3;
}
