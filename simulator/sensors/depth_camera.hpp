#pragma once
// In: the pose of a depth camera. Out: its depth image, with the imperfections of its sensor.

#include <vector>

#include "kinloop/core/options.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "simulator/render/moment.hpp"
#include "simulator/sensors/depth_models.hpp"
#include "simulator/sensors/exact_depth.hpp"

namespace kinloop {

/// A Kinect 1 delivers depth registered to colour; the others have a depth camera of its own pose and lens.
enum class SimulatedSensor { kKinect1, kKinect2, kRealsense };

constexpr auto option_names(SimulatedSensor) {
  return std::to_array<EnumName<SimulatedSensor>>({{SimulatedSensor::kKinect1, "kinect1"},
                                                   {SimulatedSensor::kKinect2, "kinect2"},
                                                   {SimulatedSensor::kRealsense, "realsense"}});
}

namespace sim {

/// Distance of the two infrared cameras of a D435 (data sheet), m.
constexpr double kStereoBaseline_m = 0.05;

/// Returns the cameras at their usual size.
///
/// - kinect1: those of TUM's freiburg1.
/// - kinect2: depth of 512 x 424 with the lens of libfreenect2's default parameters, and 52 mm beside it
///   colour of 960 x 540. The device has 1920 x 1080, which takes four times as long to render and
///   to process.
/// - realsense: a D435, both images rectified. Depth of 848 x 480 at the left infrared camera with 90 degrees
///   of view, and 15 mm beside it colour of 640 x 480.
RgbdCamera sensor_camera(SimulatedSensor sensor);

/// How many rays a pixel has: one through its centre, or four that fill it.
enum class SamplesPerPixel { kOne = 1, kFour = kLanes };

/// Renders the exact depth of a camera with a global shutter, as depth cameras of time of flight and stereo
/// have. Rows are independent, so the result is the same for any number of threads.
class DepthRenderer {
 public:
  DepthRenderer(const PinholeCamera& camera, SamplesPerPixel samples, int threads);

  /// Rays that hit nothing have cosine 0.
  [[nodiscard]] ExactDepth render(const Moment& moment, const SE3& T_room_camera) const;

  /// Returns the length of each pixel's ray at depth 1, 32FC1: range = this x depth.
  [[nodiscard]] const cv::Mat& range_per_depth() const { return range_per_depth_; }

 private:
  struct Tile;
  struct Row;

  void add_rays(const Eigen::Vector2d& pixel);
  [[nodiscard]] Tile tile_rays(const SE3& T_room_camera, size_t first, size_t count) const;
  void render_tile(const Moment& moment, const Tile& tile, size_t count, const Row& out) const;

  PinholeCamera camera_;
  int samples_, threads_;
  std::vector<float> ray_x_, ray_y_;  ///< ray (x, y, 1) of every sample, those of a pixel in succession
  cv::Mat range_per_depth_;
};

/// The imperfections of all sensors; those of the chosen one count.
struct DepthCameraNoise {
  TimeOfFlightNoise tof;
  StereoNoise stereo;
};

/// The depth camera of a Kinect 2 or RealSense, beside the colour camera.
class DepthCamera {
 public:
  /// Requires `camera.depth`.
  DepthCamera(const Scene& scene, const RgbdCamera& camera, const DepthCameraNoise& noise, int threads);

  /// Returns depth measured at a time: 32FC1 metres, 0 = unknown. `seed` is that of the frame.
  [[nodiscard]] cv::Mat measure(const SE3& T_room_color, int64_t stamp_ns, uint64_t seed) const;

 private:
  const Scene* scene_;
  PinholeCamera camera_;
  SE3 T_color_depth_;
  DepthSensorKind kind_;
  DepthCameraNoise noise_;
  int threads_;
  DepthRenderer renderer_;
};

}  // namespace sim
}  // namespace kinloop
