#pragma once
// What happens once all frames are there: the whole map is adjusted to convergence together with what the
// sensor is found to do (read-out time of the shutter, delay of the depth image, lens, depth), and every
// frame is refined on the final map.

#include "kinloop/base/progress.hpp"
#include "kinloop/mapping/options.hpp"
#include "kinloop/optimize/sensor_model.hpp"
#include "kinloop/slam/frame_log.hpp"

namespace kinloop {

struct SelfCalibrationOptions {
  bool enabled = true;
  int passes = 3;
  double focal_sigma = 0.003;
  double center_sigma_px = 5;
  double radial_sigma = 0.05;
  double time_sigma_s = 0.03;
  double depth_offset_sigma_per_m = 0.002;
  double max_sigma_share = 0.5;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("enabled", self.enabled, "estimate the sensor's parameters in the final adjustment");
    visit("passes", self.passes, "times that sensor, map and frames are estimated in turn", Range{1, 10});
    visit("focal_sigma", self.focal_sigma, "how far a focal length may be off (1 sigma), relative",
          Range{0, 1});
    visit("center_sigma_px", self.center_sigma_px, "how far the principal point may be off, px",
          Range{0, 1000});
    visit("radial_sigma", self.radial_sigma, "how far radial distortion may be off", Range{0, 10});
    visit("time_sigma_s", self.time_sigma_s, "read-out times and depth delay to be expected, s", Range{0, 1});
    visit("depth_offset_sigma_per_m", self.depth_offset_sigma_per_m,
          "smooth deformation of the inverse depth to be expected, 1/m", Range{0, 1});
    visit("max_sigma_share", self.max_sigma_share,
          "a parameter is used when the data narrow it down to this share of what was expected", Range{0, 1});
  }
};

/// What the sensor was found to do; zero for parameters that the data do not constrain.
struct SensorEstimate {
  SensorVector value = SensorVector::Zero();
  SensorVector sigma =
      SensorVector::Zero();  ///< standard deviation; of the held ones what it would have been
  std::vector<bool> used = std::vector<bool>(kSensorParameterCount, false);
};

/// Adjusts `map` and refines `log`. Gives what was found of the sensor.
SensorEstimate adjust_finally(Map& map, FrameLog& log, const PinholeCamera& camera,
                              const BundleOptions& bundle, const AbsolutePoseOptions& pose,
                              const SelfCalibrationOptions& options, const Progress& progress = {});

/// Velocity of every frame from its neighbours in time; zero where it is lost or has none close by.
std::vector<Velocity> frame_velocities(const FrameLog& log, const Map& map);

/// Refines every tracked frame on the landmarks it saw, as the map stands now, for a sensor with the given
/// corrections.
FrameLog refine_frames(const FrameLog& log, const Map& map, const PinholeCamera& camera,
                       const SensorVector& sensor, const AbsolutePoseOptions& options);

}  // namespace kinloop
